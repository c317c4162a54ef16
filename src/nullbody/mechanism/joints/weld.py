"""Weld: two frames coincide, nothing moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.expr.matrix import dot
from nullbody.mechanism.joints.base import (
    AbstractLoopJoint,
    AbstractTreeJoint,
    Motion,
    Pose,
    ScalarReader,
    Trig,
    column,
    difference,
)

__all__ = ["Weld", "aligned", "same_way"]

_X, _Y, _Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


@dataclass(frozen=True)
class Weld(AbstractTreeJoint, AbstractLoopJoint):
    """The child is fixed on the parent. No coordinates; six equations where it closes a loop."""

    units: ClassVar[tuple[str, ...]] = ()
    zero: ClassVar[tuple[float, ...]] = ()
    rows: ClassVar[tuple[str, ...]] = ("x", "y", "z", "turn_x", "turn_y", "turn_z")
    row_units: ClassVar[tuple[str, ...]] = ("m", "m", "m", "rad", "rad", "rad")

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """R = I, p = 0."""
        return Motion(Pose([_X, _Y, _Z], [0, 0, 0]), [], [])

    def closure(self, a: Pose, b: Pose, scalar: ScalarReader) -> list[Any]:
        """Phi = (a - b; turns)."""
        return [*difference(a, b), *aligned(a, b)]

    def facing(self, a: Pose, b: Pose) -> list[Any]:
        """All three axes point the same way."""
        return same_way(a, b)


def aligned(a: Pose, b: Pose) -> list[Any]:
    """y_a . z_b, z_a . x_b, x_a . y_b: minus the small turns of b against a about x, y, z; zero without a turn."""
    return [dot(column(a, i), column(b, j)) for i, j in ((_Y, _Z), (_Z, _X), (_X, _Y))]


def same_way(a: Pose, b: Pose) -> list[Any]:
    """Cosines between the axes of both frames; `aligned` is zero for some half and third turns as well."""
    return [dot(column(a, axis), column(b, axis)) for axis in (_X, _Y, _Z)]
