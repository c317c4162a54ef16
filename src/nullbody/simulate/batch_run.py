"""The march of many robots from result to result: inputs held, charts changed, and why each robot stops.

Robots are in fleets, one for each chart. One that comes where its chart is poor leaves for a fleet whose chart is good
there: those that exist are tried first, for all such robots at once.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nullbody.errors import InputError, SingularityError
from nullbody.kinematics import regular_chart
from nullbody.model import Model
from nullbody.model.batch import BatchCall
from nullbody.simulate.batch_fleet import CODES, BatchSettings, Fleet, Travellers
from nullbody.simulate.outcome import Outcome
from nullbody.tolerances import EPS, LARGE_SPREAD, REGULAR_DOUBT, REGULAR_LOSS, SIMULATED_SPREAD, SWITCH_DOUBT
from nullbody.typing import FloatArray, IndexArray

__all__ = ["BatchRun", "Inputs"]

_FIRST = 0.1  # first step against the first interval
_AGAIN = 1e-3  # first step in another chart, likewise
_POOR = 1e2  # |N|^2 against the least seen in a chart, or 1, from which a robot looks for another chart
_BETTER = 0.1  # of the threshold of a chart, below which a robot may enter
_UNSURE = 1e4  # doubt likewise: determinants at 1e-4 of the product of column lengths, or a hundredth of what they were
_LOST = 1e12  # doubt at which a robot ends that has found no better chart
_NEAR = 1e-3  # regularity of A against that at the start, below which it is a configuration singularity
_SOME = 1000  # robots at whose start regularity is looked at
_CHARTS = 24  # fleets at most
_IDLE = 3  # charts that a robot leaves without a step before it stays for good
_ROUNDS = 100  # changes of chart of a robot within one interval

#: inputs(interval, t, q, v) -> (nu,) or (robots, nu)
Inputs = Callable[[int, float, FloatArray, FloatArray], FloatArray]

_LEAVES = ("delta", "doubt", "spread", "loss", "watched")  # why a robot may look for another chart
_OUTCOMES = {
    "delta": Outcome.SINGULAR_INDEPENDENT_SET,
    "doubt": Outcome.SINGULAR_INDEPENDENT_SET,
    "spread": Outcome.SINGULAR_INDEPENDENT_SET,
    "not_finite": Outcome.NOT_FINITE,
    "too_small": Outcome.STEP_TOO_SMALL,
    "input": Outcome.NOT_FINITE,
    "open": Outcome.LOOPS_OPEN,
    "many": Outcome.TOO_MANY_STEPS,
    "configuration": Outcome.CONFIGURATION_SINGULARITY,
}


def _chart(model: Model) -> tuple[tuple[str, ...], ...]:
    """What tells the kernels of one chart from those of another."""
    return model.independent, model.labels, model.basis


def _unseen(part: float) -> None:
    """Progress of robots that have been counted already."""


class _Part:
    """Shows the progress of one fleet as that of all."""

    def __init__(self, show: Callable[[float], None], begin: float, end: float, done: float, share: float) -> None:
        self.show, self.begin, self.length, self.done, self.share = show, begin, end - begin, done, share

    def __call__(self, part: float) -> None:
        """Take the part of the fleet that is there."""
        self.show(self.begin + self.length * min(1.0, self.done + part * self.share))


class BatchRun:
    """Robots on their way.

    Args:
        model: the model.
        settings: how to step.
        inputs: u, evaluated at the begin of every interval.
        parameters: (np,) or (robots, np).

    Attributes:
        residual: (robots,) largest |Phi| at a result so far.
        energy_drift: (robots,) likewise |T + U - work - initial value|.
        switches: changes of independent coordinates of all robots.
    """

    def __init__(self, model: Model, settings: BatchSettings, inputs: Inputs, parameters: FloatArray) -> None:
        self.model, self.settings, self.inputs, self.p = model, settings, inputs, parameters
        self.nq, self.nv, self.nu = len(model.coordinates), len(model.independent), len(model.inputs)
        self.fleets: list[Fleet] = []
        self.switches = 0

    def start(self, q: FloatArray, v: FloatArray, t: float, first: float) -> None:
        """Put the robots at their states; `first` is the first interval [s]."""
        self.robots = len(q)
        robots: IndexArray = np.arange(self.robots)
        call = BatchCall(self.model, {"t": t, "parameters": self.p}, self.robots, np.dtype(np.float64))
        spread, doubt = call("forward_dynamics", ("spread", "doubt"), q, v, np.zeros(self.nu))
        if self.settings.switch:
            home = self._watched(self.model, *(float(np.nanmin(x, initial=np.inf)) for x in (spread, doubt)))
        else:
            home = Fleet(self.model, self.settings, self.p, None, REGULAR_DOUBT)
        self.fleets.append(home)
        self._step = _AGAIN * first
        self._left, self._idle = np.full(self.robots, -np.inf), np.zeros(self.robots, dtype=np.intp)
        none, whole = np.zeros(self.robots, dtype=np.int64), np.ones(self.robots)
        lanes = {"time": t * whole, "step": _FIRST * first * whole, "accepted": none, "refused": none}
        home.add(Travellers(robots, q, call("kinematics", ("q_dot",), q, v)[0], 0.0 * whole, lanes))
        self._regular = float(home.regularity(robots[:_SOME]).max(initial=0.0)) if self.settings.switch else 0.0
        if home.watch is not None:
            home.lanes.put_each("status", np.where(spread > home.watch, CODES["watched"], 0))
        self.residual, self.energy_drift = np.zeros(self.robots), np.zeros(self.robots)
        self._energy, gaps = home.measured()
        np.maximum(self.residual, gaps, out=self.residual)

    def _watched(self, model: Model, spread: float, doubt: float) -> Fleet:
        """A fleet whose robots leave where |N|^2 or doubt have grown far beyond their least values."""
        least = [max(1.0, value) if np.isfinite(value) else 1.0 for value in (spread, doubt)]
        watch = min(_POOR * least[0], SIMULATED_SPREAD / 10)
        return Fleet(model, self.settings, self.p, watch, min(max(SWITCH_DOUBT, _UNSURE * least[1]), REGULAR_DOUBT))

    @property
    def running(self) -> NDArray[np.bool_]:
        """Which robots go on."""
        return self._gathered(lambda fleet: fleet.running, np.zeros(self.robots, dtype=bool))

    def each(self, name: str) -> NDArray[Any]:
        """One of the arrays of the lanes, for every robot."""
        kind = self.fleets[0].lanes.each(name).dtype
        return self._gathered(lambda fleet: fleet.lanes.each(name), np.zeros(self.robots, dtype=kind))

    def state(self) -> tuple[FloatArray, FloatArray]:
        """q and v of all robots, in the model's own chart; those that have ended where they did."""
        q, v = np.empty((self.robots, self.nq)), np.empty((self.robots, self.nv))
        for fleet in self.fleets:
            y = fleet.y()
            q[fleet.robots] = y[:, : self.nq]
            v[fleet.robots] = (
                y[:, self.nq : -1]
                if fleet.model.independent == self.model.independent
                else fleet.rates()[:, self.model.independent_columns]
            )
        return q, v

    def _gathered(self, of: Callable[[Fleet], NDArray[Any]], result: NDArray[Any]) -> NDArray[Any]:
        for fleet in self.fleets:
            result[fleet.robots] = of(fleet)
        return result

    def advance(self, interval: int, begin: float, end: float, show: Callable[[float], None]) -> None:
        """March to the next result."""
        parts = max(1, int(np.ceil((end - begin) / self.settings.hold - EPS**0.5)))
        times = np.linspace(begin, end, parts + 1).tolist()
        for a, b in pairwise(times):
            self._u = self._evaluated(interval, a)
            for fleet in self.fleets:
                self._hold(fleet)
            self._to(a, b, show)
        for fleet in self.fleets:
            if self.settings.projection:
                fleet.polish(end)
            energy, gaps = fleet.measured()
            for kept, values in ((self.energy_drift, energy - self._energy[fleet.robots]), (self.residual, gaps)):
                here = np.where(fleet.running, np.abs(values), 0.0)
                kept[fleet.robots] = np.maximum(kept[fleet.robots], here)

    def _evaluated(self, interval: int, t: float) -> FloatArray:
        u = self.inputs(interval, t, *self.state())
        if u.shape not in ((self.nu,), (self.robots, self.nu)):
            raise InputError(
                f"u(t, q, v) at t = {t:g} s has shape {u.shape}, not ({self.robots}, {self.nu}) or ({self.nu},)"
            )
        return u

    def _hold(self, fleet: Fleet) -> None:
        fleet.hold(self._u if self._u.ndim == 1 else self._u[fleet.robots])

    def _to(self, begin: float, end: float, show: Callable[[float], None]) -> None:
        """All fleets to the end of an interval, with changes of chart on the way."""
        if self.settings.switch:
            self._returned()
        for number in range(_ROUNDS):
            if self.settings.switch:
                self._rehoused(last=number == _ROUNDS - 1)
            done, everyone = 0, max(1, self.robots)
            for fleet in self.fleets:
                part = _Part(show, begin, end, done / everyone, len(fleet) / everyone)
                fleet.to(begin, end, part if number == 0 else _unseen)
                done += len(fleet)
            if not any(len(self._leaving(fleet)) for fleet in self.fleets):
                return

    # -- charts ---------------------------------------------------------------------------------------------

    def _leaving(self, fleet: Fleet) -> IndexArray:
        """Places of robots that look for another chart."""
        if fleet.watch is None:
            return np.zeros(0, dtype=np.intp)
        return np.flatnonzero(np.isin(fleet.lanes.each("status"), [CODES[name] for name in _LEAVES]))

    def _lost(self, fleet: Fleet, places: IndexArray) -> NDArray[np.bool_]:
        """Where the mechanism itself is singular: A is about to lose rank."""
        return np.asarray(fleet.regularity(places) < _NEAR * self._regular)

    def _rehoused(self, *, last: bool) -> None:
        """Move robots whose chart has become poor to where it is good, or leave them where they are for good."""
        for fleet in list(self.fleets):
            leaving = self._leaving(fleet)
            lost = self._lost(fleet, leaving)
            fleet.lanes.each("status")[leaving[lost]] = CODES["configuration"]
            if lost.all():
                continue
            some = fleet.take(leaving[~lost])
            stuck = self._stuck(some) | last
            if stuck.any():
                self._move(some.some(stuck), self._final(fleet.model.plain))
                some = some.some(~stuck)
            tried = [fleet]
            while len(some):
                target = self._next(tried)
                if target is None:
                    target = self._another(fleet, some.some(np.array([0])))
                if target is None:
                    break
                tried.append(target)
                good = self._good(target, some)
                if good.any():
                    self._move(some.some(good), target)
                    self.switches += int(good.sum())
                some = some.some(~good)
            if len(some):
                self._move(some, self._final(fleet.model.plain))

    def _returned(self) -> None:
        """Move robots that had to stay in a poor chart to where it is good now."""
        for fleet in [fleet for fleet in self.fleets if fleet.watch is None and len(fleet)]:
            for target in [other for other in self.fleets if other.watch is not None]:
                some = fleet.travellers(np.flatnonzero(fleet.running))
                good = self._good(target, some)
                if good.any():
                    self._move(fleet.take(np.flatnonzero(fleet.running)[good]), target)
                    self.switches += int(good.sum())

    def _stuck(self, some: Travellers) -> NDArray[np.bool_]:
        """Which robots have left several charts without getting on."""
        t = some.lanes["time"]
        self._idle[some.robots] = np.where(t > self._left[some.robots], 0, self._idle[some.robots] + 1)
        self._left[some.robots] = t
        return np.asarray(self._idle[some.robots] > _IDLE)

    def _move(self, some: Travellers, target: Fleet) -> None:
        """Robots that crept up to a border begin with longer steps again."""
        some.lanes["step"][:] = np.maximum(some.lanes["step"], self._step)
        target.add(some)
        self._hold(target)

    def _next(self, tried: Sequence[Fleet]) -> Fleet | None:
        """A fleet that has not been tried."""
        return next((fleet for fleet in self.fleets if fleet.watch is not None and fleet not in tried), None)

    def _good(self, target: Fleet, some: Travellers) -> NDArray[np.bool_]:
        """Which robots may enter a fleet."""
        v = some.v(target.model)
        call = target.called_for(some.lanes["time"], some.robots)
        spread, doubt, loss = call("forward_dynamics", ("spread", "doubt", "loss"), some.q, v, np.zeros(self.nu))
        regular = (doubt < _BETTER * target.doubt) & (np.abs(loss) < REGULAR_LOSS)
        return np.asarray(regular & (spread < _BETTER * (target.watch or 0.0)) & np.isfinite(v).all(axis=1))

    def _another(self, fleet: Fleet, one: Travellers) -> Fleet | None:
        """A new fleet in a chart that is good for a robot; nothing where there is none, or there are many already."""
        if len(self.fleets) >= _CHARTS or not np.isfinite(one.q_dot).all():
            return None
        p = self.p if self.p.ndim == 1 else self.p[one.robots]
        t = float(one.lanes["time"][0])
        values = dict(zip(fleet.model.parameters, p.reshape(-1).tolist(), strict=True))
        own = fleet.model if self.p.ndim == 1 else fleet.model.replace(**values)
        try:
            better = regular_chart(own, one.q[0], t)
        except SingularityError:
            return None
        chart = self.model.in_chart(better.independent, better.labels)
        known = [_chart(other.model) for other in self.fleets if other.watch is not None]
        if _chart(chart) in known:  # where the basis of its kernels is singular, its plain ones may be regular
            chart = chart.plain
        if _chart(chart) in known:
            return None
        call = BatchCall(chart, {"t": t, "parameters": p}, 1, np.dtype(np.float64))
        measures = call("forward_dynamics", ("spread", "doubt"), one.q, one.v(chart), np.zeros(self.nu))
        self.fleets.append(self._watched(chart, *(float(measure[0]) for measure in measures)))
        return self.fleets[-1]

    def _final(self, model: Model) -> Fleet:
        """The fleet of robots that stay in a chart whatever comes."""
        for fleet in self.fleets:
            if fleet.watch is None and fleet.model is model:
                return fleet
        self.fleets.append(Fleet(model, self.settings, self.p, None, _LOST))
        return self.fleets[-1]

    # -- ends -----------------------------------------------------------------------------------------------

    def outcomes(self) -> NDArray[np.object_]:
        """How every robot ended."""
        result = np.full(self.robots, Outcome.COMPLETED, dtype=object)
        for fleet in self.fleets:
            status = fleet.lanes.each("status")
            for name, outcome in _OUTCOMES.items():
                result[fleet.robots[status == CODES[name]]] = outcome
            if self.settings.switch:
                stuck = np.flatnonzero(np.isin(status, [CODES[name] for name in (*_LEAVES, "too_small")]))
                result[fleet.robots[stuck[self._lost(fleet, stuck)]]] = Outcome.CONFIGURATION_SINGULARITY
            lost = (status == CODES["loss"]) & (result[fleet.robots] == Outcome.COMPLETED)
            if lost.any():
                y = fleet.y()
                q, v = np.ascontiguousarray(y[:, : self.nq]), np.ascontiguousarray(y[:, self.nq : -1])
                call = fleet.called(fleet.lanes.each("time"))
                spread = call("forward_dynamics", ("spread",), q, v, np.zeros(self.nu))[0]
                massless = spread < LARGE_SPREAD
                result[fleet.robots[lost & massless]] = Outcome.SINGULAR_MASS_MATRIX
                result[fleet.robots[lost & ~massless]] = Outcome.SINGULAR_INDEPENDENT_SET
        return result
