"""Universal joint (Cardan, Hooke): two crossing axes at right angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.expr.matrix import dot, matmul, matvec, transpose
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
)

__all__ = ["Universal"]


@dataclass(frozen=True)
class Universal(AbstractTreeJoint, AbstractLoopJoint):
    """R = R_axis(alpha) R_axis2(beta) [rad]: `axis` is held by the parent, `axis2` by the child.

    The two axes are different ones of x, y, z. Closing a loop: the origins coincide and the axes are at right angles,
    four equations.
    """

    axis: Axis = "x"
    axis2: Axis = "y"

    units: ClassVar[tuple[str, ...]] = ("rad", "rad")
    zero: ClassVar[tuple[float, ...]] = (0, 0)
    rows: ClassVar[tuple[str, ...]] = ("x", "y", "z", "right_angle")
    row_units: ClassVar[tuple[str, ...]] = ("m", "m", "m", "rad")

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """The angular velocity in the child's axes is R_axis2(beta)^T axis alpha' + axis2 beta'."""
        alpha, beta = q
        first = elementary_rotation(self.axis, sin(alpha), cos(alpha))
        second = elementary_rotation(self.axis2, sin(beta), cos(beta))
        angular = [matvec(transpose(second), axis_vector(self.axis)), axis_vector(self.axis2)]
        return Motion(Pose(matmul(first, second), [0, 0, 0]), angular, [[0, 0, 0], [0, 0, 0]])

    def closure(self, a: Pose, b: Pose, scalar: ScalarReader) -> list[Any]:
        """Phi = (a - b; axis_a . axis2_b)."""
        return [*difference(a, b), dot(column(a, axis_vector(self.axis)), column(b, axis_vector(self.axis2)))]
