"""DOP853: the explicit Runge-Kutta method of order 8 by Dormand and Prince, with adaptive steps.

An attempt from (t, y) over h gives y1 and an error against the tolerances,

    error < 1:  t + h, y1, and the next h is at most 10 times, 0.9 error^(-1/8) times this one
    otherwise:  again with 0.9 error^(-1/8) h, at least h / 5; where y' is refused, with h / 5

The steps are those of scipy.integrate.DOP853. Who makes the attempts is left open: native
code where y' is a program (`native.py`), or `ByRate`, which calls a function for each stage.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import cache
from typing import NamedTuple, Protocol

import numpy as np

from nullbody.simulate.dense import Dense
from nullbody.simulate.dop853 import INTERPOLATION, TABLEAU
from nullbody.typing import FloatArray

__all__ = ["Ahead", "Attempts", "ByRate", "Landing", "Step", "Stepper", "coefficients"]

_SAFETY, _SHORTEST, _LONGEST = 0.9, 0.2, 10.0
_EXPONENT = -1 / 8
_FEW, _MOST = 4, 64  # steps in advance: at first, and later
_INNER = 10  # spacings of floating-point numbers at t that a step is long at least
_TOO_SHORT = "Required step size is less than spacing between numbers."


class Step(NamedTuple):
    """From (t, y) with y' = f over h to y1."""

    t: float
    h: float
    y: FloatArray
    f: FloatArray
    y1: FloatArray


class Landing(NamedTuple):
    """Where a step ended.

    Attributes:
        y: with the loops closed where the chart is a good one, the independent coordinates held.
        before, after: the largest |Phi| before and after.
        scaled, delta, spread, doubt: what tells how good the chart is: |N|^2 in radians and typical lengths, |B|, |N|^2
            as it is, and doubt; before.
    """

    y: FloatArray
    before: float
    after: float
    scaled: float
    delta: float
    spread: float
    doubt: float


class Ahead(NamedTuple):
    """A step that was made in advance.

    Attributes:
        t1, following: its end, and the length of the step after it.
        attempts: how many it took.
        y1: its end as the method gave it.
        f1: y' at its end with the loops closed.
        landing: what follows from y1.
        dense: y over it.
    """

    t1: float
    following: float
    attempts: int
    y1: FloatArray
    f1: FloatArray
    landing: Landing
    dense: Dense


class Attempts(Protocol):
    """Who makes attempts of steps."""

    y1: FloatArray  # where the last attempt ended
    f1: FloatArray  # y' there

    def rate(self, t: float, y: FloatArray) -> FloatArray:
        """y', or NaN where it is refused."""

    def attempt(self, t: float, h: float, y: FloatArray, f: FloatArray) -> float:
        """Attempt a step; its error against the tolerances, or NaN where y' is refused on the way."""

    def dense(self, step: Step) -> Dense:
        """y over the last attempt, which became a step."""

    def ahead(
        self, t: float, y: FloatArray, f: FloatArray, end: float, lengths: tuple[float, float], count: int
    ) -> Iterator[Ahead]:
        """Up to `count` steps made at once, each from where the one before it landed; `lengths`: first and longest."""


class Stepper:
    """Steps from (t, y) until t1.

    Args:
        attempts: chosen anew before each step.
        t, y: the begin.
        t1: the end.
        tolerances: relative and absolute.
        max_step: the longest step.
        first_step: the length of the first one; by default from the size of y' and y''.

    Attributes:
        t, y, f: where it is, and y' there.
        status: "running", "finished", or "failed".
        nfev: evaluations of y' in steps.
        step_size: the length of the last step.
        landing: what follows from y, where it is known; f is then y' at landing.y, and steps go on from there after
            `move(landing.y)`.
    """

    def __init__(
        self,
        attempts: Callable[[], Attempts],
        t: float,
        y: FloatArray,
        t1: float,
        tolerances: tuple[float, float],
        max_step: float = np.inf,
        first_step: float | None = None,
    ) -> None:
        self._choose, self.t, self.y, self._end = attempts, t, y, t1
        self._max = max_step
        self._attempts = attempts()
        self.f = self._attempts.rate(t, y)
        self._next = self._first(tolerances) if first_step is None else first_step
        self._last: Step | Dense  # the last step, or y over it
        self._queue: Iterator[Ahead] = iter(())
        self._taken = 0  # steps of the queue
        self._expected = y  # from where the queue goes on
        self.landing: Landing | None = None
        self.status = "running"
        self.nfev = 0
        self.step_size: float | None = None

    def step(self) -> str | None:
        """Make a step; says why where that is not possible."""
        attempts = self._choose()
        ahead = next(self._queue, None) if self.y is self._expected and attempts is self._attempts else None
        self._attempts = attempts
        if ahead is None:
            lengths = self._next, self._max
            count = min(max(_FEW, 2 * self._taken), _MOST)
            self._queue, self._taken = attempts.ahead(self.t, self.y, self.f, self._end, lengths, count), 0
            ahead = next(self._queue, None)
        if ahead is None:
            return self._attempted()
        self._taken += 1
        self.step_size = ahead.t1 - self.t
        self.nfev += _STAGES * ahead.attempts
        self.t, self._next, _, self.y, self.f, self.landing, self._last = ahead
        self._expected = self.landing.y
        if self.t >= self._end:
            self.status = "finished"
        return None

    def _attempted(self) -> str | None:
        """Make a step, attempt by attempt."""
        t, y, f, attempts = self.t, self.y, self.f, self._attempts
        least = _INNER * (math.nextafter(t, math.inf) - t)
        h = self._max if self._next > self._max else max(self._next, least)
        limit = _LONGEST
        while True:
            if not h >= least:  # or where y' is refused at the begin already
                self.status = "failed"
                return _TOO_SHORT
            t1 = min(t + h, self._end)
            h = t1 - t
            self.nfev += _STAGES
            error = attempts.attempt(t, h, y, f)
            if error < 1:
                break
            limit = 1.0
            h *= max(_SHORTEST, _SAFETY * error**_EXPONENT)  # of a NaN: the shortest
        self._next = h * (limit if error == 0 else min(limit, _SAFETY * error**_EXPONENT))
        self.t, self.y, self.f, self.step_size = t1, attempts.y1.copy(), attempts.f1.copy(), h
        self._expected, self.landing = self.y, None
        self._last = Step(t, h, y, f, self.y)
        if t1 >= self._end:
            self.status = "finished"
        return None

    def move(self, y: FloatArray) -> None:
        """Go on from another y, such as one with the loops closed."""
        if y is not self._expected:
            self.f = self._attempts.rate(self.t, y)
        self.y = y

    def dense_output(self) -> Dense:
        """y over the last step."""
        return self._attempts.dense(self._last) if isinstance(self._last, Step) else self._last

    def _first(self, tolerances: tuple[float, float]) -> float:
        """The length of the first step (Hairer, Norsett and Wanner I, section II.4)."""
        rtol, atol = tolerances
        t, y, f, length = self.t, self.y, self.f, self._end - self.t
        scale = atol + rtol * np.abs(y)

        def norm(x: FloatArray) -> float:
            with np.errstate(over="ignore", invalid="ignore"):
                return float(np.linalg.norm(x / scale)) / len(x) ** 0.5

        d0, d1 = norm(y), norm(f)
        h0 = min(1e-6 if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1, length)
        if not h0 > 0:  # y' beyond all doubles: no step is short enough
            return 0.0
        d2 = norm(self._attempts.rate(t + h0, y + h0 * f) - f) / h0
        h1 = max(1e-6, 1e-3 * h0) if d1 <= 1e-15 and d2 <= 1e-15 else (0.01 / max(d1, d2)) ** (1 / 8)
        return min(100 * h0, h1, length, self._max)


_STAGES = 12


class ByRate:
    """Attempts with a function for y'.

    Args:
        rate: y'(t, y), or NaN where it is refused.
        size: of y.
        tolerances: relative and absolute.
    """

    def __init__(self, rate: Callable[[float, FloatArray], FloatArray], size: int, tolerances: tuple[float, float]):
        self._rate, self._tolerances = rate, tolerances
        self._K = np.empty((_STAGES + 1 + len(TABLEAU.C_more), size))
        self.y1 = self.f1 = np.empty(size)

    def rate(self, t: float, y: FloatArray) -> FloatArray:
        """y', or NaN where it is refused."""
        with np.errstate(all="ignore"):
            return self._rate(t, y)

    def attempt(self, t: float, h: float, y: FloatArray, f: FloatArray) -> float:
        """Attempt a step; its error against the tolerances, or NaN where y' is refused on the way."""
        A, B, C, E5, E3, _, _ = _arrays()
        K, rtol, atol = self._K, *self._tolerances
        K[0] = f
        with np.errstate(all="ignore"):  # trial steps into a singularity are rejected
            for s in range(1, _STAGES):
                K[s] = self._rate(t + C[s] * h, y + h * (A[s, :s] @ K[:s]))
            self.y1 = y + h * (B @ K[:_STAGES])
            self.f1 = K[_STAGES] = self._rate(t + h, self.y1)
            scale = atol + rtol * np.maximum(np.abs(y), np.abs(self.y1))
            five, three = (E @ K[: _STAGES + 1] / scale for E in (E5, E3))
            square = five @ five
            both = square + 0.01 * (three @ three)
            return float(h * square / np.sqrt(both * len(y))) if both != 0 else 0.0

    def ahead(
        self, t: float, y: FloatArray, f: FloatArray, end: float, lengths: tuple[float, float], count: int
    ) -> Iterator[Ahead]:
        """None: steps are made attempt by attempt."""
        return iter(())

    def dense(self, step: Step) -> Dense:
        """y over the last attempt, which became a step."""
        *_, A_more, C_more = _arrays()
        K = self._K
        with np.errstate(all="ignore"):
            for s, (a, c) in enumerate(zip(A_more, C_more, strict=True), start=_STAGES + 1):
                K[s] = self._rate(step.t + c * step.h, step.y + step.h * (a[:s] @ K[:s]))
        return Dense(step.t, step.h, step.y, coefficients(step, K))


@cache
def _arrays() -> tuple[FloatArray, ...]:
    """A, B, C, E5, E3, A_more, C_more."""
    return tuple(np.array(getattr(TABLEAU, name)) for name in ("A", "B", "C", "E5", "E3", "A_more", "C_more"))


def coefficients(step: Step, K: FloatArray) -> FloatArray:
    """F, 7 x n, of dense output, from all 16 stages; a cubic where y' is refused at the further ones.

    That happens on steps of a few roundings of t, right before a singularity.
    """
    F = np.empty((7, K.shape[1]))
    h, change = step.h, step.y1 - step.y
    F[0] = change
    F[1] = h * K[0] - change
    F[2] = 2 * change - h * (K[_STAGES] + K[0])
    F[3:] = h * (INTERPOLATION @ K) if np.isfinite(K[_STAGES + 1 :]).all() else 0.0
    return F
