"""One evaluation of forward and inverse dynamics of the 3-PRS, beside the peers, on the same states.

Forward: (q, v, u) -> all q''; peers are given q' instead of v, so that q' = N v costs them nothing. Inverse: the inputs
for accelerations; peers in full coordinates are given all q'' that fulfil the closures, and solve for inputs and
multipliers. Every result is compared with this package's before anything is timed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from nullbody.bench.speed.effort import Effort
from nullbody.bench.speed.interleave import calls_of, interleaved
from nullbody.bench.speed.limit import Limit
from nullbody.bench.speed.mujoco_peer import MujocoSoft
from nullbody.bench.speed.peer import Missing, Stopped
from nullbody.bench.speed.pinocchio_peer import pinocchio_direct
from nullbody.bench.speed.result import Line
from nullbody.bench.speed.robot import Sample
from nullbody.bench.speed.sympy_peer import SympyDynamics
from nullbody.bench.timing import Work, native_work
from nullbody.model import Model
from nullbody.typing import FloatArray
from nullbody.verify import MultiplierEngine

__all__ = ["Entry", "deviation", "dynamics_lines", "timed_lines"]

FORWARD, INVERSE = "forward dynamics, all q''", "inverse dynamics"
_SOFT, _TERMS = "MuJoCo mj_forward, soft closures", "MuJoCo mj_rne, Jacobian, dense solve"
_CONTACTS, _RNEA = "Pinocchio constraintDynamics, from Python", "Pinocchio rnea, Jacobians, dense solve"


@dataclass(frozen=True)
class Entry:
    """A line before it is timed.

    Attributes:
        line: all but its time and ratio.
        work: what is timed; nothing where the peer is missing.
    """

    line: Line
    work: Work | None


def deviation(found: FloatArray, expected: FloatArray) -> float:
    """Largest difference over all states, relative to the largest entry of each."""
    scale = np.abs(expected).max(axis=-1, keepdims=True)
    return float((np.abs(found - expected) / scale).max())


def timed_lines(entries: Sequence[Entry], effort: Effort) -> list[Line]:
    """The lines of some entries, timed in turns; every work has one reference, with a figure, that ratios refer to."""
    works = {str(k): entry.work for k, entry in enumerate(entries) if entry.work is not None}
    turns = interleaved(works, effort.repeats, effort.seconds, effort.patience)
    references = {entry.line.work: str(k) for k, entry in enumerate(entries) if entry.line.reference}
    return [
        replace(entry.line, time=turns.timing(name), ratio=turns.ratio(name, references[entry.line.work]))
        if (name := str(k)) in works
        else entry.line
        for k, entry in enumerate(entries)
    ]


def dynamics_lines(
    model: Model, sampled: Sample, sympy: Callable[[], SympyDynamics], limit: Limit, effort: Effort
) -> list[Line]:
    """Forward and inverse dynamics by all tools."""
    entries = [
        *_own(model, sampled, limit),
        *_mujoco(model, sampled),
        *_pinocchio(model, sampled),
        *_sympy(sampled, sympy),
        *_multipliers(model, sampled),
    ]
    return timed_lines([e for work in (FORWARD, INVERSE) for e in entries if e.line.work == work], effort)


def _own(model: Model, sampled: Sample, limit: Limit) -> Iterator[Entry]:
    v_dot = sampled.q_ddot[:, model.independent_columns]
    inputs = np.array([model.inverse_dynamics(x, a) for x, a in zip(sampled.states, v_dot, strict=True)])
    for name, work, third, checked, apart in (
        ("forward_dynamics", FORWARD, sampled.u, model.forward_dynamics, 0.0),
        ("inverse_dynamics", INVERSE, v_dot, model.inverse_dynamics, deviation(inputs, sampled.u)),
    ):
        kernel = model.library.kernels[name]
        operations = kernel.program.tape.operations
        count = operations.arithmetic
        p = np.tile(model.values, (len(sampled.q), 1))
        rows = np.hstack([sampled.q, sampled.v, third, p])
        note = f"and {operations.trig} sines and cosines"
        given = list(zip(sampled.q, sampled.v, third, strict=True))
        raw = [partial(model.evaluate, name, *row) for row in given]
        bound = [partial(model.bound(name), *row) for row in given]
        full = [partial(checked, x, c) for x, c in zip(sampled.states, third, strict=True)]
        same = Line("dynamics", work, "", "ours", deviation=apart, operations=count)
        native = replace(same, tool="nullbody, native", reference=True, limit=limit.seconds(count, wide=False))
        yield Entry(replace(native, note=note), native_work(kernel, rows))
        yield Entry(replace(same, tool="nullbody, bound kernel from Python", note="model.bound"), calls_of(bound))
        yield Entry(replace(same, tool="nullbody, kernel from Python", note="model.evaluate"), calls_of(raw))
        yield Entry(replace(same, tool="nullbody, checked call from Python", note=f"model.{name}"), calls_of(full))


def _mujoco(model: Model, sampled: Sample) -> Iterator[Entry]:
    """Forward: MuJoCo's own way, soft closures made stiff, its solver warm. Inverse: exact, from its terms."""
    forward, inverse = Line("dynamics", FORWARD, _SOFT, "peer"), Line("dynamics", INVERSE, _TERMS, "peer")
    try:
        engine, exported = (MujocoSoft(model.mechanism, model.given) for _ in range(2))
    except Missing as error:
        yield from (Entry(replace(line, note=str(error)), None) for line in (forward, inverse))
        return
    engine.timestep(1e-3, "RK4", stiff=True)
    rows = list(zip(sampled.q, sampled.q_dot, sampled.u, strict=True))
    soft = deviation(np.array([exported.accelerations(exported.data(*row)) for row in rows]), sampled.q_ddot)
    datas = [engine.data(*row) for row in rows]
    apart = deviation(np.array([engine.accelerations(data) for data in datas]), sampled.q_ddot)
    natives = [engine.native_forward(data) for data in datas]

    def native(rounds: int) -> None:
        for run in natives:
            run(rounds)

    forward = replace(forward, deviation=apart, note=f"impedance 0.9999, solver warm; as exported it is {soft:.1g} off")
    yield Entry(replace(forward, tool=f"{_SOFT}, native"), Work(native, len(natives)))
    yield Entry(replace(forward, tool=f"{_SOFT}, from Python"), calls_of([partial(engine.forward, d) for d in datas]))
    solves = [engine.inverse(engine.data(*row), a) for row, a in zip(rows, sampled.q_ddot, strict=True)]
    yield _inverse(inverse, sampled, solves)


def _pinocchio(model: Model, sampled: Sample) -> Iterator[Entry]:
    forward, inverse = Line("dynamics", FORWARD, _CONTACTS, "peer"), Line("dynamics", INVERSE, _RNEA, "peer")
    try:
        engine = pinocchio_direct(model.mechanism, model.parameters, model.labels)
    except (Missing, Stopped) as error:
        yield from (Entry(replace(line, note=str(error)), None) for line in (forward, inverse))
        return
    calls = [engine.prepared(*row) for row in zip(sampled.q, sampled.q_dot, sampled.u, strict=True)]
    found = np.array([engine.accelerations(q, call()) for q, call in zip(sampled.q, calls, strict=True)])
    overhead = interleaved({"call": calls_of([engine.overhead()])}, 5, 0.002).timing("call").median
    note = f"of which {1e9 * overhead:.0f} ns are any call's; vectors prepared"
    yield Entry(replace(forward, deviation=deviation(found, sampled.q_ddot), note=note), calls_of(calls))
    solves = [engine.inverse(*row) for row in zip(sampled.q, sampled.q_dot, sampled.q_ddot, strict=True)]
    yield _inverse(inverse, sampled, solves)


def _multipliers(model: Model, sampled: Sample) -> Iterator[Entry]:
    """Our own second road: nothing symbolic, nothing eliminated, nothing compiled."""
    engine = MultiplierEngine(model.mechanism, model.parameters, model.labels)
    words = "nullbody multipliers in full coordinates"
    forward, inverse = (Line("dynamics", w, words, "ours", note="nullbody.verify") for w in (FORWARD, INVERSE))
    calls = [partial(engine.forward_dynamics, *x) for x in zip(sampled.q, sampled.q_dot, sampled.u, strict=True)]
    apart = deviation(np.array([call()[0] for call in calls]), sampled.q_ddot)
    yield Entry(replace(forward, deviation=apart), calls_of(calls))
    calls = [partial(engine.inverse_dynamics, *x) for x in zip(sampled.q, sampled.q_dot, sampled.q_ddot, strict=True)]
    apart = deviation(np.array([call()[0] for call in calls]), sampled.u)
    yield Entry(replace(inverse, deviation=apart), calls_of(calls))


def _inverse(line: Line, sampled: Sample, calls: Sequence[Callable[[], FloatArray]]) -> Entry:
    """Inverse dynamics, its inputs compared with those that caused the accelerations."""
    return Entry(replace(line, deviation=deviation(np.array([call() for call in calls]), sampled.u)), calls_of(calls))


def _sympy(sampled: Sample, make: Callable[[], SympyDynamics]) -> Iterator[Entry]:
    line = Line("dynamics", FORWARD, "SymPy lambdify(cse=True), dense solve", "peer")
    try:
        made = make()
    except (Missing, Stopped) as error:
        yield Entry(replace(line, note=str(error)), None)
        return
    rows = zip(sampled.q, sampled.q_dot, sampled.u, strict=True)
    calls = [partial(made.forward_dynamics, *row) for row in rows]
    apart = deviation(np.array([call() for call in calls]), sampled.q_ddot)
    note = f"derived by SymPy from the joints' poses in {made.seconds:.2g} s; the solve is not counted"
    yield Entry(replace(line, deviation=apart, operations=made.operations, note=note), calls_of(calls))
