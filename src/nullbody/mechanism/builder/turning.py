"""Joints turned round: the parent becomes the child, and coordinates keep their meaning where that is possible.

With T(q) the motion of the child's frame seen from the parent's, the turned joint moves by T(q)^-1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from nullbody.errors import MechanismError
from nullbody.mechanism.body import Axis
from nullbody.mechanism.builder.text import grouped
from nullbody.mechanism.joints import (
    AbstractTreeJoint,
    Cylindrical,
    Planar,
    Prismatic,
    Revolute,
    Spherical,
    Universal,
    Weld,
)
from nullbody.typing import Scalar

__all__ = ["keeps_meaning", "turned", "turned_home"]

Home = Mapping[str, Scalar]


def turned(joint: AbstractTreeJoint) -> AbstractTreeJoint:
    """The same joint with parent and child exchanged.

    Revolute, prismatic, cylindrical, universal joints and welds keep the meaning of their coordinates: the axis gets
    the other sign. Coordinates of planar and spherical joints then tell how the parent lies in the child's frame.

    Raises:
        MechanismError: a type that cannot be turned round.
    """
    swapped = replace(joint, parent=joint.child, child=joint.parent, at=joint.on, on=joint.at)
    for kind, change in _CHANGES.items():
        if isinstance(joint, kind):
            return replace(swapped, **change(joint))
    raise MechanismError(
        f"joint {joint.name!r} is a {type(joint).__name__} and cannot be turned round: exchange its parent "
        f"{joint.parent!r} and its child {joint.child!r}"
    )


def keeps_meaning(joint: AbstractTreeJoint) -> bool:
    """Whether the coordinates of the turned joint are those of the joint as it was written."""
    return not isinstance(joint, Planar | Spherical)


def turned_home(joint: AbstractTreeJoint, home: Home) -> Home:
    """Coordinates of the turned joint where those of the joint as it was written are given.

    A ball: e0, -e1, -e2, -e3. A plane: -R(alpha)^T (u, w) and -alpha. Any other: the same.
    """
    if keeps_meaning(joint) or not any(name in home for name in joint.coordinates):
        return {name: home[name] for name in joint.coordinates if name in home}
    given = [home.get(name, zero) for name, zero in zip(joint.coordinates, joint.zero, strict=True)]
    if isinstance(joint, Spherical):
        values = [given[0], *(f"-{grouped(value)}" for value in given[1:])]
    else:
        u, w, alpha = (grouped(value) for value in given)
        values = [f"-cos({alpha})*{u} - sin({alpha})*{w}", f"sin({alpha})*{u} - cos({alpha})*{w}", f"-{alpha}"]
    return dict(zip(joint.coordinates, values, strict=True))


def _opposite(axis: Axis) -> Axis:
    return axis[1:] if axis.startswith("-") else f"-{axis}"  # type: ignore[return-value]


def _against(joint: Any) -> dict[str, Any]:
    """T(q)^-1 = T(q) with the axis the other way round."""
    return {"axis": _opposite(joint.axis)}


def _crosswise(joint: Any) -> dict[str, Any]:
    """(R_a(alpha) R_b(beta))^-1 = R_-b(beta) R_-a(alpha)"""
    alpha, beta = joint.coordinates or (None, None)
    names = (beta, alpha) if joint.coordinates else ()
    return {"axis": _opposite(joint.axis2), "axis2": _opposite(joint.axis), "coordinates": names}


_CHANGES: Mapping[type[AbstractTreeJoint], Callable[[Any], dict[str, Any]]] = {
    Revolute: _against,
    Prismatic: _against,
    Cylindrical: _against,
    Universal: _crosswise,
    Planar: lambda joint: {},
    Spherical: lambda joint: {},
    Weld: lambda joint: {},
}
