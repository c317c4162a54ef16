"""What a model gives at one state, where it is more than one array."""

from __future__ import annotations

from typing import NamedTuple

from nullbody.typing import FloatArray

__all__ = ["Energy", "NullSpaceValues"]


class Energy(NamedTuple):
    """Kinetic and potential energy [J]."""

    kinetic: float
    potential: float

    @property
    def total(self) -> float:
        """T + U [J]."""
        return self.kinetic + self.potential


class NullSpaceValues(NamedTuple):
    """N (nq x nv), gamma (nq) and delta = |B| at one state."""

    N: FloatArray
    gamma: FloatArray
    delta: float
