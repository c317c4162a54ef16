"""Rolling without slip, and blades: nonholonomic contact with a plane."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from nullbody.expr.matrix import add, dot, matvec, scale, transpose
from nullbody.mechanism.body import GROUND, Axis, Placement
from nullbody.mechanism.constraints.base import AbstractConstraint
from nullbody.mechanism.joints.base import axis_vector, column
from nullbody.mechanism.kinematics import Kinematics
from nullbody.typing import Scalar

__all__ = ["KnifeEdge", "RollingDisc"]


@dataclass(frozen=True)
class RollingDisc(AbstractConstraint):
    """A thin disc that rolls without slip on the x-y plane of a ground frame, whose z axis points up.

    With the disc's axis n, its centre O and s = sqrt(1 - (z . n)^2), the lowest point of the rim is
    P = O - (r / s) (z - (z . n) n). Equations: P stays in the plane (height, holonomic), the disc's material point at P
    is at rest along x and y (nonholonomic). Residuals are those of the plane minus those of the disc, so that the
    multipliers are the contact force on the disc. It ends where the disc lies flat, s = 0.

    Attributes:
        body: the disc.
        radius: r [m].
        on: frame at the disc's centre.
        axis: the disc's axis in that frame.
        plane: frame on the ground.
    """

    body: str
    radius: Scalar
    on: Placement = field(default_factory=Placement)
    axis: Axis = "x"
    plane: Placement = field(default_factory=Placement)

    def holonomic_rows(self, units: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
        """The height."""
        return (("height", "m"),)

    @property
    def nonholonomic_rows(self) -> tuple[tuple[str, str], ...]:
        """Slip along x and y."""
        return (("slip_x", "m/s"), ("slip_y", "m/s"))

    @property
    def bodies(self) -> tuple[str, ...]:
        """The disc."""
        return (self.body,)

    @property
    def scalars(self) -> tuple[Scalar, ...]:
        """The radius."""
        return (self.radius,)

    @property
    def signs(self) -> tuple[tuple[str, Scalar, str], ...]:
        """The radius."""
        return (("the radius", self.radius, "positive"),)

    @property
    def placements(self) -> tuple[Placement, ...]:
        """Both frames."""
        return (self.on, self.plane)

    def holonomic(self, motion: Kinematics) -> Sequence[Any]:
        """-(z . (O - plane) - r s)"""
        plane, disc = motion.frame(GROUND, self.plane), motion.frame(self.body, self.on)
        up = column(plane, (0, 0, 1))
        return [motion.scalar(self.radius) * self._slope(motion) - dot(up, _from(plane, disc.position))]

    def nonholonomic(self, motion: Kinematics) -> Sequence[Any]:
        """-x . v_P and -y . v_P"""
        plane, disc = motion.frame(GROUND, self.plane), motion.frame(self.body, self.on)
        up, n = column(plane, (0, 0, 1)), column(disc, axis_vector(self.axis))
        lean = dot(up, n)
        down = add(scale(lean, n), scale(-1, up))
        arm = scale(motion.scalar(self.radius) / self._slope(motion), down)
        body = motion.frame(self.body, Placement())
        local = matvec(transpose(body.rotation), add(_from(body, disc.position), arm))
        velocity = motion.velocity(self.body, local)
        return [-dot(column(plane, axis), velocity) for axis in ((1, 0, 0), (0, 1, 0))]

    def _slope(self, motion: Kinematics) -> Any:
        """s = sqrt(1 - (z . n)^2)"""
        lean = dot(
            column(motion.frame(GROUND, self.plane), (0, 0, 1)),
            column(motion.frame(self.body, self.on), axis_vector(self.axis)),
        )
        return motion.sqrt(1 - lean * lean)


@dataclass(frozen=True)
class KnifeEdge(AbstractConstraint):
    """A blade or wheel at a point of a body that moves along itself only: n . v_P = 0, with n the blade's normal.

    Attributes:
        body: what carries it.
        on: frame at the contact point.
        axis: the blade's normal in that frame, the direction in which it cannot move.
    """

    body: str
    on: Placement = field(default_factory=Placement)
    axis: Axis = "y"

    def holonomic_rows(self, units: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
        """None."""
        return ()

    @property
    def nonholonomic_rows(self) -> tuple[tuple[str, str], ...]:
        """Slip across the blade."""
        return (("slip", "m/s"),)

    @property
    def bodies(self) -> tuple[str, ...]:
        """The body."""
        return (self.body,)

    @property
    def placements(self) -> tuple[Placement, ...]:
        """The contact frame."""
        return (self.on,)

    def nonholonomic(self, motion: Kinematics) -> Sequence[Any]:
        """-n . v_P; the multiplier is the force on the body along n."""
        frame = motion.frame(self.body, self.on)
        velocity = motion.velocity(self.body, motion.triple(self.on.position))
        return [-dot(column(frame, axis_vector(self.axis)), velocity)]


def _from(origin: Any, point: Sequence[Any]) -> list[Any]:
    return add(point, scale(-1, origin.position))
