"""A mechanism written as a YAML model file; reading it back gives an equal mechanism."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from dataclasses import fields
from fractions import Fraction
from typing import Any

from nullbody.errors import MechanismError
from nullbody.formats.yaml_tree import FLOAT_TEXT
from nullbody.mechanism import (
    AbstractTreeJoint,
    CoordinateSpring,
    Coupling,
    Cylindrical,
    Distance,
    Driver,
    Energy,
    Free,
    FreeQuaternion,
    Friction,
    Holonomic,
    KnifeEdge,
    Mechanism,
    MechanismBuilder,
    Nonholonomic,
    Parameter,
    Placement,
    Planar,
    PointOnLine,
    PointOnPlane,
    Prismatic,
    Revolute,
    RollingDisc,
    Spherical,
    Spring,
    Universal,
    Weld,
    Wrench,
)
from nullbody.mechanism.builder.joints import default_names

__all__ = ["write_yaml"]

_METHODS: Mapping[type, str] = {
    Revolute: "revolute",
    Prismatic: "prismatic",
    Cylindrical: "cylindrical",
    Universal: "universal",
    Spherical: "spherical",
    Planar: "planar",
    Weld: "weld",
    Free: "free",
    FreeQuaternion: "free",
    Distance: "distance",
    PointOnLine: "point_on_line",
    PointOnPlane: "point_on_plane",
    Coupling: "coupling",
    Driver: "driver",
    RollingDisc: "rolling_disc",
    KnifeEdge: "knife_edge",
    Holonomic: "holonomic",
    Nonholonomic: "nonholonomic",
    Spring: "spring",
    CoordinateSpring: "coordinate_spring",
    Friction: "friction",
    Wrench: "wrench",
    Energy: "energy",
}
_OTHER_NAMES: Mapping[str, str] = {  # fields whose parameter in the builder has another name
    "body_a": "parent",
    "point_a": "at",
    "body_b": "child",
    "point_b": "on",
    "potential_energy": "potential",
    "kinetic_energy": "kinetic",
}
_WIDTH = 116


def write_yaml(mechanism: Mechanism) -> str:
    """A model file in YAML that `read_yaml` reads as an equal mechanism. Fractions become texts such as 1/3.

    Raises:
        MechanismError: a joint, constraint or load of a type of your own.
    """
    import yaml

    class Dumper(yaml.SafeDumper):
        """Sections in lines, each entry on one; quotes what a reader of YAML 1.2 would take for a number as well."""

        def ignore_aliases(self, data: Any) -> bool:
            return True

    def in_line(dumper: Any, entry: Any) -> Any:
        if isinstance(entry, dict):
            return dumper.represent_mapping("tag:yaml.org,2002:map", entry, flow_style=True)
        return dumper.represent_sequence("tag:yaml.org,2002:seq", entry, flow_style=True)

    Dumper.add_representer(_Line, in_line)
    Dumper.add_representer(list, in_line)
    Dumper.add_implicit_resolver("tag:yaml.org,2002:float", FLOAT_TEXT, list("-+.0123456789"))
    settings: Any = {"sort_keys": False, "default_flow_style": False, "width": _WIDTH, "allow_unicode": True}
    return str(yaml.dump(_content(mechanism), Dumper=Dumper, **settings))


class _Line(dict[str, Any]):
    """An entry that is written on one line."""


def _content(mechanism: Mechanism) -> dict[str, Any]:
    """The file as plain values; what is not there is left out."""
    joints = {joint.name: _Line(_entry(joint) | _names(joint)) for joint in mechanism.joints}
    loops = {loop.name: _Line(_entry(loop) | _loop(loop)) for loop in mechanism.loops}
    sections: dict[str, Any] = {
        "nullbody": 1,
        "name": mechanism.name,
        "gravity": _plain(mechanism.gravity),
        "parameters": {parameter.name: _parameter(parameter) for parameter in mechanism.parameters},
        "bodies": {body.name: _Line(_fields(body, "body")) for body in mechanism.bodies},
        "joints": joints | loops,
        "constraints": {constraint.name: _Line(_entry(constraint)) for constraint in mechanism.constraints},
        "loads": {load.name: _Line(_entry(load)) for load in mechanism.loads},
        "actuators": {actuator.name: _Line(_fields(actuator, "actuator")) for actuator in mechanism.actuators},
        "home": {name: _plain(value) for name, value in mechanism.home.items()},
        "end_effector": mechanism.end_effector,
    }
    return {key: value for key, value in sections.items() if value not in ({}, None)}


def _parameter(parameter: Parameter) -> Any:
    """The default alone, or with unit, meaning and sign where there are any."""
    entry = _fields(parameter, "parameter")
    return entry["default"] if len(entry) == 1 else _Line(entry)


def _entry(part: Any) -> dict[str, Any]:
    """The type of a joint, constraint or load and its fields."""
    if type(part) not in _METHODS:
        raise MechanismError(
            f"{part.name!r} is a {type(part).__name__}: a model file knows {', '.join(_METHODS.values())}"
        )
    method = _METHODS[type(part)]
    attitude = {"attitude": "angles"} if isinstance(part, Free) else {}
    return {"type": method, **_fields(part, method), **attitude}


def _loop(joint: Any) -> dict[str, Any]:
    """That a joint closes a loop, where it could stand in the tree."""
    return {"loop": True} if isinstance(joint, AbstractTreeJoint) else {}


def _names(joint: AbstractTreeJoint) -> dict[str, Any]:
    """The names of the coordinates, where they are not those that the builder makes."""
    if joint.coordinates == default_names(joint, joint.name):
        return {}
    names = list(joint.coordinates)
    return {"names": names[0] if len(names) == 1 else names}


def _fields(part: Any, method: str) -> dict[str, Any]:
    """The fields that are not the defaults of the builder's method."""
    parameters = inspect.signature(getattr(MechanismBuilder, method)).parameters
    entry: dict[str, Any] = {}
    for field in fields(part):
        name = _OTHER_NAMES.get(field.name, field.name)
        if name in ("name", "coordinates"):
            continue
        value = _plain(getattr(part, field.name))
        if value != _plain(parameters[name].default):
            entry[name] = value
    return entry


def _plain(value: Any) -> Any:
    """Numbers, texts and lists of them."""
    if isinstance(value, Placement):
        if not value.rotations:
            return _plain(value.position)
        turns = [
            {
                "axis": turn.axis,
                **({"degrees": _plain(turn.degrees)} if turn.radians is None else {"radians": _plain(turn.radians)}),
            }
            for turn in value.rotations
        ]
        moved = {} if tuple(value.position) == (0, 0, 0) else {"position": _plain(value.position)}
        return {**moved, "rotations": turns}
    if isinstance(value, Fraction):
        return str(value)
    if isinstance(value, str | bool) or value is None:
        return value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        return float(value)
    return [_plain(entry) for entry in value] if isinstance(value, Sequence) else value
