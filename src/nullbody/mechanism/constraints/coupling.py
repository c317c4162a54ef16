"""Couplings of two coordinates: gears, racks, screws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.mechanism.constraints.base import AbstractConstraint
from nullbody.mechanism.kinematics import Kinematics
from nullbody.typing import Scalar

__all__ = ["Coupling"]


@dataclass(frozen=True)
class Coupling(AbstractConstraint):
    """Phi = driven - ratio driver - offset = 0.

    A gear pair couples two angles with ratio -z1/z2 (+z1/z2 for internal teeth), a rack and pinion a displacement and
    an angle with the pitch radius [m/rad], a screw with lead/(2 pi).

    Attributes:
        driven, driver: coordinates.
        ratio: unit of driven per unit of driver.
        offset: the driven coordinate where the driver is zero.
    """

    driven: str
    driver: str
    ratio: Scalar
    offset: Scalar = 0

    def holonomic_rows(self, units: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
        """One equation, in the unit of the driven coordinate."""
        return (("coupling", units[self.driven]),)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Both coordinates."""
        return (self.driven, self.driver)

    @property
    def scalars(self) -> tuple[Scalar, ...]:
        """Ratio and offset."""
        return (self.ratio, self.offset)

    def holonomic(self, motion: Kinematics) -> Sequence[Any]:
        """driven - ratio driver - offset"""
        along = motion.scalar(self.ratio) * motion.coordinate(self.driver)
        return [motion.coordinate(self.driven) - along - motion.scalar(self.offset)]
