"""Prismatic joint: a displacement s along an axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.expr.matrix import scale
from nullbody.mechanism.body import Axis
from nullbody.mechanism.joints.base import AbstractTreeJoint, Motion, Pose, Trig, axis_vector

__all__ = ["Prismatic"]


@dataclass(frozen=True)
class Prismatic(AbstractTreeJoint):
    """The child slides along `axis` of the joint's frame: p = s axis [m]."""

    axis: Axis = "z"

    size: ClassVar[int] = 1
    units: ClassVar[tuple[str, ...]] = ("m",)

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """R = I, p = s axis."""
        direction = axis_vector(self.axis)
        identity = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        return Motion(Pose(identity, scale(q[0], direction)), [[0, 0, 0]], [direction])
