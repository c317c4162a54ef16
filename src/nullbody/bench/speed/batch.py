"""Many states at once: per state and core, on threads, in single precision, and where memory is the limit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nullbody.bench.speed.dynamics import Entry, deviation, timed_lines
from nullbody.bench.speed.effort import Effort
from nullbody.bench.speed.limit import Limit
from nullbody.bench.speed.result import Line
from nullbody.bench.speed.robot import Sample
from nullbody.bench.timing import Work, block_work, native_work
from nullbody.kernels.threads import cores
from nullbody.model import Model
from nullbody.typing import FloatArray

__all__ = ["batch_lines"]


@dataclass(frozen=True)
class _Job:
    """A kernel and the method of `model.batch` that calls it.

    Attributes:
        work: what it does, in words.
        kernel: its name.
        groups: states of a few, without parameters.
        call: the method on such groups, with options; its result, or the first one of several.
        expected: that result by the kernel on one state after the other.
    """

    work: str
    kernel: str
    groups: tuple[FloatArray, ...]
    call: Callable[..., FloatArray]
    expected: FloatArray


def batch_lines(model: Model, sampled: Sample, limit: Limit, effort: Effort) -> list[Line]:
    """Seconds for one state, of one kernel after the other."""
    return [
        line for job in _jobs(model, sampled) for line in timed_lines(list(_entries(model, job, limit, effort)), effort)
    ]


def _jobs(model: Model, sampled: Sample) -> Iterator[_Job]:
    batch, v_dot = model.batch, sampled.q_ddot[:, model.independent_columns]

    def result(kernel: str, output: str, *groups: FloatArray) -> FloatArray:
        names = [name for name, _ in model.library.kernels[kernel].program.outputs]
        place = names.index(output)
        return np.array([model.evaluate(kernel, *row)[place] for row in zip(*groups, strict=True)])

    given = sampled.q, sampled.v, sampled.u
    yield _Job(
        "forward dynamics, many states", "forward_dynamics", given, batch.forward_dynamics,
        result("forward_dynamics", "q_ddot", *given),
    )  # fmt: skip
    given = sampled.q, sampled.v, v_dot
    yield _Job(
        "inverse dynamics, many states", "inverse_dynamics", given, batch.inverse_dynamics,
        result("inverse_dynamics", "u", *given),
    )  # fmt: skip
    yield _Job(
        "null space N and gamma, many states", "kinematics", given[:2], lambda *x, **o: batch.null_space(*x, **o).N,
        result("kinematics", "N", *given[:2]),
    )  # fmt: skip


def _entries(model: Model, job: _Job, limit: Limit, effort: Effort) -> Iterator[Entry]:
    kernel = model.library.kernels[job.kernel]
    rows = np.hstack([*job.groups, np.tile(model.values, (len(job.expected), 1))])
    many = [np.resize(group, (effort.batch, group.shape[1])) for group in job.groups]
    count = kernel.program.tape.operations.arithmetic
    moved = 8 * (sum(group.shape[1] for group in job.groups) + job.expected[0].size)

    def apart(**options: Any) -> float:
        found = np.asarray(job.call(*job.groups, **options), dtype=float)
        return deviation(found.reshape(len(rows), -1), job.expected.reshape(len(rows), -1))

    line = Line("batch", job.work, "", "ours", operations=count, deviation=apart(), limit=limit.seconds(count))
    yield Entry(
        replace(line, tool="nullbody, blocks of 8", reference=True, note="native, in the cache"),
        block_work(kernel, rows),
    )
    scalar = replace(line, tool="nullbody, one at a time", limit=limit.seconds(count, wide=False), deviation=0.0)
    yield Entry(replace(scalar, note="native"), native_work(kernel, rows))
    stream = limit.seconds(count, moved)
    note = f"{effort.batch} states, {moved} bytes each at least"
    yield Entry(
        replace(line, tool="model.batch, one core", limit=stream, note=note),
        _called(job, many, effort.batch, threads=1),
    )
    if cores() > 1:
        yield Entry(
            replace(line, tool=f"model.batch, {cores()} cores", limit=None, note="the same, wall time"),
            _called(job, many, effort.batch),
        )
    single = replace(line, tool="model.batch, one core, float32", limit=None, deviation=apart(dtype=np.float32))
    halves = [group.astype(np.float32) for group in many]
    yield Entry(single, _called(job, halves, effort.batch, threads=1, dtype=np.float32))


def _called(job: _Job, groups: Sequence[NDArray[Any]], states: int, **options: Any) -> Work:
    def run(rounds: int) -> None:
        for _ in range(rounds):
            job.call(*groups, **options)

    return Work(run, states, threads=options.get("threads") != 1)
