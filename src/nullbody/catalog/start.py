"""Start: the initial state from which a published motion begins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from nullbody.errors import UnknownName
from nullbody.expr.parse import parse
from nullbody.mechanism import Mechanism
from nullbody.typing import Scalar

__all__ = ["Start"]


@dataclass(frozen=True)
class Start:
    """Where a motion begins: every coordinate and rate of a mechanism, closed up to rounding.

        start = catalog.starts("rolling_disc")["steady"]
        model = build(derive(start.mechanism))
        state = consistent(model, start.q, start.q_dot).state
        found = simulate(model, state, start.duration)

    Attributes:
        mechanism: with the parameter values of this motion.
        coordinates: those that are not at home, numbers or texts in parameters [m, rad].
        rates: those that are not zero [m/s, rad/s].
        duration: of the published motion [s].
        source: who published it.

    Raises:
        UnknownName: a name is no coordinate of the mechanism.
    """

    mechanism: Mechanism
    coordinates: Mapping[str, Scalar] = field(default_factory=dict)
    rates: Mapping[str, Scalar] = field(default_factory=dict)
    duration: float = 1.0
    source: str = ""

    def __post_init__(self) -> None:
        for name in (*self.coordinates, *self.rates):
            if name not in self.mechanism.coordinates:
                raise UnknownName("coordinate", name, self.mechanism.coordinates)

    @property
    def q(self) -> dict[str, float]:
        """All coordinates by name."""
        values = self.mechanism.values()
        return self.mechanism.home_values(values) | _numbers(self.coordinates, values)

    @property
    def q_dot(self) -> dict[str, float]:
        """All rates by name."""
        return dict.fromkeys(self.mechanism.coordinates, 0.0) | _numbers(self.rates, self.mechanism.values())


def _numbers(texts: Mapping[str, Scalar], values: Mapping[str, float]) -> dict[str, float]:
    return {name: float(parse(text, values.__getitem__)) for name, text in texts.items()}
