"""Friction in a joint: Coulomb, made smooth at rest, and viscous."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.mechanism.kinematics import Kinematics
from nullbody.mechanism.loads.base import AbstractLoad
from nullbody.typing import Scalar

__all__ = ["Friction"]


@dataclass(frozen=True)
class Friction(AbstractLoad):
    """-coulomb w / sqrt(w^2 + speed^2) - viscous w, with w the rate of a coordinate.

    A regularised law: below `speed` it is viscous, so nothing sticks for ever; it creeps at speed * load / coulomb.
    The Coulomb part does not depend on the joint's reaction.

    Attributes:
        coordinate: which one.
        coulomb: [N] or [N m]
        viscous: [N s/m] or [N m s/rad]
        speed: of the transition [m/s] or [rad/s], above 0.
    """

    coordinate: str = ""
    coulomb: Scalar = 0
    viscous: Scalar = 0
    speed: Scalar = 0.001

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The coordinate."""
        return (self.coordinate,)

    @property
    def scalars(self) -> tuple[Scalar, ...]:
        """Coulomb, viscous, speed."""
        return (self.coulomb, self.viscous, self.speed)

    @property
    def signs(self) -> tuple[tuple[str, Scalar, str], ...]:
        """All of them."""
        positive, other = "positive", "non-negative"
        return (("coulomb", self.coulomb, other), ("viscous", self.viscous, other), ("speed", self.speed, positive))

    def efforts(self, motion: Kinematics) -> Sequence[tuple[Any, Any]]:
        """(-coulomb w / sqrt(w^2 + speed^2) - viscous w, w)"""
        rate, speed = motion.rate(self.coordinate), motion.scalar(self.speed)
        effort = -motion.scalar(self.viscous) * rate
        coulomb = motion.scalar(self.coulomb)
        if coulomb != 0:
            effort = effort - coulomb * rate / motion.sqrt(rate * rate + speed * speed)
        return [(effort, rate)]
