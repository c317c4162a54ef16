"""simulate_batch: the motions of many robots in lock step."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from numbers import Integral, Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from nullbody.errors import AssemblyError, InputError, StateError, UnknownName
from nullbody.kernels.threads import thread_count
from nullbody.model import Model, State, checked_model
from nullbody.model.batch import BatchCall
from nullbody.model.batch_bodies import checked_parameters
from nullbody.model.batch_inputs import numbers, rows
from nullbody.simulate.batch_file import BatchFile, checked_path
from nullbody.simulate.batch_fleet import BatchSettings
from nullbody.simulate.batch_result import BatchStatistics, BatchTrajectory, checked_times
from nullbody.simulate.batch_run import BatchRun, Inputs
from nullbody.simulate.progress import progress_bar
from nullbody.tolerances import GIVEN_CLOSED
from nullbody.typing import FloatArray

__all__ = ["simulate_batch"]

_FLOAT = np.dtype(np.float64)
_SHARE = 0.8  # of the free memory that results may take
_TIGHTEST = 1e-13

_DEFAULTS: Mapping[str, Any] = {
    "atol": None,
    "t0": None,
    "projection": True,
    "switch": True,
    "parameters": None,
    "hold": np.inf,
    "max_steps": 100_000,
    "to": None,
    "threads": None,
    "progress": None,
}


def simulate_batch(
    model: Model,
    states: tuple[ArrayLike, ArrayLike] | Sequence[State],
    t: float | ArrayLike,
    u: ArrayLike | Callable[[float, FloatArray, FloatArray], ArrayLike] | None = None,
    *,
    step: float | None = None,
    rtol: float = 1e-8,
    **options: Any,
) -> BatchTrajectory:
    """The motions of many robots of one model: q' = N v + beta, v' = Mr^-1 (Br u - hr), 8 at a time on every core.

    A robot that comes where the independent coordinates are poor goes on in others, together with all that do; results
    and inputs keep those of the model. Which others depends on the robots that came there first: such a robot agrees
    with one simulated alone to the tolerance. One that ends before the last time is NaN from then on; `outcome` says
    why: configuration singularities end it, while `simulate` passes them where the motion is smooth.

    Args:
        model: the model.
        states: where they start: arrays (q, v) with shapes (robots, nq) and (robots, nv) or (nv,), or a list of States.
        t: the end time, or the times of the results, the first one the start [s].
        u: inputs [N, N m]: none; (nu,) for all, (robots, nu), or (intervals, robots or 1, nu), one for each interval
            between results; or a function u(t, q, v) of arrays that returns (robots, nu) or (nu,). A function is
            evaluated at the begin of every interval, and every `hold` seconds within; meanwhile inputs are constant
            (zero-order hold). They are held within their limits.
        step: length of fixed steps of the classical Runge-Kutta method (order 4), shortened a little so that a whole
            number fits between results [s]; adaptive ones by default (Dormand-Prince 5(4), every robot its own).
        rtol: relative tolerance of the local error of adaptive steps.
        options: `atol` (0.01 rtol), `projection` (True) of the loops after every step, `switch` (True) independent
            coordinates where they become poor, `parameters` of all robots (np,), of each (robots, np) or by name,
            `hold` [s], `t0` start of a single end time [s], `max_steps` of a robot (100 000), `to` a file .nc for
            the results instead of memory, `threads` (all cores), `progress` bar (by default on a terminal when the run
            takes longer than two seconds).

    Returns:
        The results, an outcome for every robot, and how well energy and loops were kept.

    Raises:
        InputError: wrong shapes, times, tolerances or inputs, or results that do not fit into memory.
        StateError: starts that do not close the loops: says how many and which is the first.
        AssemblyError: the loops of some can never close for their parameter values.
        OutputError: the file cannot be written.
    """
    began = time.perf_counter()
    checked_model(model)
    chosen = _options(options)
    q, v, start = _states(model, states)
    times = checked_times(t, start if chosen["t0"] is None else chosen["t0"])
    settings = _countable(_settings(chosen, step, rtol), times)
    parameters = checked_parameters(model, chosen["parameters"], len(q))
    inputs = _inputs(model, u, len(q), len(times) - 1)
    _closed(model, q, float(times[0]), parameters)
    results = _Results(model, times, len(q), chosen["to"])
    run = BatchRun(model, settings, inputs, parameters)
    try:
        _marched(run, results, (q, v), chosen["progress"])
        return results.trajectory(run, began)
    except BaseException:
        results.give_up()
        raise


def _marched(run: BatchRun, results: _Results, start: tuple[FloatArray, FloatArray], progress: bool | None) -> None:
    """All robots from result to result."""
    q, v = start
    times = results.times.tolist()
    run.start(q, v, times[0], times[1] - times[0])
    results.put(0, q, v, run)
    title = f"simulating {len(q)} x {run.model.mechanism.name}"
    with progress_bar(title, times[0], times[-1], progress) as show:
        for k in range(1, len(times)):
            run.advance(k - 1, times[k - 1], times[k], show)
            results.put(k, *run.state(), run)


class _Results:
    """What is kept of the robots: in memory, or in a file."""

    def __init__(self, model: Model, times: FloatArray, robots: int, to: object) -> None:
        self.model, self.times = model, times
        self.file: BatchFile | None = None
        self.q: FloatArray | None = None
        self.v: FloatArray | None = None
        nq, nv = len(model.coordinates), len(model.independent)
        if to is not None:
            self.file = BatchFile(checked_path(to), model, robots)
            return
        needed, free = 8.0 * len(times) * robots * (nq + nv), _free_memory()
        if needed > _SHARE * free:
            raise InputError(
                f"{len(times)} results of {robots} robots take {needed / 1e9:.3g} GB, {free / 1e9:.3g} GB of memory "
                "are free: write them to a file with to='motions.nc', or ask for fewer times"
            )
        self.q, self.v = np.empty((len(times), robots, nq)), np.empty((len(times), robots, nv))

    def put(self, index: int, q: FloatArray, v: FloatArray, run: BatchRun) -> None:
        """Keep the states at one time, NaN for robots that have ended."""
        gone = ~run.running
        if gone.any() and index:
            q, v = q.copy(), v.copy()
            q[gone], v[gone] = np.nan, np.nan
        if self.file is not None:
            self.file.write(index, float(self.times[index]), q, v)
        elif self.q is not None and self.v is not None:
            self.q[index], self.v[index] = q, v

    def give_up(self) -> None:
        """Leave a readable file, marked as not complete."""
        if self.file is not None and self.file.draft.exists():
            self.file.close()

    def trajectory(self, run: BatchRun, began: float) -> BatchTrajectory:
        """The results, read-only."""
        accepted, refused, ended = (run.each(name) for name in ("accepted", "refused", "time"))
        seconds = time.perf_counter() - began
        statistics = BatchStatistics(
            int(accepted.sum()), int(refused.sum()), run.switches, seconds, run.settings.threads
        )
        for array in (self.q, self.v, self.times, accepted, refused, ended, run.residual, run.energy_drift):
            if array is not None:
                array.flags.writeable = False
        trajectory = BatchTrajectory(
            model=self.model,
            t=self.times,
            outcome=run.outcomes(),
            ended=ended,
            accepted=accepted,
            refused=refused,
            residual=run.residual,
            energy_drift=run.energy_drift,
            parameters=run.p,
            statistics=statistics,
            path=None if self.file is None else self.file.path,
            _q=self.q,
            _v=self.v,
        )
        if self.file is not None:
            self.file.finish(trajectory)
        return trajectory


def _free_memory() -> float:
    """Bytes of memory that are free, or infinity where the system does not say."""
    names = getattr(os, "sysconf_names", {})
    if "SC_AVPHYS_PAGES" in names and "SC_PAGE_SIZE" in names:
        return float(os.sysconf("SC_AVPHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    return np.inf


def _options(options: dict[str, Any]) -> dict[str, Any]:
    for name in options:
        if name not in _DEFAULTS:
            raise UnknownName("option of simulate_batch", name, ("step", "rtol", *_DEFAULTS))
    chosen = {**_DEFAULTS, **options}
    for name in ("projection", "switch"):
        if not isinstance(chosen[name], bool):
            raise InputError(f"{name} must be True or False, not {chosen[name]!r}")
    limit = chosen["max_steps"]
    if isinstance(limit, bool) or not isinstance(limit, Integral) or limit < 1:
        raise InputError(f"max_steps must be a whole number from 1, not {limit!r}")
    if chosen["t0"] is not None:
        _number("t0", chosen["t0"])
    return chosen


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, Real) or np.isnan(float(value)):
        raise InputError(f"{name} must be a number, not {value!r}")
    return float(value)


def _settings(chosen: dict[str, Any], step: float | None, rtol: float) -> BatchSettings:
    rtol = _number("rtol", rtol)
    atol = 0.01 * rtol if chosen["atol"] is None else _number("atol", chosen["atol"])
    numbers = {"atol": atol, "hold": _number("hold", chosen["hold"])}
    if step is not None:
        numbers["step"] = _number("step", step)
    for name, value in numbers.items():
        if not value > 0:
            raise InputError(f"{name} must be positive, not {value}")
    if not _TIGHTEST <= rtol <= 0.1:
        raise InputError(f"rtol = {rtol} must be within {_TIGHTEST}..0.1")
    threads = thread_count(chosen["threads"])
    return BatchSettings(
        None if step is None else float(step),
        rtol,
        atol,
        chosen["projection"],
        chosen["switch"],
        numbers["hold"],
        int(chosen["max_steps"]),
        threads,
    )


def _countable(settings: BatchSettings, times: FloatArray) -> BatchSettings:
    """The settings, unless fixed steps are lost in the rounding of the time or inputs evaluated without end.

    Raises:
        InputError: step or hold is too small for the times.
    """
    length = np.diff(times)
    with np.errstate(over="ignore"):
        if settings.step is not None:
            count = np.maximum(np.ceil(length / settings.step), 1.0)
            lost = count * np.spacing(np.abs(times).max())  # the sum of the steps may be as far from the time
            if (lost > 0.25 * length / count).any():
                raise InputError(
                    f"step = {settings.step:g} s is too small for times up to {np.abs(times).max():g} s: the rounding "
                    "of the time adds up to a step within an interval. Take longer steps or more results"
                )
        most = float((length / settings.hold).max())
    if most > settings.max_steps:
        raise InputError(
            f"hold = {settings.hold:g} s needs {most:.3g} steps between two results, more than max_steps = "
            f"{settings.max_steps}. Hold the inputs longer"
        )
    return settings


def _states(model: Model, states: Any) -> tuple[FloatArray, FloatArray, float]:
    """q, v and the time of the first state."""
    if isinstance(states, tuple) and len(states) == 2 and not isinstance(states[0], State):
        q = rows(states[0], model.coordinates, "coordinate", _FLOAT)
        v = rows(states[1], model.independent, "independent rate", _FLOAT, one=True)
        if v.ndim == 2 and len(v) != len(q):
            raise InputError(f"there are coordinates for {len(q)} robots and rates for {len(v)}")
        return q, np.array(np.broadcast_to(v, (len(q), v.shape[-1]))), 0.0
    if not isinstance(states, list | tuple) or not all(isinstance(state, State) for state in states):
        raise InputError("states are arrays (q, v) with a row for each robot, or a list of States")
    own = [model.own(state) for state in states]
    starts = {state.t for state in own}
    if len(starts) > 1:
        raise InputError(f"the states have different times, {min(starts):g} to {max(starts):g} s: give arrays (q, v)")
    q = np.array([state.q for state in own]).reshape(len(own), len(model.coordinates))
    v = np.array([state.v for state in own]).reshape(len(own), len(model.independent))
    return q, v, starts.pop() if starts else 0.0


def _closed(model: Model, q: FloatArray, t: float, parameters: FloatArray) -> None:
    """Raise unless all start on the constraint manifold of their parameters.

    Raises:
        StateError, AssemblyError: how many do not, and the first.
    """
    call = BatchCall(model, {"t": t, "parameters": parameters}, len(q), _FLOAT)

    def first(wrong: Any) -> str:
        return f"{int(wrong.sum())} of {len(q)} robots, the first one is {int(np.flatnonzero(wrong)[0])}"

    gap = np.abs(call("closure", ("Phi",), q)[0]).max(axis=1, initial=0.0)
    if (wrong := ~(gap <= GIVEN_CLOSED)).any():
        raise StateError(
            f"loops are open by up to {np.nanmax(gap):.3g} m at the start of {first(wrong)}. model.batch.assemble(q) "
            "closes them; with parameters for each robot, pass it those"
        )
    dropped = np.abs(call("redundant", ("Phi",), q)[0]).max(axis=1, initial=0.0)
    if (wrong := ~(dropped <= GIVEN_CLOSED)).any():
        raise AssemblyError(
            f"the loops can never close for the parameters of {first(wrong)}. Check lengths and offsets"
        )
    if (wrong := ~(call("facing", ("cosines",), q)[0] > 0).all(axis=1)).any():
        raise StateError(f"a loop is closed the wrong way round, an axis of its joint reversed, in {first(wrong)}")


def _inputs(model: Model, u: Any, robots: int, intervals: int) -> Inputs:
    """u as a function of the interval."""
    nu = len(model.inputs)
    if callable(u):
        return lambda interval, t, q, v: numbers(u(t, q, v), f"at t = {t:g} s u(t, q, v):").astype(_FLOAT, copy=False)
    array = numbers(np.zeros(nu) if u is None else u, "input")
    if array.ndim == 3:
        if array.shape[0] != intervals or array.shape[1] not in (1, robots) or array.shape[2] != nu:
            raise InputError(
                f"u for each interval is an array ({intervals} intervals, {robots} robots or 1, {nu}), not one of "
                f"shape {array.shape}"
            )
        flat = rows(array.reshape(array.shape[0] * array.shape[1], nu), model.inputs, "input", _FLOAT)
        each = np.broadcast_to(flat.reshape(array.shape), (intervals, robots, nu))
        return lambda interval, t, q, v: each[interval]
    constant = rows(array, model.inputs, "input", _FLOAT, one=True)
    if constant.ndim == 2 and len(constant) != robots:
        raise InputError(f"there are {robots} robots, but inputs for {len(constant)}")
    return lambda interval, t, q, v: constant
