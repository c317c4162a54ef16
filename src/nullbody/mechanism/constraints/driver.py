"""Drivers: a coordinate that follows the time (rheonomic)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.mechanism.constraints.base import AbstractConstraint
from nullbody.mechanism.kinematics import Kinematics
from nullbody.typing import Scalar

__all__ = ["Driver"]


@dataclass(frozen=True)
class Driver(AbstractConstraint):
    """Phi = coordinate - f(t) = 0. Its multiplier is minus the force [N] or torque [N m] that the drive must give.

    Attributes:
        coordinate: which one.
        motion: f, a text in t and parameters.
    """

    coordinate: str
    motion: Scalar

    def holonomic_rows(self, units: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
        """One equation, in the unit of the coordinate."""
        return (("drive", units[self.coordinate]),)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The driven coordinate."""
        return (self.coordinate,)

    @property
    def expressions(self) -> tuple[Scalar, ...]:
        """f"""
        return (self.motion,)

    def holonomic(self, motion: Kinematics) -> Sequence[Any]:
        """coordinate - f(t)"""
        return [motion.coordinate(self.coordinate) - motion.expression(self.motion)]
