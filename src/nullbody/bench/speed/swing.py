"""Work and precision: a free swing of the 3-PRS below its slides, the error of q at its end over the time it takes.

The reference shares nothing symbolic with what is judged: DOP853 at its tightest tolerance on accelerations of
Pinocchio, or of multipliers in full coordinates. How far the roads end from each other at their tightest says how far
it can be trusted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from nullbody.bench.speed.effort import Effort
from nullbody.bench.speed.interleave import interleaved
from nullbody.bench.speed.mujoco_peer import MujocoSoft
from nullbody.bench.speed.peer import Missing, Stopped
from nullbody.bench.speed.pinocchio_peer import PinocchioDirect, pinocchio_direct
from nullbody.bench.speed.result import Curve, Kind, Point
from nullbody.bench.timing import Timing, Work
from nullbody.kinematics import assemble
from nullbody.model import Model, State
from nullbody.simulate import simulate
from nullbody.typing import FloatArray
from nullbody.verify import MultiplierEngine

__all__ = ["Swing", "swing", "swing_start"]

_BELOW = {"y": -0.5, "alpha1": -1.57, "alpha2": -1.57, "alpha3": -1.57}
_START = {"s1": 0.5, "s2": 0.6, "s3": 0.7}
_TIGHTEST = 2.3e-14  # relative tolerance: SciPy takes nothing below 100 roundings
_SECONDS = 0.01  # of one measurement; motions that take longer are run once a turn
_EXPORTED = 3  # time steps at which closures as exported are run: their error does not depend on it
_MUJOCO = (("RK4", True), ("implicitfast", True), ("RK4", False))


@dataclass(frozen=True)
class Swing:
    """The diagram.

    Attributes:
        curves: by tool.
        reference: how the true end is known, and to what.
        missing: peers that are not there.
    """

    curves: tuple[Curve, ...]
    reference: str
    missing: Mapping[str, str]


@dataclass(frozen=True)
class _Run:
    """A tool at one setting; `end` returns q at the end."""

    tool: str
    kind: Kind
    setting: str
    end: Callable[[], FloatArray]
    note: str = ""


def swing_start(model: Model) -> State:
    """Where the 3-PRS starts: at rest below its slides."""
    return assemble(model, _START, guess=_BELOW)


def swing(model: Model, effort: Effort) -> Swing:
    """Errors over time of all tools."""
    start = swing_start(model)
    missing: dict[str, str] = {}
    runs = list(_own(model, start, effort))
    try:
        pinocchio: PinocchioDirect | None = pinocchio_direct(model.mechanism, model.parameters, model.labels)
    except (Missing, Stopped) as error:
        missing["Pinocchio"], pinocchio = str(error), None
    if pinocchio is not None:
        runs += _pinocchio(pinocchio, model, start, effort)
    try:
        MujocoSoft(model.mechanism, model.given)
        runs += _mujoco(model, start, effort)
    except Missing as error:
        missing["MuJoCo"] = str(error)
    true, words = _reference(model, start, effort, pinocchio)
    ends: dict[str, FloatArray] = {}

    def work(key: str, run: _Run) -> Work:
        def repeat(rounds: int) -> None:
            for _ in range(rounds):
                ends[key] = run.end()

        return Work(repeat)

    works = {str(k): work(str(k), run) for k, run in enumerate(runs)}
    turns = interleaved(works, min(effort.repeats, 7), _SECONDS, patience=effort.patience / 2, least=1)
    errors = {key: _error(end, true) for key, end in ends.items()}
    tools = dict.fromkeys(run.tool for run in runs)
    curves = tuple(_curve(tool, runs, {k: turns.timing(k) for k in works}, errors) for tool in tools)
    return Swing(curves, words, missing)


def _error(end: FloatArray, true: FloatArray) -> float:
    return float(np.abs(end - true).max()) if np.isfinite(end).all() else float("inf")


def _curve(tool: str, runs: list[_Run], times: Mapping[str, Timing], errors: Mapping[str, float]) -> Curve:
    own = [(str(k), run) for k, run in enumerate(runs) if run.tool == tool]
    points = tuple(Point(run.setting, times[key], errors[key]) for key, run in own)
    return Curve(tool, own[0][1].kind, points, own[0][1].note)


def _own(model: Model, start: State, effort: Effort) -> Iterator[_Run]:
    for rtol in effort.tolerances:

        def end(rtol: float = rtol) -> FloatArray:
            found: FloatArray = simulate(model, start, effort.duration, rtol=rtol, samples=2, progress=False).q[-1]
            return found

        yield _Run("nullbody.simulate", "ours", f"rtol {rtol:.0e}", end, "loops kept closed")


def _pinocchio(engine: PinocchioDirect, model: Model, start: State, effort: Effort) -> Iterator[_Run]:
    rates = model.velocity(start)
    for rtol in effort.tolerances:

        def end(rtol: float = rtol) -> FloatArray:
            return engine.motion(start.q, rates, effort.duration, rtol)

        yield _Run("Pinocchio + SciPy DOP853", "peer", f"rtol {rtol:.0e}", end, "closures drift")


def _mujoco(model: Model, start: State, effort: Effort) -> Iterator[_Run]:
    rates = model.velocity(start)
    for integrator, stiff in _MUJOCO:
        words = "closures as stiff as the step allows" if stiff else "closures as exported"
        for step in effort.timesteps if stiff else effort.timesteps[:_EXPORTED]:
            engine = MujocoSoft(model.mechanism, model.given)
            engine.timestep(step, integrator, stiff)

            def end(engine: MujocoSoft = engine, step: float = step) -> FloatArray:
                data = engine.data(start.q, rates, np.zeros(len(model.inputs)))
                engine.advance(data, round(effort.duration / step))
                return engine.coordinates(data)

            yield _Run(f"MuJoCo {integrator}, {words}", "peer", f"step {step:.0e} s", end, "mj_step, no Python between")


def _reference(model: Model, start: State, effort: Effort, pinocchio: PinocchioDirect | None) -> tuple[FloatArray, str]:
    """q at the end, and how it is known."""
    rates = model.velocity(start)
    roads: dict[str, FloatArray] = {}
    if pinocchio is not None:
        roads["Pinocchio"] = pinocchio.motion(start.q, rates, effort.duration, _TIGHTEST)
    if pinocchio is None or effort.thorough:
        roads["multipliers in full coordinates"] = _multipliers(model, start.q, rates, effort.duration)
    names = list(roads)
    words = f"DOP853 at rtol {_TIGHTEST:g} on accelerations of {names[-1]}"
    others = dict(roads)
    true = others.pop(names[-1])
    others["nullbody at rtol 1e-13"] = simulate(model, start, effort.duration, rtol=1e-13, samples=2).q[-1]
    apart = "; ".join(f"{name} ends {_error(end, true):.1g} from it" for name, end in others.items())
    return true, f"{words}; {apart}"


def _multipliers(model: Model, q: FloatArray, q_dot: FloatArray, t1: float) -> FloatArray:
    from scipy.integrate import solve_ivp

    engine, n, none = MultiplierEngine(model.mechanism, model.parameters, model.labels), len(q), np.zeros(3)

    def rates(t: float, y: FloatArray) -> FloatArray:
        return np.concatenate([y[n:], engine.forward_dynamics(y[:n], y[n:], none, t)[0]])

    start = np.concatenate([q, q_dot])
    found = solve_ivp(rates, (0.0, t1), start, "DOP853", rtol=_TIGHTEST, atol=0.01 * _TIGHTEST, t_eval=[t1])
    end: FloatArray = found.y[:n, -1]
    return end
