"""Events: moments that are looked for during a simulation, and what happens then."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from numbers import Real

import numpy as np

from nullbody.errors import InputError, StateError
from nullbody.model import Model, State
from nullbody.model.check import check_closed
from nullbody.typing import FloatArray

__all__ = ["Crossing", "Event", "Happened", "accumulating", "changed", "first_crossing"]

_LOOKS = 16  # places within a step at which an event's function is looked at
_CLOSE_LOOKS = 10.0 ** np.arange(-9, 0)  # further places, parts of the first interval, right after an event
_ROUNDING = 4  # roundings of t to which a crossing is located
_SHRINKING = 5  # intervals in a row that become shorter
_SHRUNK = 1e-6  # of the longest interval, where no end of them is in sight
_ZERO = 1e-6  # of the largest value in a step, up to which that of an event that has just happened is zero


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
        if not isinstance(self.direction, Real) or self.direction not in (-1, 0, 1):
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
        except (TypeError, ValueError) as error:
            raise InputError(f"event {self.name!r}: when(t, x) at t = {t:g} s is no finite number: {error}") from error
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


@dataclass(frozen=True, eq=False)
class Crossing:
    """Events that happen at one moment.

    Attributes:
        t: when [s].
        events: which ones, in the order of the list that the user gave.
    """

    t: float
    events: tuple[Event, ...]


def first_crossing(
    events: Sequence[Event], t0: float, t1: float, state: Callable[[float], State], happened: Sequence[Event] = ()
) -> Crossing | None:
    """The first events within a step, located to rounding on the step's interpolant.

    Args:
        events: what to look for.
        t0, t1: the step.
        state: the state at a time within it.
        happened: events at t0, which do not happen there again: rounding may have left them on either side of zero.
    """
    if not events:
        return None
    times = np.linspace(t0, t1, _LOOKS + 1)
    if happened:  # what happened may happen again at once, such as the last bounces of a ball
        times = np.concatenate([[t0], t0 + (times[1] - t0) * _CLOSE_LOOKS, times[1:]])
    states = [state(float(t)) for t in times]
    width = _ROUNDING * float(np.spacing(max(abs(t0), abs(t1))))
    found: list[tuple[float, Event]] = []
    for event in events:
        t = _crossing(event, times, states, state, width, event in happened)
        if t is not None:
            found.append((t, event))
    if not found:
        return None
    first = min(t for t, _ in found)
    return Crossing(first, tuple(event for t, event in found if t <= first + 2 * width))


def _crossing(
    event: Event, times: FloatArray, states: Sequence[State], state: Callable[[float], State], width: float, again: bool
) -> float | None:
    """When an event happens first within a step."""
    from scipy.optimize import brentq

    values = [event.value(float(t), x) for t, x in zip(times, states, strict=True)]
    if again and abs(values[0]) <= _ZERO * max(abs(value) for value in values):
        values[0] = 0.0
    for k, (before, after) in enumerate(pairwise(values)):
        if event.crosses(before, after):
            return float(brentq(lambda t: event.value(t, state(t)), times[k], times[k + 1], xtol=width))
    return None


def changed(model: Model, event: Event, t: float, state: State) -> State:
    """The state that an event makes of another, checked.

    Raises:
        InputError: it is no state of the model.
        StateError: it is not finite, or its loops are open at this time.
    """
    if event.then is None:
        return state
    after: object = event.then(t, state)
    if not isinstance(after, State) or after.coordinates != model.coordinates:
        raise InputError(f"event {event.name!r}: then(t, x) must give a State of the model, not {after!r:.80}")
    if not (np.isfinite(after.q).all() and np.isfinite(after.v).all()):
        raise StateError(f"event {event.name!r}: then(t, x) at t = {t:g} s gives a state that is not finite")
    try:
        check_closed(model, after.q, t)
        return model.own(replace(after, t=t, parameters=model.values))
    except StateError as error:
        raise StateError(f"event {event.name!r}: then(t, x) at t = {t:g} s: {error}") from error


def accumulating(happened: Sequence[Happened], event: Event) -> bool:
    """Whether an event that changes the state happens ever more often: intervals that shrink without end."""
    if event.then is None:
        return False
    intervals = np.diff([one.t for one in happened if one.name == event.name])
    last = intervals[-_SHRINKING:]
    shrinking = len(last) == _SHRINKING and bool((np.diff(last) < 0).all())
    return shrinking and bool(last[-1] < _SHRUNK * intervals.max())
