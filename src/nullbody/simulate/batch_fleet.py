"""A fleet: robots of a batch that are written in one chart, with the native code that marches them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nullbody.kernels import BlockKernel, Lanes, March
from nullbody.model import Model
from nullbody.model.batch import BatchCall
from nullbody.model.batch_assembly import closed_rows
from nullbody.model.batch_march import GUARDS, march_of, measure_of
from nullbody.model.scale import stack_without_units
from nullbody.tolerances import CLOSED_STEP, EPS
from nullbody.typing import FloatArray, IndexArray

__all__ = ["CODES", "BatchSettings", "Fleet", "Travellers"]

#: Why a lane has stopped, by name: the guards and what else native code gives, and what is given here.
CODES = {
    **{name: k + 1 for k, name in enumerate(GUARDS)},
    "not_finite": len(GUARDS) + 1,
    "too_small": len(GUARDS) + 2,
    "watched": len(GUARDS) + 3,
    "input": 100,
    "open": 101,
    "many": 102,
    "configuration": 103,
}

_PATIENCE = (
    0.1  # seconds that one call of native code may take, about: then Ctrl-C and the progress bar have their turn
)
_STEPS = 500  # steps in one call
_MARGIN = 1e-3  # of |B| where a robot entered, below which it leaves or stops: rounding grows beyond
_POLISH = 3  # Newton steps at a result
_FLOAT = np.dtype(np.float64)


@dataclass(frozen=True)
class BatchSettings:
    """What `simulate_batch` was asked for.

    Attributes:
        step: length of fixed steps [s]; None for adaptive ones.
        rtol, atol: tolerances of the local error of adaptive steps.
        projection: whether loops are closed after every step.
        switch: whether independent coordinates may be changed.
        hold: longest time between two evaluations of the inputs [s].
        max_steps: most steps of a robot.
        threads: how many work at the same time.
    """

    step: float | None
    rtol: float
    atol: float
    projection: bool
    switch: bool
    hold: float
    max_steps: int
    threads: int


@dataclass(frozen=True, eq=False)
class Travellers:
    """Robots between two fleets: what they are in any chart.

    Attributes:
        robots: their numbers in the batch.
        q, q_dot: coordinates and all rates.
        work: done so far [J].
        lanes: by name time, step, accepted, refused.
    """

    robots: IndexArray
    q: FloatArray
    q_dot: FloatArray
    work: FloatArray
    lanes: Mapping[str, NDArray[Any]]

    def some(self, which: NDArray[Any]) -> Travellers:
        """Some of them, by place or truth value."""
        lanes = {name: values[which] for name, values in self.lanes.items()}
        return Travellers(self.robots[which], self.q[which], self.q_dot[which], self.work[which], lanes)

    def v(self, model: Model) -> FloatArray:
        """Their independent rates in a chart."""
        return np.ascontiguousarray(self.q_dot[:, model.independent_columns])

    def __len__(self) -> int:
        return len(self.robots)


class Fleet:
    """Robots in one chart.

    Args:
        model: the model in the chart.
        settings: how to step.
        watch: |N|^2, in the measure of the dynamics, at which a robot should leave; None: where it must.
        doubt: at which it must leave or stop.
        parameters: (np,) or (all robots, np).

    Attributes:
        robots: which ones are in it, by their number in the batch.
        lanes: where they stand.
    """

    def __init__(
        self, model: Model, settings: BatchSettings, parameters: FloatArray, watch: float | None, doubt: float
    ) -> None:
        self.model, self.settings, self.watch, self.doubt = model, settings, watch, doubt
        self._parameters = parameters
        self.march: March = march_of(model, projection=settings.projection, watch=watch, doubt=doubt)
        self.measure: BlockKernel = measure_of(model)
        self.nq, self.nv, self.nu = len(model.coordinates), len(model.independent), len(model.inputs)
        self.robots: IndexArray = np.zeros(0, dtype=np.intp)
        self.lanes: Lanes = self.march.lanes(0)
        self._blocks = 8 * settings.threads  # in one call of native code

    # -- who is in it ---------------------------------------------------------------------------------------

    def add(self, some: Travellers) -> None:
        """Take robots in."""
        old = self.lanes
        y = np.concatenate([some.q, some.v(self.model), some.work[:, None]], axis=1)
        delta = self.called_for(some.lanes["time"], some.robots)(
            "forward_dynamics", ("delta",), some.q, some.v(self.model), np.zeros(self.nu)
        )[0]
        with np.errstate(divide="ignore"):
            side = np.copysign(1.0 / ((_MARGIN if self.settings.switch else 0.0) * np.abs(delta)), delta)
        side[~np.isfinite(delta)] = 0.0
        each = {**some.lanes, "side": side, "status": np.zeros(len(some), dtype=np.int64)}
        self._rebuilt(
            np.concatenate([self.robots, some.robots]),
            np.concatenate([self.y(), y]),
            {name: np.concatenate([old.each(name), values]) for name, values in each.items()},
        )

    def travellers(self, places: IndexArray) -> Travellers:
        """Some robots, by their places in the fleet, as any chart sees them."""
        y = self.y()[places]
        lanes = {name: self.lanes.each(name)[places].copy() for name in ("time", "step", "accepted", "refused")}
        rates = self._rates(places)
        return Travellers(self.robots[places], y[:, : self.nq], rates, y[:, -1], MappingProxyType(lanes))

    def take(self, places: IndexArray) -> Travellers:
        """The same, taken out."""
        some, y = self.travellers(places), self.y()
        kept = np.setdiff1d(np.arange(len(self.robots)), places)
        each = {name: self.lanes.each(name)[kept] for name in (*some.lanes, "side", "status")}
        self._rebuilt(self.robots[kept], y[kept], each)
        return some

    def _rebuilt(self, robots: IndexArray, y: FloatArray, each: Mapping[str, NDArray[Any]]) -> None:
        self.robots, self.lanes = robots, self.march.lanes(len(robots))
        self.lanes.put(0, y)
        self.lanes.put(self.march.inputs - self._parameters.shape[-1], self._p(robots))
        for name, values in each.items():
            self.lanes.put_each(name, values)

    def _p(self, robots: IndexArray) -> FloatArray:
        return self._parameters if self._parameters.ndim == 1 else self._parameters[robots]

    # -- what they are --------------------------------------------------------------------------------------

    def __len__(self) -> int:
        return len(self.robots)

    @property
    def running(self) -> NDArray[np.bool_]:
        """Which robots go on."""
        return np.asarray(self.lanes.each("status") == 0)

    def y(self) -> FloatArray:
        """(q, v, work) of all robots, v in this chart."""
        return self.lanes.rows(0, self.nq + self.nv + 1)

    def rates(self) -> FloatArray:
        """All rates q' of all robots."""
        return self._rates(np.arange(len(self)))

    def _rates(self, places: IndexArray) -> FloatArray:
        y, t = self.y()[places], self.lanes.each("time")[places]
        call = self.called_for(t, self.robots[places])
        return call("kinematics", ("q_dot",), y[:, : self.nq], y[:, self.nq : self.nq + self.nv])[0]

    def regularity(self, places: IndexArray) -> FloatArray:
        """The smallest singular value of A that counts against the largest, of some robots: 0 where A loses rank."""
        model, rank = self.model, len(self.model.labels)
        if not rank or not len(places):
            return np.ones(len(places))
        q = self.y()[places, : self.nq]
        call = self.called_for(self.lanes.each("time")[places], self.robots[places])
        slips = [i for i, label in enumerate(model.labels) if label not in model.closure_labels]
        closures = call("closure", ("A",), q)[0].reshape(len(q), len(model.closure_labels), self.nq)
        rows = call("rows", ("A",), q)[0].reshape(len(q), rank, self.nq)
        A = stack_without_units(model, np.concatenate([closures, rows[:, slips]], axis=1))
        sizes = np.linalg.svd(np.nan_to_num(A), compute_uv=False)
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(np.nan_to_num(sizes[:, rank - 1] / sizes[:, 0]))

    def called(self, t: object) -> BatchCall:
        """Routines of the chart for all robots of the fleet."""
        return self.called_for(t, self.robots)

    def called_for(self, t: object, robots: IndexArray) -> BatchCall:
        """Routines of the chart for some robots of the batch, in it or not."""
        options = {"t": t, "parameters": self._p(robots), "threads": self.settings.threads}
        return BatchCall(self.model, options, len(robots), _FLOAT)  # type: ignore[arg-type]

    def stop(self, which: NDArray[np.bool_], code: str) -> None:
        """Stop those that still run."""
        status = self.lanes.each("status").copy()
        status[(status == 0) & which] = CODES[code]
        self.lanes.put_each("status", status)

    # -- the way --------------------------------------------------------------------------------------------

    def hold(self, u: FloatArray) -> None:
        """Set the inputs, (nu,) or (robots of the fleet, nu); a robot whose inputs are not finite stops."""
        finite = np.isfinite(u).all(axis=-1)
        if not finite.all():
            self.stop(np.broadcast_to(~finite, (len(self),)), "input")
        self.lanes.put(self.nq + self.nv + 1, np.clip(np.nan_to_num(u), *self.model.limits))

    def to(self, begin: float, end: float, show: Callable[[float], None]) -> None:
        """March all blocks from begin to end, some at a time; a robot may be on its way already.

        Args:
            begin, end: the interval.
            show: takes the part of the blocks that is done.
        """
        blocks, first = len(self.lanes.inputs), 0
        while first < blocks:
            last = min(first + self._blocks, blocks)
            began = time.perf_counter()
            (self._adaptive if self.settings.step is None else self._fixed)(begin, end, (first, last))
            took = time.perf_counter() - began
            self._blocks = self._blocks * 2 if took < _PATIENCE / 2 else max(1, self._blocks // 2)
            first = last
            show(first / blocks)

    def _fixed(self, begin: float, end: float, part: tuple[int, int]) -> None:
        lanes, here = self.lanes, slice(*part)
        count = max(1, int(np.ceil((end - begin) / (self.settings.step or end - begin) - EPS**0.5)))
        h = (end - begin) / count
        while steps := self._allowed(end - 0.5 * h, part):
            self.march.fixed(lanes, end, h, steps, self.settings.threads, part)
        arrived = (lanes.status[here] == 0) | (np.abs(lanes.time[here] - end) < 0.5 * h)
        lanes.time[here][arrived] = end  # sums of steps differ from it by rounding

    def _adaptive(self, begin: float, end: float, part: tuple[int, int]) -> None:
        settings = self.settings
        least = 16 * EPS * max(abs(begin), abs(end), end - begin)
        tolerances = settings.rtol, settings.atol
        while attempts := self._allowed(end, part):
            self.march.adaptive(self.lanes, end, tolerances, attempts, least, settings.threads, part)

    def _allowed(self, end: float, part: tuple[int, int]) -> int:
        """How many steps of robots that are not at the end may come next; those that have made all they may stop."""
        lanes, here = self.lanes, slice(*part)
        going = (lanes.status[here] == 0) & (lanes.time[here] < end)
        left = self.settings.max_steps - lanes.accepted[here] - lanes.refused[here]
        lanes.status[here][going & (left <= 0)] = CODES["many"]
        return min(_STEPS, int(left[going & (left > 0)].min(initial=_STEPS))) if (going & (left > 0)).any() else 0

    # -- at a result ----------------------------------------------------------------------------------------

    def polish(self, t: float) -> None:
        """Close the loops to rounding by Newton, independent coordinates held; robots whose loops stay open stop."""
        y, call = self.y(), self.called(t)
        q = np.ascontiguousarray(y[:, : self.nq])
        residual = self._gaps(call, q)
        for _ in range(_POLISH):
            going: IndexArray = np.flatnonzero(self.running & ~(residual <= CLOSED_STEP))
            if not len(going):
                break
            q[going] += call("closing", ("correction",), q[going], lanes=going)[0]
            residual = self._gaps(call, q)
        closed = (residual <= CLOSED_STEP) | closed_rows(
            lambda routine, outputs, here, lanes: call(routine, outputs, here, lanes=lanes), q, residual, 10.0
        )
        self.stop(~closed, "open")
        self.lanes.put(0, np.where(self.running[:, None], q, y[:, : self.nq]))

    def _gaps(self, call: BatchCall, q: FloatArray) -> FloatArray:
        return np.asarray(np.abs(call("closure", ("Phi",), q)[0]).max(axis=1, initial=0.0))

    def measured(self) -> tuple[FloatArray, FloatArray]:
        """T + U - work and the largest |Phi| of all robots, where they are."""
        y, call = self.y(), self.called(self.lanes.each("time"))
        q, v = (np.ascontiguousarray(part) for part in (y[:, : self.nq], y[:, self.nq : -1]))
        groups = [q, v, *([call.t] if self.model.rheonomic else []), call.p]
        Phi, T, U = self.measure(*groups, threads=self.settings.threads)
        return np.asarray(T + U - y[:, -1]), np.asarray(np.abs(Phi).max(axis=1, initial=0.0))
