"""simulate: integrate a model in time with the loops kept closed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from inspect import signature
from numbers import Integral, Real
from typing import Any

import numpy as np

from nullbody.errors import InputError, SimulationError, StateError, UnknownName
from nullbody.model import Model, State, checked_model, vector
from nullbody.model.check import check_closed
from nullbody.simulate.event import Event
from nullbody.simulate.integration import Integration, Settings
from nullbody.simulate.moments import Moments, at_knots, at_times
from nullbody.simulate.piece import Run
from nullbody.simulate.progress import progress_bar
from nullbody.simulate.trajectory import Statistics, Trajectory
from nullbody.typing import FloatArray

__all__ = ["simulate"]

_ROUNDING = 1e-9  # by which the last of some summed-up sample times may exceed the end
_METHODS = ("explicit", "stiff")
_TIGHTEST = 1e-13  # relative tolerance below which rounding decides


def simulate(
    model: Model,
    state: State,
    t1: float,
    *,
    u: Callable[[float, State], Any] | object = None,
    rtol: float = 1e-10,
    samples: int | Sequence[float] | FloatArray | None = None,
    events: Sequence[Event] = (),
    throw: bool = True,
    **options: Any,
) -> Trajectory:
    """The motion from a state until t1: q' = N v + beta, v' = Mr^-1 (Br u - hr), with adaptive steps.

    After each step whose closures exceed 2e-14 m the coordinates are projected back onto the manifold, so that
    every stored sample is closed to 1e-13 m (over a configuration singularity, where samples are interpolated, to a few
    times that); the rates satisfy A q' + b = 0 by construction. Where the independent coordinates become poor (|N| > 10
    in radians and typical lengths) others are taken, so that singularities of one choice are passed; inputs and the
    trajectory keep those of the model. Inputs are held within their limits.

    Args:
        model: the model.
        state: where it starts; from `assemble`, `model.state` or a trajectory.
        t1: end time [s].
        u: inputs [N, N m]: a function u(t, x) of time and state, constant values (sequence or by name), or none.
        rtol: relative tolerance of the local error.
        samples: number of evenly spaced samples to store, or their times; the integrator's steps by default.
        events: what to look for: `Event`s, which can end the simulation or change the state.
        throw: raise where the end time is not reached; otherwise `outcome` says why.
        options: `method` "explicit" (Dormand-Prince 8(5,3), the default) or "stiff" (Radau IIA of order 5 with the
            exact Jacobian at constant inputs), start time `t0` (that of the state) [s], `atol` (0.01 rtol),
            `max_step` [s], `max_steps` (100 000), `switch` (True) independent coordinates where they become poor,
            `progress` bar (by default on a terminal when the run takes longer than two seconds).

    Raises:
        InputError: wrong times, tolerances or inputs.
        StateError: the start does not close the loops of this model, or an event makes a state that does not.
        AssemblyError: the loops can never close for these parameter values.
        SimulationError: the end was not reached; `.trajectory` holds what was, with its Outcome.
    """
    began = time.perf_counter()
    checked_model(model)
    _number(t1=t1, rtol=rtol)
    chosen = _options(options, rtol)
    progress = chosen.pop("progress")
    t0 = getattr(state, "t", 0.0) if chosen["t0"] is None else chosen["t0"]
    del chosen["t0"]
    _check(model, state, t0, t1, rtol)
    wanted = _sample_times(samples, t0, t1)
    integration = Integration(model, _input_function(model, u), Settings(rtol=rtol, events=_events(events), **chosen))
    with progress_bar(f"simulating {model.mechanism.name}", t0, t1, progress) as advance:
        run = integration.run(state, t0, t1, advance)
    trajectory = _stored(model, run, wanted, began)
    if throw and not trajectory.outcome.ok:
        raise SimulationError(
            f"the simulation of {model.mechanism.name!r} ended at t = {run.knots[-1][0]:.6g} s of {t1:g} s: "
            f"{trajectory.outcome.value}{run.note}",
            trajectory,
        )
    return trajectory


def _check(model: Model, state: object, t0: float, t1: float, rtol: float) -> None:
    if not isinstance(state, State) or state.coordinates != model.coordinates:
        raise InputError("simulate starts from a State of the same model: use model.state(q, v) or assemble(...)")
    if not (np.isfinite(state.q).all() and np.isfinite(state.v).all()):
        raise StateError("the start is not finite")
    check_closed(model, state.q, t0)
    if not (np.isfinite(t0) and np.isfinite(t1) and t1 > t0):
        raise InputError(f"the end time t1 = {t1} must be finite and after the start t0 = {t0}")
    if not _TIGHTEST <= rtol <= 0.1:
        raise InputError(f"rtol = {rtol} must be within {_TIGHTEST}..0.1")


def _events(events: Sequence[Event]) -> tuple[Event, ...]:
    if not isinstance(events, list | tuple):
        raise InputError(f"events must be a list of nullbody.Event, not {events!r:.80}")
    for event in events:
        if not isinstance(event, Event):
            raise InputError(f"events are nullbody.Event, not {event!r}")
    return tuple(events)


def _number(**values: Any) -> None:
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, Real):
            raise InputError(f"{name} must be a number, not {value!r}")


def _options(options: dict[str, Any], rtol: float) -> dict[str, Any]:
    known: dict[str, Any] = {"t0": None, "atol": 0.01 * rtol, "max_step": np.inf, "max_steps": 100_000}
    known |= {"method": "explicit", "switch": True, "progress": None}
    for name, value in options.items():
        if name not in known:
            raise UnknownName("option of simulate", name, known)
        if name == "method" and value not in _METHODS:
            raise UnknownName("method of simulate", value, _METHODS)
        if name in ("t0", "atol", "max_step", "max_steps"):
            _number(**{name: value})
            if name != "t0" and not value > 0:
                raise InputError(f"{name} must be positive, not {value}")
        if name == "switch" and not isinstance(value, bool):
            raise InputError(f"switch must be True or False, not {value!r}")
    return {**known, **options}


def _input_function(model: Model, u: Any) -> Callable[[float, State], FloatArray] | FloatArray:
    if not callable(u):
        return model.input_vector(u)

    try:
        signature(u).bind(0.0, None)
    except TypeError:
        raise InputError("u must be a function u(t, x) of time and state, or constant values") from None
    except ValueError:  # a built-in without a signature: the first call will tell
        pass

    def inputs(t: float, x: State) -> FloatArray:
        given = u(t, x)
        try:
            return vector(given, model.inputs, "input", finite=False)
        except InputError as error:
            raise InputError(f"u(t, x) at t = {t:g} s: {error}") from None

    return inputs


def _sample_times(samples: Any, t0: float, t1: float) -> int | FloatArray | None:
    """What to store, checked before the work is done."""
    if samples is None:
        return None
    if isinstance(samples, Integral) and not isinstance(samples, bool):
        if samples < 2:
            raise InputError(f"at least 2 samples are needed, not {samples}")
        return int(samples)
    try:
        times = np.array(samples, dtype=np.float64)
    except (TypeError, ValueError):
        times = np.array(np.nan)
    good = times.ndim == 1 and len(times) and np.isfinite(times).all() and (np.diff(times) > 0).all()
    if not good or times[0] < t0 or times[-1] > t1 + _ROUNDING * (t1 - t0):
        raise InputError(
            f"samples must be a number of them or increasing times within {t0:g}..{t1:g} s, not {samples!r}"
        )
    return np.minimum(times, t1)


def _moments(run: Run, wanted: int | FloatArray | None) -> Iterator[Moments]:
    """What to store: the knots, or the wanted times up to where the simulation came."""
    if wanted is None or not run.pieces:
        early = isinstance(wanted, np.ndarray) and wanted[0] > run.knots[0][0]
        return at_knots([] if early else run.knots)
    t0, end = run.knots[0][0], run.knots[-1][0]
    return at_times(run.pieces, np.linspace(t0, end, wanted) if isinstance(wanted, int) else wanted[wanted <= end])


def _stored(model: Model, run: Run, wanted: int | FloatArray | None, began: float) -> Trajectory:
    """Everything at the sample times, and the balances."""
    columns: dict[str, list[FloatArray]] = {name: [] for name in ("t", "q", "q_dot", "u", "energies", "work", "gaps")}
    for m in _moments(run, wanted):
        columns["t"].append(m.t)
        columns["q"].append(m.q)
        columns["q_dot"].append(m.q_dot)
        columns["u"].append(m.motion.inputs(m.t, m.y))
        columns["energies"].append(m.motion.native.energies(m.t, m.q, m.q_dot))
        columns["work"].append(m.y[:, -1])
        columns["gaps"].append(m.motion.native.gaps(m.t, m.y))
    width = {"q": len(model.coordinates), "q_dot": len(model.coordinates), "u": len(model.inputs), "energies": 2}
    stored = {
        name: np.concatenate([np.empty((0, width[name]) if name in width else 0), *parts])
        for name, parts in columns.items()
    }
    for array in stored.values():
        array.flags.writeable = False
    energies, work = stored["energies"], stored["work"]
    with np.errstate(over="ignore", invalid="ignore"):  # rates beyond what has an energy
        drift = np.abs(energies.sum(axis=1) - work - run.energy)
    statistics = Statistics(
        steps=len(run.pieces),
        evaluations=run.evaluations,
        projections=run.projections,
        switches=run.switches,
        crossings=run.crossings,
        residual=float(stored["gaps"].max(initial=0.0)),
        energy_drift=float(drift.max(initial=0.0)),
        seconds=time.perf_counter() - began,
    )
    return Trajectory(
        model=model,
        t=stored["t"],
        q=stored["q"],
        q_dot=stored["q_dot"],
        u=stored["u"],
        kinetic=energies[:, 0],
        potential=energies[:, 1],
        work=work,
        events=tuple(run.events),
        outcome=run.outcome,
        statistics=statistics,
        _pieces=tuple(run.pieces),
    )
