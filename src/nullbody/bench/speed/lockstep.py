"""Many robots in lock step by the classical Runge-Kutta method: seconds for one step of one robot.

A step is four evaluations of the forward dynamics, so at least 4 operations / peak. MuJoCo's step has as many; its
robots go one after the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from nullbody.bench.speed.dynamics import Entry, deviation, timed_lines
from nullbody.bench.speed.effort import Effort
from nullbody.bench.speed.limit import Limit
from nullbody.bench.speed.mujoco_peer import MujocoSoft
from nullbody.bench.speed.peer import Missing
from nullbody.bench.speed.result import Line
from nullbody.bench.speed.swing import swing_start
from nullbody.bench.timing import Work
from nullbody.kernels.threads import cores
from nullbody.model import Model
from nullbody.simulate import simulate
from nullbody.simulate.batch import simulate_batch
from nullbody.typing import FloatArray

__all__ = ["WORK", "lockstep_lines"]

WORK = "robots in lock step, one Runge-Kutta-4 step of one robot"

_STEP, _COUNT = 1e-3, 50  # [s], steps of one call
_RATE = 0.05  # [m/s], size of random rates at the start


def lockstep_lines(model: Model, limit: Limit, effort: Effort) -> list[Line]:
    """With and without projection onto the closures, on one core and on all, beside MuJoCo."""
    return timed_lines([*_own(model, limit, effort), *_mujoco(model)], effort)


def _own(model: Model, limit: Limit, effort: Effort) -> Iterator[Entry]:
    start = swing_start(model)
    v = _RATE * np.random.default_rng(0).normal(size=(effort.robots, len(model.independent)))
    v[0] = 0
    q = np.tile(start.q, (effort.robots, 1))
    count = 4 * model.library.kernels["forward_dynamics"].program.tape.operations.arithmetic
    true = simulate(model, start, _COUNT * _STEP, rtol=1e-12, samples=2, progress=False).q[-1]

    def run(threads: int, projection: bool) -> FloatArray:
        found: FloatArray = simulate_batch(
            model, (q, v), _COUNT * _STEP, step=_STEP, projection=projection, threads=threads, progress=False
        ).q[-1, 0]
        return found

    def entry(words: str, threads: int, projection: bool) -> Entry:
        def repeat(rounds: int) -> None:
            for _ in range(rounds):
                run(threads, projection)

        line = Line("simulate", WORK, f"nullbody, RK4, {words}", "ours", operations=count,
                    deviation=deviation(run(1, projection), true),
                    note=f"{effort.robots} robots, {_COUNT} steps of {_STEP:g} s, calls from Python")  # fmt: skip
        return Entry(line, Work(repeat, effort.robots * _COUNT, threads=threads > 1))

    least = limit.seconds(count)
    free = entry("without projection", 1, False)
    yield replace(free, line=replace(free.line, reference=True, limit=least))
    held = entry("with projection", 1, True)
    yield replace(held, line=replace(held.line, limit=least))
    if cores() > 1:
        yield entry(f"with projection, {cores()} cores", cores(), True)


def _mujoco(model: Model) -> Iterator[Entry]:
    line = Line("simulate", WORK, "MuJoCo RK4, soft closures", "peer", note="mj_step, no Python between")
    try:
        engine = MujocoSoft(model.mechanism, model.given)
    except Missing as error:
        yield Entry(replace(line, note=str(error)), None)
        return
    engine.timestep(_STEP, "RK4", stiff=True)
    start = swing_start(model)
    rates, none = np.zeros(len(model.coordinates)), np.zeros(len(model.inputs))
    true = simulate(model, start, _COUNT * _STEP, rtol=1e-12, samples=2, progress=False).q[-1]
    data = engine.data(start.q, rates, none)
    engine.advance(data, _COUNT)
    apart = deviation(engine.coordinates(data), true)

    def repeat(rounds: int) -> None:
        for _ in range(rounds):
            engine.advance(engine.data(start.q, rates, none), _COUNT)

    yield Entry(replace(line, deviation=apart), Work(repeat, _COUNT))
