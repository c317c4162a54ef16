"""Revolute joint: an angle about an axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.mechanism.body import Axis
from nullbody.mechanism.joints.base import (
    AbstractLoopJoint,
    AbstractTreeJoint,
    Motion,
    Pose,
    ScalarReader,
    Trig,
    axis_vector,
    difference,
    elementary_rotation,
    same_axis,
    tilts,
)

__all__ = ["Revolute"]


@dataclass(frozen=True)
class Revolute(AbstractTreeJoint, AbstractLoopJoint):
    """The child turns by the angle alpha [rad] about `axis` of the joint's frame.

    Closing a loop: the two origins coincide, and the axis on the child is at right angles to the two transverse
    directions u, w on the parent. Five equations.
    """

    axis: Axis = "z"

    units: ClassVar[tuple[str, ...]] = ("rad",)
    zero: ClassVar[tuple[float, ...]] = (0,)
    rows: ClassVar[tuple[str, ...]] = ("x", "y", "z", "tilt_u", "tilt_w")
    row_units: ClassVar[tuple[str, ...]] = ("m", "m", "m", "rad", "rad")

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """R = R_axis(alpha), p = 0."""
        rotation = elementary_rotation(self.axis, sin(q[0]), cos(q[0]))
        return Motion(Pose(rotation, [0, 0, 0]), [axis_vector(self.axis)], [[0, 0, 0]])

    def closure(self, a: Pose, b: Pose, scalar: ScalarReader) -> list[Any]:
        """Phi = (a - b; w_a . n_b; -u_a . n_b)."""
        return [*difference(a, b), *tilts(a, b, self.axis)]

    def facing(self, a: Pose, b: Pose) -> list[Any]:
        """n_a . n_b"""
        return same_axis(a, b, self.axis)
