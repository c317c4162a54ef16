"""Axes along any direction: a frame is turned until one of its own axes points there."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import atan2, cos, degrees, hypot, sin, sqrt
from typing import Any, cast

from nullbody.errors import ExpressionError, MechanismError
from nullbody.expr.matrix import matmul
from nullbody.expr.parse import parse
from nullbody.mechanism.body import AXES, Axis, Placement, Rotation
from nullbody.mechanism.joints.base import elementary_rotation
from nullbody.typing import Scalar

__all__ = ["Direction", "directed", "directed_pair", "rotations_of", "turned_by"]

#: One of "x", "-x", ..., or three numbers.
Direction = Axis | Sequence[Scalar]

_SAME = 1e-12  # of unit vectors and of angles in units of 15 degrees: what rounding leaves of exact ones
_NEARLY_RIGHT = 1e-9  # cosine of two axes that are meant to be at right angles

Matrix = Sequence[Sequence[float]]


def directed(axis: Direction, place: str) -> tuple[Axis, tuple[Rotation, ...]]:
    """An axis of a frame that has been turned by the rotations so that this axis is the given direction.

    Multiples of 15 degrees are exact. A direction along an axis of the frame needs no rotation, one in a plane of
    two axes one rotation, any other one two.

    Raises:
        MechanismError: no direction: unknown name, not three numbers, zero.
        ExpressionError: a component that is no number.
    """
    if isinstance(axis, str):
        if axis not in AXES:
            raise MechanismError(f"{place} has the axis {axis!r}; choose one of {', '.join(AXES)}, or three numbers")
        return cast(Axis, axis), ()
    x, y, z = _unit(axis, place)
    for name, along in (("x", x), ("y", y), ("z", z)):
        if sum(abs(other) for other in (x, y, z)) - abs(along) < _SAME:
            return cast(Axis, name if along > 0 else f"-{name}"), ()
    if abs(z) < _SAME:
        return "x", _turns(("z", atan2(y, x)))
    if abs(y) < _SAME:
        return "z", _turns(("y", atan2(x, z)))
    if abs(x) < _SAME:
        return "y", _turns(("x", atan2(z, y)))
    return "z", _turns(("z", atan2(y, x)), ("y", atan2(hypot(x, y), z)))


def directed_pair(first: Direction, second: Direction, place: str) -> tuple[Axis, Axis, tuple[Rotation, ...]]:
    """Two axes at right angles of a frame that has been turned by the rotations.

    Raises:
        MechanismError, ExpressionError: as `directed`; or the two are not at right angles.
    """
    if isinstance(first, str) and isinstance(second, str):
        return directed(first, place)[0], directed(second, place)[0], ()
    a, b = (_unit(_vector(axis, place), place) for axis in (first, second))
    if abs(sum(x * y for x, y in zip(a, b, strict=True))) > _NEARLY_RIGHT:
        raise MechanismError(f"{place} needs two axes at right angles, not {first!r} and {second!r}")
    c = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    return "x", "y", rotations_of(list(zip(a, b, c, strict=True)))


def rotations_of(matrix: Matrix) -> tuple[Rotation, ...]:
    """A rotation matrix as rotations about z, y and x, each about the new axes; those by 0 are left out.

    R = Rz(a) Ry(b) Rx(c). Each angle is read from what the ones before it leave, so that no pose is special.
    """
    rows: Any = [list(map(float, row)) for row in matrix]
    angles: list[tuple[Axis, float]] = []
    near = hypot(rows[0][0], rows[1][0]) > _SAME
    for axis in ("z", "y", "x"):
        pairs = {
            "z": atan2(rows[1][0], rows[0][0]) if near else 0.0,
            "y": atan2(-rows[2][0], rows[0][0]),
            "x": atan2(rows[2][1], rows[1][1]),
        }
        angle = pairs[axis]
        angles.append((axis, angle))
        rows = matmul(elementary_rotation(axis, sin(-angle), cos(-angle)), rows)
    return _turns(*angles)


def turned_by(place: Placement, rotations: Sequence[Rotation]) -> Placement:
    """A placement with further rotations about its new axes."""
    return Placement(place.position, (*place.rotations, *rotations)) if rotations else place


def _turns(*angles: tuple[Axis, float]) -> tuple[Rotation, ...]:
    """Rotations by multiples of 15 degrees as such, others in radians, none by 0."""
    turns = []
    for axis, angle in angles:
        steps = degrees(angle) / 15
        if abs(steps - round(steps)) < _SAME:
            turns += [Rotation(axis, degrees=15 * round(steps))] if round(steps) else []
        else:
            turns.append(Rotation(axis, radians=angle))
    return tuple(turns)


def _vector(axis: Direction, place: str) -> Sequence[Scalar]:
    if not isinstance(axis, str):
        return axis
    directed(axis, place)
    sign = -1 if axis.startswith("-") else 1
    return [sign * (letter == axis[-1]) for letter in "xyz"]


def _unit(axis: Sequence[Scalar], place: str) -> tuple[float, float, float]:
    """The direction with length 1."""

    def refuse(name: str) -> float:
        raise ExpressionError(
            f"{place}: an axis is given by numbers, and {name!r} is none; turn the frame by a parameter instead, with "
            f"Rotation('z', radians={name!r}) in a Placement"
        )

    numbers = [float(parse(_plain(part), refuse)) for part in axis]
    if len(numbers) != 3:
        raise MechanismError(f"{place} needs an axis of three components, not {axis!r}")
    length = sqrt(sum(number * number for number in numbers))
    if not length > 0:
        raise MechanismError(f"{place} has the axis {axis!r}, which points nowhere")
    x, y, z = (number / length for number in numbers)
    return x, y, z


def _plain(part: Any) -> Scalar:
    """A component without the number type of an array."""
    return part if isinstance(part, str | int | float | Fraction) else float(part)
