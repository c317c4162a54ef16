"""What a constraint that is no joint must provide. A new one is one file in this folder."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.mechanism.body import Placement
from nullbody.mechanism.kinematics import Kinematics
from nullbody.typing import Scalar

__all__ = ["AbstractConstraint"]


@dataclass(frozen=True)
class AbstractConstraint(ABC):
    """Equations between coordinates, their rates and the time.

    Attributes:
        name: unique among joints and constraints.
    """

    name: str

    @abstractmethod
    def holonomic_rows(self, units: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
        """(name, unit) of each equation Phi(q, t) = 0, given the units of all coordinates."""

    @property
    def nonholonomic_rows(self) -> tuple[tuple[str, str], ...]:
        """(name, unit) of each equation in rates that no equation in q stands behind."""
        return ()

    @property
    def bodies(self) -> tuple[str, ...]:
        """Bodies that it names."""
        return ()

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Coordinates that it names."""
        return ()

    @property
    def scalars(self) -> tuple[Scalar, ...]:
        """Its numbers and texts in parameters."""
        return ()

    @property
    def expressions(self) -> tuple[Scalar, ...]:
        """Its texts in parameters, coordinates, rates and t."""
        return ()

    @property
    def signs(self) -> tuple[tuple[str, Scalar, str], ...]:
        """(what, scalar, "positive" or "non-negative") of scalars that must not be of another sign."""
        return ()

    @property
    def placements(self) -> tuple[Placement, ...]:
        """The frames that it names."""
        return ()

    def holonomic(self, motion: Kinematics) -> Sequence[Any]:
        """Phi(q, t), one residual for each of `holonomic_rows`."""
        return []

    def nonholonomic(self, motion: Kinematics) -> Sequence[Any]:
        """Residuals that are linear in the rates, one for each of `nonholonomic_rows`."""
        return []
