"""Planar joint: the child slides and turns in a plane of the parent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.expr.matrix import add, dot, scale
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

__all__ = ["Planar"]


@dataclass(frozen=True)
class Planar(AbstractTreeJoint, AbstractLoopJoint):
    """Coordinates u, w [m] and alpha [rad]: p = u e_u + w e_w, R = R_axis(alpha), with e_u x e_w = axis.

    For the axis z, u and w run along x and y. Three equations where it closes a loop.
    """

    axis: Axis = "z"

    units: ClassVar[tuple[str, ...]] = ("m", "m", "rad")
    zero: ClassVar[tuple[float, ...]] = (0, 0, 0)
    rows: ClassVar[tuple[str, ...]] = ("height", "tilt_u", "tilt_w")
    row_units: ClassVar[tuple[str, ...]] = ("m", "rad", "rad")

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """p = u e_u + w e_w, R = R_axis(alpha)."""
        e_u, e_w = transverse(self.axis)
        rotation = elementary_rotation(self.axis, sin(q[2]), cos(q[2]))
        none = [0, 0, 0]
        position = add(scale(q[0], e_u), scale(q[1], e_w))
        return Motion(Pose(rotation, position), [none, none, axis_vector(self.axis)], [e_u, e_w, none])

    def closure(self, a: Pose, b: Pose, scalar: ScalarReader) -> list[Any]:
        """Phi = (n_a . (a - b); w_a . n_b; -u_a . n_b)."""
        return [dot(column(a, axis_vector(self.axis)), difference(a, b)), *tilts(a, b, self.axis)]

    def facing(self, a: Pose, b: Pose) -> list[Any]:
        """n_a . n_b"""
        return same_axis(a, b, self.axis)
