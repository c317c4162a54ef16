"""Prismatic joint: a displacement s along an axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.expr.matrix import dot, scale
from nullbody.mechanism.body import Axis
from nullbody.mechanism.joints.base import (
    AbstractLoopJoint,
    AbstractTreeJoint,
    Motion,
    Pose,
    ScalarReader,
    Trig,
    axis_vector,
    column,
    difference,
    transverse,
)
from nullbody.mechanism.joints.weld import aligned, same_way

__all__ = ["Prismatic"]


@dataclass(frozen=True)
class Prismatic(AbstractTreeJoint, AbstractLoopJoint):
    """The child slides along `axis` of the joint's frame: p = s axis [m].

    Closing a loop: no gap along the transverse directions u, w of the parent, and no turn. Five equations.
    """

    axis: Axis = "z"

    units: ClassVar[tuple[str, ...]] = ("m",)
    zero: ClassVar[tuple[float, ...]] = (0,)
    rows: ClassVar[tuple[str, ...]] = ("u", "w", "turn_x", "turn_y", "turn_z")
    row_units: ClassVar[tuple[str, ...]] = ("m", "m", "rad", "rad", "rad")

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """R = I, p = s axis."""
        direction = axis_vector(self.axis)
        identity = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        return Motion(Pose(identity, scale(q[0], direction)), [[0, 0, 0]], [direction])

    def closure(self, a: Pose, b: Pose, scalar: ScalarReader) -> list[Any]:
        """Phi = (u_a . (a - b); w_a . (a - b); turns)."""
        gap = difference(a, b)
        return [*(dot(column(a, side), gap) for side in transverse(self.axis)), *aligned(a, b)]

    def facing(self, a: Pose, b: Pose) -> list[Any]:
        """All three axes point the same way."""
        return same_way(a, b)
