"""Events: moments that are looked for during a simulation, and what happens then."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from nullbody.errors import InputError
from nullbody.model import State

__all__ = ["Event", "Happened", "first_crossing"]

_LOOKS = 4  # places within a step at which an event's function is looked at
_ROUNDING = 4  # roundings of t to which a crossing is located


@dataclass(frozen=True)
class Event:
    """Something that happens where a function of time and state passes through zero.

    Attributes:
        name: what it is called in the trajectory.
        when: when(t, x), continuous; x has x.q, x.v and x["coordinate"].
        direction: +1 for rising through zero, -1 for falling, 0 for both.
        terminal: whether the simulation ends there.
        then: then(t, x) -> the state to go on from, such as after an impact; the same state by default.
    """

    name: str
    when: Callable[[float, State], float]
    direction: int = 0
    terminal: bool = False
    then: Callable[[float, State], State] | None = None

    def __post_init__(self) -> None:
        if self.direction not in (-1, 0, 1):
            raise InputError(f"the direction of event {self.name!r} is -1, 0 or +1, not {self.direction!r}")
        functions: tuple[object, ...] = (self.when,) if self.then is None else (self.when, self.then)
        if not all(callable(function) for function in functions):
            raise InputError(f"event {self.name!r} needs functions when(t, x) and then(t, x)")

    def value(self, t: float, x: State) -> float:
        """when(t, x), a finite number.

        Raises:
            InputError: it is something else.
        """
        try:
            value = float(self.when(t, x))
        except (TypeError, ValueError):
            value = float("nan")
        if not np.isfinite(value):
            raise InputError(f"event {self.name!r}: when(t, x) at t = {t:g} s is no finite number")
        return value

    def crosses(self, before: float, after: float) -> bool:
        """Whether zero is passed in the wanted direction; starting at zero is not passing it."""
        if before == 0 or np.sign(before) == np.sign(after):
            return False
        return self.direction in (0, 1 if after > before else -1)


@dataclass(frozen=True, eq=False)
class Happened:
    """An event that happened.

    Attributes:
        name: of the event.
        t: when [s].
        state: the state right before what `then` makes of it.
    """

    name: str
    t: float
    state: State


def first_crossing(
    events: Sequence[Event], t0: float, t1: float, state: Callable[[float], State]
) -> tuple[float, Event] | None:
    """The first event within a step, located to rounding on the step's interpolant."""
    from scipy.optimize import brentq

    if not events:
        return None
    times = np.linspace(t0, t1, _LOOKS + 1)
    states = [state(float(t)) for t in times]
    best: tuple[float, Any] | None = None
    for event in events:
        values = [event.value(float(t), x) for t, x in zip(times, states, strict=True)]
        for k in range(_LOOKS):
            if event.crosses(values[k], values[k + 1]):
                width = _ROUNDING * np.spacing(max(abs(t0), abs(t1)))
                found = float(brentq(lambda t, e=event: e.value(t, state(t)), times[k], times[k + 1], xtol=width))
                if best is None or found < best[0]:
                    best = found, event
                break
    return best
