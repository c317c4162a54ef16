"""Joints that hold one point: on a line, on a plane, at a constant distance. They close loops only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.expr.matrix import dot
from nullbody.mechanism.body import Axis
from nullbody.mechanism.joints.base import (
    AbstractLoopJoint,
    Pose,
    ScalarReader,
    axis_vector,
    column,
    difference,
    transverse,
)
from nullbody.typing import Scalar

__all__ = ["Distance", "PointOnLine", "PointOnPlane"]


@dataclass(frozen=True)
class PointOnLine(AbstractLoopJoint):
    """The child's point stays on the line along `axis` of the parent's frame. Two equations."""

    axis: Axis = "z"

    rows: ClassVar[tuple[str, ...]] = ("u", "w")
    row_units: ClassVar[tuple[str, ...]] = ("m", "m")

    def closure(self, a: Pose, b: Pose, scalar: ScalarReader) -> list[Any]:
        """Phi = (u_a . (a - b); w_a . (a - b)) [m]."""
        gap = difference(a, b)
        return [dot(column(a, side), gap) for side in transverse(self.axis)]


@dataclass(frozen=True)
class PointOnPlane(AbstractLoopJoint):
    """The child's point stays in the plane through the parent's frame with the normal `axis`. One equation."""

    axis: Axis = "z"

    rows: ClassVar[tuple[str, ...]] = ("height",)
    row_units: ClassVar[tuple[str, ...]] = ("m",)

    def closure(self, a: Pose, b: Pose, scalar: ScalarReader) -> list[Any]:
        """Phi = n_a . (a - b) [m]."""
        return [dot(column(a, axis_vector(self.axis)), difference(a, b))]


@dataclass(frozen=True)
class Distance(AbstractLoopJoint):
    """A massless rod with ball ends: the two points keep the distance `length` > 0 [m]. One equation."""

    length: Scalar = 1

    rows: ClassVar[tuple[str, ...]] = ("length",)
    row_units: ClassVar[tuple[str, ...]] = ("m",)

    @property
    def signs(self) -> tuple[tuple[str, Scalar, str], ...]:
        """The length."""
        return (("the length", self.length, "positive"),)

    def closure(self, a: Pose, b: Pose, scalar: ScalarReader) -> list[Any]:
        """Phi = (|a - b|^2 - length^2) / (2 length), about |a - b| - length [m]; lambda is the rod's tension [N]."""
        gap, length = difference(a, b), scalar(self.length)
        return [(dot(gap, gap) / length - length) * 0.5]
