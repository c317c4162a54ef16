"""A chart's kernels at y = (q, v, W), with memory of their own: what every step asks for, without copies.

landing:   |B|, |N|^2 and doubt; q with its loops closed, the independent coordinates held
attempts:  Runge-Kutta attempts for constant inputs, one native call each
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from nullbody.kernels import Attempt, Bounds, Closing, Evaluation, Guard, Part, Steps
from nullbody.model import Model
from nullbody.simulate.dense import Dense
from nullbody.simulate.dop853 import TABLEAU
from nullbody.simulate.outcome import Outcome
from nullbody.simulate.stepper import Ahead, Landing, Step, coefficients
from nullbody.tolerances import (
    CLOSED_STEP,
    LARGE_SPREAD,
    REGULAR_DOUBT,
    REGULAR_LOSS,
    SETTLED,
    SWITCH_DOUBT,
    SWITCH_SPREAD,
)
from nullbody.typing import FloatArray

__all__ = ["Native", "NativeAttempts"]

_USED = slice(5, 13)  # stages that dense output needs, besides the first


class Native:
    """The kernels of a chart. Threads may use it at the same time.

    Args:
        chart: the model in the independent coordinates in use.
        scale: what coordinates are measured in, for |N|.

    Attributes:
        closing: Newton's method on the loops.
        places: of |B|, |N|^2 and doubt among the outputs of the program kinematics.
        lock: is held while the kernels' memory is in use.
    """

    def __init__(self, chart: Model, scale: FloatArray) -> None:
        columns = chart.independent_columns
        self._y = y = np.zeros(len(chart.coordinates) + len(columns) + 1)
        self.lock = threading.Lock()
        kernels, fixed = chart.library.kernels, {"p": np.array(chart.values)}
        self._kinematics = Evaluation(kernels["kinematics"], y, ("q", "v"), fixed)
        self._closure = Evaluation(kernels["closure"], y, ("q",), fixed)
        self._energy = Evaluation(kernels["energy"], y, ("q", "q_dot"), fixed)
        self.closing = Closing(
            y,
            residual=Part(self._closure, "Phi"),
            correction=Part(Evaluation(kernels["closing"], y, ("q",), fixed), "correction"),
            matrix=Part(self._kinematics, "N"),
            weights=(scale[columns] / scale[:, None]).ravel(),
            measure="doubt",
            bounds=Bounds(matrix=SWITCH_SPREAD, measure=SWITCH_DOUBT, open=CLOSED_STEP, short=SETTLED),
        )
        starts = self._kinematics.starts
        self.places = starts["delta"], starts["spread"], starts["doubt"]

    def landing(self, t: float, y: FloatArray) -> Landing:
        """Measure the chart, and close the loops where it is a good one."""
        delta, spread, doubt = self.places
        with self.lock:
            self._y[:] = y
            steps = self.closing(t)
            before, after, scaled = self.closing.results
            found = self._kinematics.target.item
            y = self._y.copy() if steps else y
            return Landing(y, before, after, scaled, found(delta), found(spread), found(doubt))

    def rate(self, t: float, y: FloatArray) -> FloatArray:
        """q'."""
        with self.lock:
            self._y[:] = y
            self._kinematics(t)
            return self._kinematics.outputs["q_dot"].copy()

    def rates(self, t: FloatArray, y: FloatArray) -> FloatArray:
        """q' at many times, a row for each."""
        with self.lock:
            return self._kinematics.rows(t, y, "q_dot")

    def gaps(self, t: FloatArray, y: FloatArray) -> FloatArray:
        """The largest |Phi| at many times."""
        with self.lock:
            found: FloatArray = np.abs(self._closure.rows(t, y, "Phi")).max(axis=1, initial=0.0)
        return found

    def energies(self, t: FloatArray, q: FloatArray, q_dot: FloatArray) -> FloatArray:
        """Kinetic and potential energy at many times, times x 2 [J]."""
        y = np.hstack([q, q_dot])
        with self.lock:
            return np.stack([self._energy.rows(t, y, name) for name in ("T", "U")], axis=1)


class NativeAttempts:
    """The forward dynamics, and attempts of steps for constant inputs.

    Args:
        chart: the model in the independent coordinates in use.
        native: its kernels.
        u: the inputs.
        side: the sign that |B| must keep, or None where it may change.
        tolerances: relative and absolute.
        refuse: is told why y' was refused.
    """

    def __init__(
        self,
        chart: Model,
        native: Native,
        u: FloatArray,
        side: float | None,
        tolerances: tuple[float, float],
        refuse: Callable[[Outcome], None],
    ) -> None:
        nq, independent = len(chart.coordinates), chart.independent_columns
        n = nq + len(independent) + 1
        fixed = {"u": u, "p": np.array(chart.values)}
        program = Evaluation(chart.library.kernels["forward_dynamics"], np.zeros(n), ("q", "v"), fixed)
        at = program.starts
        places = [*range(at["q_dot"], at["q_dot"] + nq), *(at["q_ddot"] + k for k in independent), at["power"]]
        regular = [Guard(at["doubt"], 1, -math.inf, REGULAR_DOUBT)]
        if side is not None:
            regular.append(Guard(at["delta"], 1, *_bounds(side)))
        finite = [Guard(at["loss"], 1, -REGULAR_LOSS, REGULAR_LOSS), Guard(at["q_ddot"], nq, -math.inf, math.inf)]
        self._regular = len(regular)
        self._u = program.inputs["u"]
        self._native, self._program, self._refuse = native, program, refuse
        self._attempt = Attempt(TABLEAU, program, np.array(places), [*regular, *finite], *tolerances)
        self.y1 = self._attempt.y1
        self._steps = Steps(self._attempt, native.closing, native.places, _USED)
        self.f1 = self._attempt.stages[TABLEAU.stages - 1]

    def rate(self, t: float, y: FloatArray, u: FloatArray | None = None) -> FloatArray:
        """y', or NaN where it is refused; for other inputs where they are given."""
        attempt = self._attempt
        attempt.y[:] = y
        if u is not None:
            self._u[:] = u
        status = attempt.rate(t)
        return attempt.stages[0].copy() if status == 0 else self._refused(status)

    def attempt(self, t: float, h: float, y: FloatArray, f: FloatArray) -> float:
        """Attempt a step; its error against the tolerances, or NaN where y' is refused on the way."""
        attempt = self._attempt
        attempt.y[:] = y
        attempt.stages[0] = f
        status = attempt(t, h)
        if status == 0:
            return attempt.error
        self._refused(status)
        return math.nan

    def ahead(
        self, t: float, y: FloatArray, f: FloatArray, end: float, lengths: tuple[float, float], count: int
    ) -> Iterator[Ahead]:
        """Steps made at once, each with what follows from it where it is taken."""
        with self._native.lock:
            made = self._steps(t, y, f, end, lengths, count)
        rows = zip(made.numbers, made.raw, made.y, made.f, made.stages, strict=True)
        for numbers, raw, closed, f1, used in rows:
            t1, h, following, tries, before, after, scaled, moved, delta, spread, doubt = numbers
            step = Step(t, h, y, f, raw)
            landing = Landing(closed if moved else raw, before, after, scaled, delta, spread, doubt)
            yield Ahead(t1, following, int(tries), raw, f1, landing, Dense(t, h, y, partial(self._made, step, used)))
            t, y, f = t1, landing.y, f1

    def dense(self, step: Step) -> Dense:
        """y over the last attempt, which became a step; its further stages are made when they are needed."""
        return Dense(step.t, step.h, step.y, partial(self._made, step, self._attempt.stages[_USED].copy()))

    def _made(self, step: Step, used: FloatArray) -> FloatArray:
        """F of a step from the stages that it used."""
        attempt = self._attempt
        with self._native.lock:
            attempt.y[:] = step.y
            attempt.stages[0], attempt.stages[_USED] = step.f, used
            if attempt.more(step.t, step.h) != 0:
                attempt.stages[TABLEAU.stages :] = np.nan
            return coefficients(step, attempt.stages)

    def _refused(self, status: int) -> FloatArray:
        """Why a guard did not hold; NaN."""
        if 0 < status <= self._regular:
            self._refuse(Outcome.SINGULAR_INDEPENDENT_SET)
        elif status > 0:
            massless = self._program.outputs["spread"] < LARGE_SPREAD
            self._refuse(Outcome.SINGULAR_MASS_MATRIX if massless else Outcome.SINGULAR_INDEPENDENT_SET)
        return np.full(len(self.y1), np.nan)


def _bounds(sign: float) -> tuple[float, float]:
    """Between which numbers of a sign lie."""
    least = math.ulp(0.0)
    return (0.0, math.inf) if sign > 0 else (-math.inf, 0.0) if sign < 0 else (-least, least)
