"""Constraints given as expressions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.mechanism.constraints.base import AbstractConstraint
from nullbody.mechanism.kinematics import Kinematics
from nullbody.typing import Scalar

__all__ = ["Holonomic", "Nonholonomic"]


@dataclass(frozen=True)
class Holonomic(AbstractConstraint):
    """residual(q, t) = 0 for each residual, a text in coordinates, parameters and t."""

    residuals: tuple[Scalar, ...]

    def holonomic_rows(self, units: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
        """One equation for each residual."""
        return tuple((str(k + 1), "m") for k in range(len(self.residuals)))

    @property
    def expressions(self) -> tuple[Scalar, ...]:
        """The residuals."""
        return self.residuals

    def holonomic(self, motion: Kinematics) -> Sequence[Any]:
        """The residuals."""
        return [motion.expression(residual) for residual in self.residuals]


@dataclass(frozen=True)
class Nonholonomic(AbstractConstraint):
    """residual(q, q', t) = 0, linear in the rates: a text in coordinates, rates such as x_dot, parameters and t."""

    residuals: tuple[Scalar, ...]

    def holonomic_rows(self, units: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
        """None."""
        return ()

    @property
    def nonholonomic_rows(self) -> tuple[tuple[str, str], ...]:
        """One equation for each residual."""
        return tuple((str(k + 1), "m/s") for k in range(len(self.residuals)))

    @property
    def expressions(self) -> tuple[Scalar, ...]:
        """The residuals."""
        return self.residuals

    def nonholonomic(self, motion: Kinematics) -> Sequence[Any]:
        """The residuals."""
        return [motion.expression(residual) for residual in self.residuals]
