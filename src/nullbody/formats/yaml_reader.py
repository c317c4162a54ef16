"""YAML model files read into a mechanism: checked against the schema, then told to a builder, entry by entry."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from functools import partial
from inspect import signature
from typing import Any

from nullbody.errors import ExpressionError, InputError, ModelFileError, NullbodyError
from nullbody.formats.document import Document, Source, document
from nullbody.formats.yaml_tree import Node, yaml_tree
from nullbody.mechanism import Mechanism, MechanismBuilder, Placement, Rotation
from nullbody.mechanism.builder.record import Choice

__all__ = ["checked_joints", "fill", "read_yaml", "read_yaml_document"]

_FRAMES = ("at", "on", "plane")


def read_yaml(source: Source) -> Mechanism:
    """Read a model file in YAML.

    The text is data: nothing in it is ever run. Expressions are those of `nullbody.expr.parse`; units are SI.

    Args:
        source: a path, or the text itself.

    Raises:
        ModelFileError: no such file, too large, no YAML, or an entry that the schema does not have: unknown keys,
            missing ones, wrong types. The message says file, line, path of keys and what to try.
        ExpressionError: an expression outside the grammar, with the same.
        MechanismError, UnknownName: a mechanism that makes no sense.
    """
    return read_yaml_document(document(source))


def read_yaml_document(given: Document) -> Mechanism:
    """The mechanism of a document that has been read."""
    root = yaml_tree(given)
    if not isinstance(root.value, dict):
        raise given.error("a model file is a mapping with name, bodies, joints and so on", line=root.line)
    checked = _validated(given, root)

    def at(*path: str) -> Callable[[InputError], Exception]:
        node, found = root.at(path)
        return lambda error: given.located(error, ".".join(found), node.line)

    builder = _told(at(), lambda: _begin(checked))
    for name, entry in checked["parameters"].items():
        fields = entry if isinstance(entry, Mapping) else {"default": entry}
        _told(at("parameters", name), partial(builder.parameter, name, **fields))
    fill(builder, checked, at)
    for name, entry in checked["actuators"].items():
        _told(at("actuators", name), partial(builder.actuator, name, **entry))
    builder.home(checked["home"])
    if checked["end_effector"] is not None:
        builder.end_effector(checked["end_effector"])
    return _told(lambda error: given.located(error, *_subject(root, str(error))), builder.build)


def fill(builder: MechanismBuilder, sections: Mapping[str, Any], at: Callable[..., Callable[[Any], Exception]]) -> None:
    """Tell a builder the bodies, joints, constraints and loads of a checked file.

    Args:
        builder: what is told.
        sections: by name, each name -> entry with its type.
        at: gives what puts the place of an entry into an error.
    """
    for section in ("bodies", "joints", "constraints", "loads"):
        for name, entry in sections.get(section, {}).items():
            fields = {key: _placed(key, value) for key, value in entry.items() if key != "type" and value is not None}
            _told(at(section, name), partial(getattr(builder, entry["type"]), name, **fields))


def checked_joints(entries: Mapping[str, Any]) -> dict[str, Any]:
    """Joints alone as the schema has them: {"joints": name -> entry}.

    Raises:
        ModelFileError, ExpressionError: as `read_yaml`.
    """
    given = Document("", "loops")
    return _validated(given, _node({"name": "loops", "joints": entries}))


def _node(value: Any) -> Node:
    """Plain values as a tree without lines."""
    if isinstance(value, Mapping):
        return Node({str(key): _node(inner) for key, inner in value.items()}, 0)
    return Node([_node(inner) for inner in value], 0) if isinstance(value, list | tuple) else Node(value, 0)


def _begin(checked: Mapping[str, Any]) -> MechanismBuilder:
    return MechanismBuilder(checked["name"], checked["gravity"], checked["own"], checked["normal"])


def _told(place: Callable[[Any], Exception], call: Callable[[], Any]) -> Any:
    """What a call gives; its errors get the place."""
    try:
        return call()
    except InputError as error:
        raise place(error) from None


def _placed(key: str, value: Any) -> Any:
    """A frame as a Placement; anything else as it is."""
    if key not in _FRAMES or not isinstance(value, Mapping):
        return value
    turns = tuple(Rotation(turn["axis"], turn.get("degrees"), turn.get("radians")) for turn in value["rotations"])
    return Placement(tuple(value["position"]), turns)


def _validated(given: Document, root: Node) -> dict[str, Any]:
    """The file as the schema has it, with defaults filled in."""
    from pydantic import ValidationError

    from nullbody.formats.schema import file_model

    try:
        made = file_model().model_validate(root.plain())
    except ValidationError as error:
        raise _explained(given, root, error.errors(include_url=False)) from None
    return made.model_dump()


def _explained(given: Document, root: Node, errors: list[Any]) -> NullbodyError:
    """The first error with its place; an expression outside the grammar comes first."""
    grammar = [e for e in errors if isinstance(e.get("ctx", {}).get("error"), ExpressionError)]
    deepest = max(len(error["loc"]) for error in errors)
    telling = [e for e in errors if len(e["loc"]) == deepest or e["type"] in _DEFINITE]
    first = (grammar or sorted(telling, key=lambda e: _URGENT.get(e["type"], len(_URGENT))))[0]
    node, found = root.at(first["loc"])
    place = ".".join(found)
    if grammar:
        return given.located(ExpressionError(str(first["ctx"]["error"])), place, node.line)  # type: ignore[return-value]
    return ModelFileError(_what(first), file=given.file, place=place, line=node.line)


def _nearest(key: str, path: Sequence[object]) -> str:
    """The key that was meant, or where they are listed."""
    from nullbody.formats.schema import file_model

    methods = [part for part in path if isinstance(part, str) and hasattr(MechanismBuilder, part)]
    known = list(file_model().model_fields) if len(path) == 1 else ["position", "rotations", "degrees", "radians"]
    if methods:
        known += [*signature(getattr(MechanismBuilder, methods[-1])).parameters, *Choice.__annotations__]
    near = get_close_matches(key, known, n=1)
    return f"did you mean {near[0]!r}?" if near else "docs/model-file.md and schema.json say which there are"


_WORDS = {
    "degrees": "expected a number of degrees (expressions are in radians)",
    "number": "expected a number or an expression",
    "string_type": "expected a text (a number or a word such as true is one in quotes)",
    "bool_type": "expected true or false",
    "int_type": "expected a whole number",
    "list_type": "expected a list",
    "dict_type": "expected a mapping of keys to values",
    "model_type": "expected a mapping of keys to values",
}
_URGENT = {"degrees": 0, "extra_forbidden": 1}  # which of several errors tells most
_QUOTED = re.compile(r"(?:(\w+) )?'([^']+)'")
_KINDS = {"loop": "joints", "gear": "constraints", "rack": "constraints", "body": "bodies"}
_DEFINITE = ("extra_forbidden", "missing", "union_tag_invalid", "union_tag_not_found")


def _what(error: Any) -> str:
    """What is wrong and what to try, in this project's words."""
    kind, key, shown = error["type"], str(error["loc"][-1]), repr(error["input"])[:60]
    context = error.get("ctx", {})
    if kind in _WORDS:
        return f"{_WORDS[kind]}, not {shown}"
    if kind in ("too_short", "too_long"):
        wanted = context.get("min_length", context.get("max_length"))
        return f"it has {context['actual_length']} entries where {wanted} belong: {shown}"
    if kind == "extra_forbidden":
        return f"there is no key {key!r} here; {_nearest(key, error['loc'])}"
    if kind == "missing":
        return f"the key {key!r} is missing"
    if kind == "union_tag_invalid":
        if not context["tag"]:
            return f"the key 'type' is missing; choose one of {context['expected_tags']}"
        near = get_close_matches(context["tag"], context["expected_tags"].replace("'", "").split(", "), n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"choose one of {context['expected_tags']}"
        return f"there is no type {context['tag']!r}; {hint}"
    if kind == "literal_error":
        return f"{shown} is not one of {context['expected']}"
    if kind == "string_pattern_mismatch":
        return f"{shown} cannot be a name: letters, digits and _, a letter first"
    return f"{error['msg'].lower()}, not {shown}"


def _subject(root: Node, message: str) -> tuple[str, int]:
    """Place and line of the entry that a message of the builder names first."""
    for kind, name in _QUOTED.findall(message):
        guess = _KINDS.get(kind, f"{kind}s")
        for section in dict.fromkeys((guess, "bodies", "joints", "constraints", "loads", "actuators", "parameters")):
            node, found = root.at((section, name))
            if len(found) == 2:
                return ".".join(found), node.line
        node, found = root.at(("home", name))
        if len(found) == 2 and message.startswith("home"):
            return ".".join(found), node.line
    return "", 0
