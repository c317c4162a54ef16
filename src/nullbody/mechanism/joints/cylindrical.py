"""Cylindrical joint: the child slides along an axis and turns about it."""

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
    elementary_rotation,
    same_axis,
    tilts,
    transverse,
)

__all__ = ["Cylindrical"]


@dataclass(frozen=True)
class Cylindrical(AbstractTreeJoint, AbstractLoopJoint):
    """Coordinates s [m] and alpha [rad]: p = s axis, R = R_axis(alpha). Four equations where it closes a loop."""

    axis: Axis = "z"

    units: ClassVar[tuple[str, ...]] = ("m", "rad")
    zero: ClassVar[tuple[float, ...]] = (0, 0)
    rows: ClassVar[tuple[str, ...]] = ("u", "w", "tilt_u", "tilt_w")
    row_units: ClassVar[tuple[str, ...]] = ("m", "m", "rad", "rad")

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """p = s axis, R = R_axis(alpha)."""
        s, alpha = q
        direction = axis_vector(self.axis)
        rotation = elementary_rotation(self.axis, sin(alpha), cos(alpha))
        return Motion(Pose(rotation, scale(s, direction)), [[0, 0, 0], direction], [direction, [0, 0, 0]])

    def closure(self, a: Pose, b: Pose, scalar: ScalarReader) -> list[Any]:
        """Phi = (u_a . (a - b); w_a . (a - b); w_a . n_b; -u_a . n_b)."""
        gap = difference(a, b)
        return [*(dot(column(a, side), gap) for side in transverse(self.axis)), *tilts(a, b, self.axis)]

    def facing(self, a: Pose, b: Pose) -> list[Any]:
        """n_a . n_b"""
        return same_axis(a, b, self.axis)
