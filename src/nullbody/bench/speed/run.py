"""The whole speed benchmark, subject by subject."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import cache

from nullbody.bench.machine import facts
from nullbody.bench.speed.batch import batch_lines
from nullbody.bench.speed.build import build_lines
from nullbody.bench.speed.dynamics import dynamics_lines
from nullbody.bench.speed.effort import SUBJECTS, Effort
from nullbody.bench.speed.goal import goals
from nullbody.bench.speed.limit import machine_limit
from nullbody.bench.speed.lockstep import lockstep_lines
from nullbody.bench.speed.result import Curve, Growth, Line, Speed
from nullbody.bench.speed.robot import robot_model, sample
from nullbody.bench.speed.scaling import scaling_growths
from nullbody.bench.speed.swing import swing
from nullbody.bench.speed.sympy_peer import SympyDynamics, sympy_dynamics
from nullbody.errors import UnknownName
from nullbody.verify.engine import input_matrix

__all__ = ["bench_speed", "steps"]

_PACKAGES = ("numpy", "scipy", "llvmlite", "sympy", "mujoco", "pin")


def steps(effort: Effort, subjects: Sequence[str]) -> int:
    """How many steps `bench_speed` announces."""
    own = {"simulate": 2, "scaling": 2 + len(effort.chains)}
    return 1 + sum(own.get(subject, 1) for subject in subjects)


def bench_speed(
    effort: Effort | None = None,
    subjects: Sequence[str] = tuple(SUBJECTS),
    step: Callable[[str], None] = lambda name: None,
) -> Speed:
    """Measure speed beside other tools: same work, same run, in turns.

    Args:
        effort: how much is run; everything by default.
        subjects: keys of `SUBJECTS`.
        step: is told the name of each step as it begins.

    Raises:
        UnknownName: there is no such subject.
    """
    for subject in subjects:
        if subject not in SUBJECTS:
            raise UnknownName("subject of a benchmark", subject, SUBJECTS)
    chosen, begin = effort or Effort.full(), time.perf_counter()
    step("what the machine can do")
    limit = machine_limit()
    model = robot_model()
    sampled = sample(model, chosen.states)

    @cache
    def derived_by_sympy() -> SympyDynamics:
        S = input_matrix(model.mechanism)
        return sympy_dynamics(model.mechanism, model.parameters, S, chosen.derivation)

    lines: list[Line] = []
    curves: tuple[Curve, ...] = ()
    growths: list[Growth] = []
    missing: dict[str, str] = {}
    known: dict[str, str] = {}
    if "build" in subjects:
        step("derive and build")
        lines += build_lines(model, derived_by_sympy, chosen)
    if "dynamics" in subjects:
        step("forward and inverse dynamics")
        lines += dynamics_lines(model, sampled, derived_by_sympy, limit, chosen)
    if "batch" in subjects:
        step("batches")
        lines += batch_lines(model, sampled, limit, chosen)
    if "simulate" in subjects:
        step("a swing")
        found = swing(model, chosen)
        curves, known["reference of the swing"] = found.curves, found.reference
        missing |= found.missing
        step("robots in lock step")
        lines += lockstep_lines(model, limit, chosen)
    if "scaling" in subjects:
        growths, absent = scaling_growths(chosen, step)
        missing |= absent
    absent_lines = [line for line in lines if line.kind == "peer" and line.time is None]
    missing |= {line.tool.split()[0].rstrip(","): line.note for line in absent_lines}
    return Speed(
        chosen, tuple(subjects), tuple(lines), curves, tuple(growths), goals(lines, curves, growths),
        {"vector": limit.vector, "scalar": limit.scalar, "bandwidth": limit.bandwidth, "lanes": limit.lanes},
        {**facts(time.perf_counter() - begin, _PACKAGES), **known}, missing,
    )  # fmt: skip
