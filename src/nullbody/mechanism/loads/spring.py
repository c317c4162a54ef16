"""Springs and dampers between two points, and along one coordinate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.expr.matrix import add, dot, scale
from nullbody.mechanism.body import GROUND, Placement
from nullbody.mechanism.kinematics import Kinematics
from nullbody.mechanism.loads.base import AbstractLoad
from nullbody.typing import Scalar, Triple

__all__ = ["CoordinateSpring", "Spring"]


@dataclass(frozen=True)
class Spring(AbstractLoad):
    """A spring and damper along the line between two points: f = stiffness (L - length) + damping L'.

    U = stiffness (L - length)^2 / 2. With length 0 nothing is divided by L and the points may meet.

    Attributes:
        body_a, point_a: one end, in that body's frame [m].
        body_b, point_b: the other.
        stiffness: [N/m]
        length: free length [m].
        damping: [N s/m]
    """

    body_a: str = GROUND
    point_a: Triple = (0, 0, 0)
    body_b: str = GROUND
    point_b: Triple = (0, 0, 0)
    stiffness: Scalar = 0
    length: Scalar = 0
    damping: Scalar = 0

    @property
    def bodies(self) -> tuple[str, ...]:
        """Both bodies."""
        return (self.body_a, self.body_b)

    @property
    def scalars(self) -> tuple[Scalar, ...]:
        """Points, stiffness, length, damping."""
        return (*self.point_a, *self.point_b, self.stiffness, self.length, self.damping)

    @property
    def signs(self) -> tuple[tuple[str, Scalar, str], ...]:
        """Free length and damping."""
        return (("the free length", self.length, "non-negative"), ("the damping", self.damping, "non-negative"))

    def potential(self, motion: Kinematics) -> Any:
        """stiffness (L - length)^2 / 2"""
        span, stiffness, length = self._span(motion), motion.scalar(self.stiffness), motion.scalar(self.length)
        if length == 0:
            return stiffness * dot(span, span) / 2
        stretch = motion.sqrt(dot(span, span)) - length
        return stiffness * (stretch * stretch) / 2

    def efforts(self, motion: Kinematics) -> Sequence[tuple[Any, Any]]:
        """(-damping L', L') with L' = d . d' / L"""
        damping = motion.scalar(self.damping)
        if damping == 0:
            return []
        span = self._span(motion)
        ends = ((self.body_b, self.point_b), (self.body_a, self.point_a))
        fast, slow = (motion.velocity(body, motion.triple(point)) for body, point in ends)
        rate = dot(span, add(fast, scale(-1, slow))) / motion.sqrt(dot(span, span))
        return [(-damping * rate, rate)]

    def _span(self, motion: Kinematics) -> list[Any]:
        """d from a to b."""
        a = motion.frame(self.body_a, Placement(self.point_a)).position
        b = motion.frame(self.body_b, Placement(self.point_b)).position
        return add(b, scale(-1, a))


@dataclass(frozen=True)
class CoordinateSpring(AbstractLoad):
    """A spring and damper along one coordinate: -stiffness (q - rest) - damping q'; rotational for an angle.

    Attributes:
        coordinate: which one.
        stiffness: [N/m] or [N m/rad]
        rest: where it is free [m] or [rad].
        damping: [N s/m] or [N m s/rad]
    """

    coordinate: str = ""
    stiffness: Scalar = 0
    rest: Scalar = 0
    damping: Scalar = 0

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The coordinate."""
        return (self.coordinate,)

    @property
    def scalars(self) -> tuple[Scalar, ...]:
        """Stiffness, rest, damping."""
        return (self.stiffness, self.rest, self.damping)

    @property
    def signs(self) -> tuple[tuple[str, Scalar, str], ...]:
        """The damping."""
        return (("the damping", self.damping, "non-negative"),)

    def potential(self, motion: Kinematics) -> Any:
        """stiffness (q - rest)^2 / 2"""
        stretch = motion.coordinate(self.coordinate) - motion.scalar(self.rest)
        return motion.scalar(self.stiffness) * (stretch * stretch) / 2

    def efforts(self, motion: Kinematics) -> Sequence[tuple[Any, Any]]:
        """(-damping q', q')"""
        rate = motion.rate(self.coordinate)
        return [(-motion.scalar(self.damping) * rate, rate)]
