"""N four-bars in a row (IFToMM A02), N = 1 to 40: how seconds to derive, operations and evaluation grow.

All loops are coupled and there is one degree of freedom, so that the work grows as N does at best. Exponents are those
of N^p that fit best from N = 5 on.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from statistics import median

import numpy as np

from nullbody import catalog
from nullbody.bench.speed.dynamics import deviation
from nullbody.bench.speed.effort import Effort
from nullbody.bench.speed.interleave import CLOCK, calls_of, interleaved
from nullbody.bench.speed.mujoco_peer import MujocoSoft
from nullbody.bench.speed.peer import Missing, Stopped
from nullbody.bench.speed.pinocchio_peer import pinocchio_direct
from nullbody.bench.speed.result import Growth
from nullbody.bench.timing import Work, block_work, native_work
from nullbody.equations import Equations, derive
from nullbody.kinematics import assemble
from nullbody.model import Model, State, build

__all__ = ["scaling_growths"]

_ANGLE, _RATE, _TORQUE = 0.4, 1.3, 0.7  # [rad, rad/s, N m] of bar 0
_DERIVATIONS = 3
_NATIVE, _BLOCKS = "nullbody, native", "nullbody, blocks of 8"
_MUJOCO = "MuJoCo mj_forward, soft closures, native"
_PINOCCHIO = "Pinocchio constraintDynamics, from Python"


@dataclass
class _Found:
    """Values by (tool, quantity) and N, and deviations by tool."""

    values: dict[tuple[str, str], dict[int, float]] = field(default_factory=dict)
    deviations: dict[str, float] = field(default_factory=dict)

    def add(self, tool: str, quantity: str, n: int, value: float) -> None:
        self.values.setdefault((tool, quantity), {})[n] = value

    def judge(self, tool: str, apart: float) -> None:
        self.deviations[tool] = max(apart, self.deviations.get(tool, 0.0))


def scaling_growths(
    effort: Effort, step: Callable[[str], None] = lambda name: None
) -> tuple[list[Growth], dict[str, str]]:
    """All quantities by N, and peers that are not there.

    Args:
        effort: how long the chains get, and how long each timing is.
        step: is told each length as it begins.
    """
    found, missing = _Found(), dict[str, str]()
    step("deriving chains")
    equations = _derived(found, effort)
    works: dict[tuple[str, int], Work] = {}
    for n, derived in equations.items():
        step(f"building {n} four-bars")
        with _no_cache():
            begin = CLOCK()
            model = build(derived)
            found.add("nullbody", "build", n, CLOCK() - begin)
        made = {**_own(model, found), **_peers(model, found, missing)}
        works |= {(tool, n): work for tool, work in made.items()}
    step("chains")
    turns = interleaved({f"{tool} {n}": work for (tool, n), work in works.items()}, effort.repeats, effort.seconds)
    for tool, n in works:
        found.add(tool, "batch" if tool == _BLOCKS else "forward dynamics", n, turns.timing(f"{tool} {n}").median)
    growths = [
        Growth(tool, quantity, "ours" if "nullbody" in tool else "peer", values, found.deviations.get(tool))
        for (tool, quantity), values in found.values.items()
    ]
    return growths, missing


def _derived(found: _Found, effort: Effort) -> dict[int, Equations]:
    """Equations by N; the median of some derivations, in turns from short to long."""
    seconds: dict[int, list[float]] = {n: [] for n in effort.chains}
    made = {}
    for _ in range(_DERIVATIONS):
        for n, own in seconds.items():
            if sum(own) < effort.patience:
                begin = CLOCK()
                made[n] = derive(catalog.n_four_bar(n))
                own.append(CLOCK() - begin)
    for n, own in seconds.items():
        found.add("nullbody", "derive", n, median(own))
        found.add("nullbody", "operations", n, made[n].routine_operations("forward_dynamics").arithmetic)
    return made


@contextmanager
def _no_cache() -> Iterator[None]:
    before = os.environ.get("NULLBODY_CACHE")
    os.environ["NULLBODY_CACHE"] = "off"
    try:
        yield
    finally:
        if before is None:
            del os.environ["NULLBODY_CACHE"]
        else:
            os.environ["NULLBODY_CACHE"] = before


def _own(model: Model, found: _Found) -> Mapping[str, Work]:
    kernel, state = model.library.kernels["forward_dynamics"], _state(model)
    row = np.hstack([state.q, state.v, _TORQUE, model.values])[None]
    for tool in (_NATIVE, _BLOCKS):
        found.deviations[tool] = 0.0
    return {_NATIVE: native_work(kernel, row), _BLOCKS: block_work(kernel, row)}


def _state(model: Model) -> State:
    return assemble(model, {"theta0": _ANGLE}, v={"theta0": _RATE})


def _peers(model: Model, found: _Found, missing: dict[str, str]) -> Mapping[str, Work]:
    works: dict[str, Work] = {}
    own, u = _state(model), np.array([_TORQUE])
    state, expected = (own.q, model.velocity(own), u), model.forward_dynamics(own, u)
    try:
        mujoco = MujocoSoft(model.mechanism, model.given)
        mujoco.timestep(1e-3, "RK4", stiff=True)
        data = mujoco.data(*state)
        found.judge(_MUJOCO, deviation(mujoco.accelerations(data), expected))
        works[_MUJOCO] = Work(mujoco.native_forward(data))
    except Missing as error:
        missing["MuJoCo"] = str(error)
    try:
        pinocchio = pinocchio_direct(model.mechanism, model.parameters, model.labels)
        call = pinocchio.prepared(*state)
        found.judge(_PINOCCHIO, deviation(pinocchio.accelerations(own.q, call()), expected))
        works[_PINOCCHIO] = calls_of([call])
    except (Missing, Stopped) as error:
        missing["Pinocchio"] = str(error)
    return works
