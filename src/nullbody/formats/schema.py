"""What a model file may say, as pydantic models made from the builder's methods: an entry is a call.

    joints:
      shaft: {type: revolute, parent: ground, child: crank, axis: x}     # builder.revolute("shaft", "ground", ...)

The fields of an entry are the parameters of the method, with the meanings of its docstring.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Annotated, Any, Literal, Union, get_origin, get_type_hints

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    WithJsonSchema,
    create_model,
)
from pydantic_core import PydanticCustomError
from typing_extensions import TypeAliasType

from nullbody.expr.parse import names_in
from nullbody.mechanism import MechanismBuilder
from nullbody.mechanism.body import Axis
from nullbody.mechanism.builder.direction import Direction
from nullbody.mechanism.builder.record import Choice, Place
from nullbody.mechanism.parameter import Sign
from nullbody.typing import Scalar

__all__ = ["SECTIONS", "VERSION", "file_model", "json_schema"]

#: Of the format; a file names it as `nullbody: 1`.
VERSION = 1

#: The methods of the builder that each section of a file may call; the first one is what an entry without a type is.
SECTIONS: Mapping[str, tuple[str, ...]] = {
    "bodies": ("body", "rod", "disc", "cylinder", "box", "sphere", "point_mass"),
    "joints": (
        "revolute",
        "prismatic",
        "cylindrical",
        "universal",
        "spherical",
        "planar",
        "screw",
        "weld",
        "free",
        "distance",
        "point_on_line",
        "point_on_plane",
    ),
    "constraints": ("coupling", "gear", "rack", "driver", "rolling_disc", "knife_edge", "holonomic", "nonholonomic"),
    "loads": ("spring", "damper", "coordinate_spring", "coordinate_damper", "friction", "wrench", "energy"),
}
_TYPELESS = "bodies"  # whose entries need no type

_STRICT = ConfigDict(extra="forbid", strict=True)
_ITEM = re.compile(r"^    (?:    )?(\w+(?:, \w+)*): (.*(?:\n {8,}(?!\w+(?:, \w+)*: ).*)*)", re.M)


def _number(value: Any) -> Any:
    """A number, or a text of the grammar; an error of the grammar carries the place in the text."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise PydanticCustomError("number", "expected a number or an expression")
    if isinstance(value, str):
        names_in(value)
    return value


def _degrees(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise PydanticCustomError("degrees", "expected a number of degrees; expressions are in `radians`")
    return value


_EXPRESSION = "a number, or an expression: numbers, parameters, + - * / ^, sqrt, sin, cos, tan, pi"

Number = TypeAliasType(
    "Number",
    Annotated[Any, PlainValidator(_number), WithJsonSchema({"type": ["number", "string"], "description": _EXPRESSION})],
)
Three = TypeAliasType("Three", Annotated[list[Number], Field(min_length=3, max_length=3)])
Name = TypeAliasType("Name", Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")])


Direct = TypeAliasType("Direct", Axis | Three)


class Degrees(BaseModel):
    """A rotation by a number of degrees; multiples of 15 are exact."""

    model_config = _STRICT
    axis: Axis
    degrees: Annotated[Any, PlainValidator(_degrees), WithJsonSchema({"type": "number"})]


class Radians(BaseModel):
    """A rotation by an expression in radians."""

    model_config = _STRICT
    axis: Axis
    radians: Number


def _one_angle(value: Any) -> Any:
    if isinstance(value, dict) and {"degrees", "radians"} <= value.keys():
        raise PydanticCustomError("one_angle", "give degrees or radians, and leave the other out")
    return value


class Frame(BaseModel):
    """A frame: moved first, then rotated about the new axes."""

    model_config = _STRICT
    position: Three = Field(default=[0, 0, 0], description="of its origin [m]")
    rotations: list[Annotated[Degrees | Radians, BeforeValidator(_one_angle)]] = Field(
        default=[], description="in order, each about the new axes"
    )


Frames = TypeAliasType("Frames", Three | Frame)


class ConstantEntry(BaseModel):
    """A named constant that all expressions may use."""

    model_config = _STRICT
    default: Number = Field(description="a number, or an expression in other parameters")
    unit: str = Field(default="", description="SI, such as m or kg m^2")
    meaning: str = Field(default="", description="a few words")
    sign: Sign = Field(default="positive", description="which values are physical")


_TYPES: Sequence[tuple[Any, Any]] = (
    (Scalar, Number),
    (Place, Frames),
    (Direction, Direct),
    (Scalar | Sequence[Scalar], Number | Annotated[list[Number], Field(min_length=1)]),
    (Sequence[Scalar] | None, Annotated[list[Number], Field(min_length=2, max_length=2)] | None),
    (str | Sequence[str], Name | list[Name]),
    (Sequence[int], Annotated[list[int], Field(min_length=2, max_length=2)]),
)
_LONG = {"inertia": Annotated[list[Number], Field(min_length=3, max_length=6)]}


def _type_of(name: str, hint: Any) -> Any:
    """The strict type that stands for an annotation of the builder."""
    for known, strict in _TYPES:
        if hint == known:
            return strict
    if hint == Sequence[Scalar]:
        return _LONG.get(name, Three)
    if hint in (str, bool) or get_origin(hint) is Literal:
        return hint
    raise TypeError(f"the schema has no type for {name}: {hint}")


def _entry(method: str) -> type[BaseModel]:
    """The model of an entry: the parameters of a method of the builder, but for the name."""
    function = getattr(MechanismBuilder, method)
    hints = get_type_hints(function)
    meanings = _meanings(function)
    fields: dict[str, Any] = {}
    if method != "actuator":
        default: Any = method if method in SECTIONS[_TYPELESS][:1] else ...
        fields["type"] = (Literal[method], Field(default=default))
    for parameter in list(inspect.signature(function).parameters.values())[2:]:
        if parameter.kind is parameter.VAR_KEYWORD:
            for key, hint in get_type_hints(Choice).items():
                fields[key] = (_type_of(key, hint) | None, Field(default=None, description=_meanings(Choice)[key]))
            continue
        default = ... if parameter.default is parameter.empty else parameter.default
        if isinstance(default, tuple):
            default = list(default)
        strict = _type_of(parameter.name, hints[parameter.name])
        fields[parameter.name] = (strict, Field(default=default, description=meanings.get(parameter.name)))
    summary = " ".join((inspect.getdoc(function) or "").split("\n\n")[0].split())
    return create_model(method, __config__=_STRICT, __doc__=summary, **fields)


def _meanings(documented: Callable[..., Any]) -> dict[str, str]:
    """What the docstring says about parameters or attributes."""
    text = inspect.getdoc(documented) or ""
    found: dict[str, str] = {}
    for names, meaning in _ITEM.findall(text):
        found |= dict.fromkeys(names.split(", "), " ".join(meaning.split()))
    return found


def _type_in(section: str) -> Callable[[Any], str]:
    def type_in(entry: Any) -> str:
        default = "body" if section == _TYPELESS else ""
        return str(entry.get("type", default) if isinstance(entry, Mapping) else getattr(entry, "type", default))

    return type_in


def _section(section: str) -> Any:
    """name -> entry, told apart by `type`."""
    models: Any = tuple(Annotated[_entry(method), Tag(method)] for method in SECTIONS[section])
    union: Any = Union[models]  # noqa: UP007, made at run time
    entry: Any = Annotated[union, Discriminator(_type_in(section))]
    key: Any = Name if section == "bodies" else str
    return dict[key, entry]


@lru_cache(maxsize=1)
def file_model() -> type[BaseModel]:
    """The model of a whole file."""
    init = _meanings(MechanismBuilder)
    own = get_type_hints(MechanismBuilder.__init__)["own"]
    about = {
        "bodies": "all but the ground, by name",
        "joints": "between any two bodies, in any order; those that the spanning tree does not need close loops",
        "constraints": "couplings, drivers, rolling contacts, equations of your own",
        "loads": "springs, dampers, friction, wrenches, energies of your own",
    }
    actuator: Any = _entry("actuator")
    fields: dict[str, Any] = {
        "nullbody": (Literal[VERSION], Field(default=VERSION, description="version of this format")),
        "name": (Annotated[str, Field(min_length=1, max_length=200)], Field(description="of the mechanism")),
        "gravity": (Three, Field(default=[0, 0, 0], description=init["gravity"])),
        "own": (own, Field(default="quaternion", description=init["own"])),
        "normal": (Axis, Field(default="z", description=init["normal"])),
        "parameters": (dict[Name, Number | ConstantEntry], Field(default={}, description="constants of expressions")),
        **{name: (_section(name), Field(default={}, description=meaning)) for name, meaning in about.items()},
        "actuators": (dict[Name, actuator], Field(default={}, description="the inputs")),
        "home": (
            dict[Name, Number],
            Field(default={}, description="near which the loops close; a rough guess will do"),
        ),
        "end_effector": (Name | None, Field(default=None, description="the body whose coordinates are the task")),
    }
    about_file = "A mechanism for nullbody. Units are SI: m, kg, s, rad, N. The fixed body is called ground."
    made: type[BaseModel] = create_model("ModelFile", __config__=_STRICT, __doc__=about_file, **fields)
    return made


def json_schema() -> dict[str, Any]:
    """The JSON schema of a model file; it is published as schema.json in this folder."""
    made = file_model().model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **made, "title": "nullbody model file"}
