"""Revolute joint: an angle about an axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.mechanism.body import Axis
from nullbody.mechanism.joints.base import (
    AbstractTreeJoint,
    Motion,
    Pose,
    Trig,
    axis_vector,
    elementary_rotation,
)

__all__ = ["Revolute"]


@dataclass(frozen=True)
class Revolute(AbstractTreeJoint):
    """The child turns by the angle alpha [rad] about `axis` of the joint's frame."""

    axis: Axis = "z"

    size: ClassVar[int] = 1
    units: ClassVar[tuple[str, ...]] = ("rad",)

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """R = R_axis(alpha), p = 0."""
        rotation = elementary_rotation(self.axis, sin(q[0]), cos(q[0]))
        return Motion(Pose(rotation, [0, 0, 0]), [axis_vector(self.axis)], [[0, 0, 0]])
