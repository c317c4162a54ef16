"""simulate: integrate a model in time with the loops kept closed."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from inspect import signature
from numbers import Integral, Real
from typing import Any

import numpy as np

from nullbody.errors import InputError, SimulationError, StateError, UnknownName
from nullbody.model import Model, State, checked_model, vector
from nullbody.simulate.integration import Integration, Run
from nullbody.simulate.progress import progress_bar
from nullbody.simulate.trajectory import Statistics, Trajectory
from nullbody.tolerances import GIVEN_CLOSED
from nullbody.typing import FloatArray

__all__ = ["simulate"]

_ROUNDING = 1e-9  # by which the last of some summed-up sample times may exceed the end
_TIGHTEST = 1e-13  # relative tolerance below which rounding decides


def simulate(
    model: Model,
    state: State,
    t1: float,
    *,
    u: Callable[[float, State], Any] | object = None,
    rtol: float = 1e-10,
    samples: int | Sequence[float] | FloatArray | None = None,
    throw: bool = True,
    progress: bool | None = None,
    **options: Any,
) -> Trajectory:
    """The motion from a state until t1: q' = N v, v' = Mr^-1 (Br u - hr), by DOP853 with adaptive steps.

    After each step whose closures exceed 2e-14 m the coordinates are projected back onto the manifold, so that
    every stored sample is closed to 1e-13 m; the rates satisfy A q' = 0 by construction.

    Args:
        model: the model.
        state: where it starts; from `assemble`, `model.state` or a trajectory.
        t1: end time [s].
        u: inputs: a function u(t, x) of time and state, constant values (sequence or by name), or None for
            none. [N, N m]
        rtol: relative tolerance of the local error.
        samples: number of evenly spaced samples to store, or their times; the integrator's steps by default.
        throw: raise where the end time is not reached; otherwise `outcome` says why.
        progress: show a progress bar; by default on a terminal when the run takes longer than two seconds.
        options: start time `t0` (0) [s], `atol` (0.01 rtol), `max_step` [s], `max_steps` (100 000).

    Raises:
        InputError: wrong times, tolerances or inputs.
        StateError: the start does not close the loops of this model.
        SimulationError: the end was not reached; `.trajectory` holds what was, with its Outcome.
    """
    began = time.perf_counter()
    checked_model(model)
    _number(t1=t1, rtol=rtol)
    settings = _options(options, rtol)
    t0 = settings.pop("t0")
    _check(model, state, t0, t1, rtol)
    wanted = _sample_times(samples, t0, t1)
    integration = Integration(model, _input_function(model, u), rtol=rtol, **settings)
    with progress_bar(f"simulating {model.mechanism.name}", t0, t1, progress) as advance:
        run = integration.run(state, t0, t1, advance)
    trajectory = _stored(model, integration, run, _stored_times(wanted, t0, run.knots), began)
    if throw and not trajectory.outcome.ok:
        raise SimulationError(
            f"the simulation of {model.mechanism.name!r} ended at t = {run.knots[-1]:.6g} s of {t1:g} s: "
            f"{trajectory.outcome.value}{run.note}",
            trajectory,
        )
    return trajectory


def _check(model: Model, state: object, t0: float, t1: float, rtol: float) -> None:
    if not isinstance(state, State) or not _same_names(model, state):
        raise InputError("simulate starts from a State of the same model: use model.state(q, v) or assemble(...)")
    residual = float(np.abs(model.residual(state.q)).max(initial=0.0))
    if not residual <= GIVEN_CLOSED:
        raise StateError(
            f"the start is off the constraint manifold by {residual:.3g} m: was it made by a model with other "
            "parameters? nullbody.assemble(model, {...}, guess=state) closes the loops for these"
        )
    if not (np.isfinite(t0) and np.isfinite(t1) and t1 > t0):
        raise InputError(f"the end time t1 = {t1} must be finite and after the start t0 = {t0}")
    if not _TIGHTEST <= rtol <= 0.1:
        raise InputError(f"rtol = {rtol} must be within {_TIGHTEST}..0.1")


def _same_names(model: Model, state: State) -> bool:
    return (state.coordinates, state.independent) == (model.coordinates, model.independent)


def _number(**values: Any) -> None:
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, Real):
            raise InputError(f"{name} must be a number, not {value!r}")


def _options(options: dict[str, Any], rtol: float) -> dict[str, Any]:
    known = {"t0": 0.0, "atol": 0.01 * rtol, "max_step": np.inf, "max_steps": 100_000}
    for name, value in options.items():
        if name not in known:
            raise UnknownName("option of simulate", name, known)
        _number(**{name: value})
        if name != "t0" and not value > 0:
            raise InputError(f"{name} must be positive, not {value}")
    return {**known, **options}


def _input_function(model: Model, u: Any) -> Callable[[float, State], FloatArray]:
    if not callable(u):
        constant = model.input_vector(u)
        return lambda t, x: constant

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


def _stored_times(wanted: int | FloatArray | None, t0: float, knots: FloatArray) -> FloatArray:
    """The wanted times up to where the simulation came."""
    if wanted is None:
        return knots
    if isinstance(wanted, int):
        return np.linspace(t0, knots[-1], wanted if knots[-1] > t0 else 1)
    return wanted[wanted <= knots[-1]]


def _stored(model: Model, integration: Integration, run: Run, times: FloatArray, began: float) -> Trajectory:
    """Everything at the sample times, and the balances."""
    nq, nv = len(model.coordinates), len(model.independent)
    at_knots = len(times) == len(run.knots) and bool((times == run.knots).all())
    y = run.states if at_knots else np.array([run.at(float(t)) for t in times]).reshape(len(times), nq + nv + 1)
    if not at_knots:
        y = integration.closed(y)
    q, v, work = y[:, :nq], y[:, nq : nq + nv], y[:, nq + nv]
    states = [model.trusted_state(q[k].copy(), v[k].copy()) for k in range(len(times))]
    energies = np.array([integration.energy(x) for x in states]).reshape(-1, 2)
    inputs = np.array([integration.inputs(float(t), x) for t, x in zip(times, states, strict=True)])
    inputs = inputs.reshape(len(times), len(model.inputs))
    residual = max((float(np.abs(model.residual(x.q)).max(initial=0.0)) for x in states), default=0.0)
    balance = energies.sum(axis=1) - work
    statistics = Statistics(
        steps=len(run.knots) - 1,
        evaluations=run.evaluations,
        projections=run.projections,
        residual=residual,
        energy_drift=float(np.abs(balance - run.energy).max(initial=0.0)),
        seconds=time.perf_counter() - began,
    )
    for array in (times, q, v, inputs, energies, work):
        array.flags.writeable = False
    return Trajectory(
        model=model,
        t=times,
        q=q,
        v=v,
        u=inputs,
        kinetic=energies[:, 0],
        potential=energies[:, 1],
        work=work,
        outcome=run.outcome,
        statistics=statistics,
        _knots=run.knots,
        _pieces=run.pieces,
    )
