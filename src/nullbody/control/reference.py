"""References: desired motions of the independent coordinates with exact derivatives."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from nullbody.errors import InputError
from nullbody.typing import FloatArray

__all__ = ["AbstractReference", "Demand", "Quintic", "Sine", "paper_reference"]


class Demand(NamedTuple):
    """Desired position, rate and acceleration of the independent coordinates at one time."""

    position: FloatArray
    rate: FloatArray
    acceleration: FloatArray


class AbstractReference(ABC):
    """A desired motion of the independent coordinates: `reference(t)` is a `Demand`."""

    @abstractmethod
    def __call__(self, t: float) -> Demand:
        """Position, rate and acceleration at time t [s]."""


@dataclass(frozen=True)
class Sine(AbstractReference):
    """s_i = offset_i + amplitude_i sin(omega t + phase) [47].

    Attributes:
        offset, amplitude: one number for each independent coordinate [m, rad].
        omega: angular frequency [rad/s].
        phase: [rad]
    """

    offset: tuple[float, ...]
    amplitude: tuple[float, ...]
    omega: float = 1.0
    phase: float = 0.0

    def __post_init__(self) -> None:
        _check(self.offset, self.amplitude, self.omega, self.phase)

    def __call__(self, t: float) -> Demand:
        """Exact derivatives: amplitude omega cos, -amplitude omega^2 sin."""
        angle, amplitude = self.omega * t + self.phase, np.array(self.amplitude)
        return Demand(
            np.array(self.offset) + amplitude * np.sin(angle),
            amplitude * (self.omega * np.cos(angle)),
            amplitude * (-(self.omega**2) * np.sin(angle)),
        )


@dataclass(frozen=True)
class Quintic(AbstractReference):
    """Point to point at rest at both ends: s = start + (end - start)(10 x^3 - 15 x^4 + 6 x^5), x = (t - t0)/duration.

    Attributes:
        start, end: one number for each independent coordinate [m, rad].
        duration: [s]
        t0: when it leaves [s].
    """

    start: tuple[float, ...]
    end: tuple[float, ...]
    duration: float
    t0: float = 0.0

    def __post_init__(self) -> None:
        _check(self.start, self.end, self.duration, self.t0)
        if not self.duration > 0:
            raise InputError(f"the duration must be positive, not {self.duration}")

    def __call__(self, t: float) -> Demand:
        """Exact derivatives; before and after the move the reference rests."""
        x = min(max((t - self.t0) / self.duration, 0.0), 1.0)
        start, way = np.array(self.start), np.array(self.end) - np.array(self.start)
        shape = x**3 * (10 + x * (6 * x - 15))
        slope = 30 * x**2 * (1 - x) ** 2 / self.duration
        curvature = 60 * x * (1 - x) * (1 - 2 * x) / self.duration**2
        return Demand(start + way * shape, way * slope, way * curvature)


def paper_reference() -> Sine:
    """The paper's motion of the 3-PRS [47]: 0.6 + (0.2, -0.3, -0.2) sin t [m]."""
    return Sine((0.6, 0.6, 0.6), (0.2, -0.3, -0.2))


def _check(one: Sequence[float], two: Sequence[float], *others: float) -> None:
    """Both vectors of one length, and every number finite."""
    try:
        values = np.array([*one, *two, *others])
    except (TypeError, ValueError):
        values = np.array(None)
    if values.dtype.kind not in "iuf" or not np.isfinite(values).all():
        raise InputError(f"a reference is made of finite numbers, not {one!r}, {two!r} and {others!r}")
    if len(one) != len(two):
        raise InputError(f"a reference needs as many values on both sides: {len(one)} and {len(two)} were given")
