"""Null spaces of numbers: compiled code of this package, batches of NumPy, and the methods of the literature."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from nullbody.bench.baseline import BASELINES, Baseline
from nullbody.bench.exact import orthogonality, residual
from nullbody.bench.matrix import Matrix, three_prs_generic, three_prs_trigonometric
from nullbody.bench.own import eliminated, kernels
from nullbody.bench.result import Row
from nullbody.bench.settings import Settings
from nullbody.bench.timing import Timing, block_seconds, native_seconds, seconds_per_call
from nullbody.kernels import Kernel
from nullbody.nullspace import null_space
from nullbody.typing import FloatArray

__all__ = ["BATCHES", "Stacked", "baseline_row", "numeric_rows", "ordered"]

_NAME = "3-PRS, numbers"
_ROUNDING = 1e-13  # of the largest entry: what is less counts as zero
_FEW = 4  # matrices for sparse methods in Python
_BATCH = 4096  # states of a call of `Kernel.batch`

Stacked = Callable[[FloatArray], FloatArray]


def _solved(A: FloatArray) -> FloatArray:
    m, n = A.shape[1:]
    N = np.empty((len(A), n, n - m))
    N[:, :m] = -np.linalg.solve(A[:, :, :m], A[:, :, m:])
    N[:, m:] = np.eye(n - m)
    return N


def _factored(A: FloatArray) -> FloatArray:
    found: FloatArray = np.linalg.qr(A.transpose(0, 2, 1), mode="complete")[0][:, :, A.shape[1] :]
    return found


def _decomposed(A: FloatArray) -> FloatArray:
    found: FloatArray = np.linalg.svd(A)[2][:, A.shape[1] :].transpose(0, 2, 1)
    return found


#: NumPy over a stack of matrices in one call.
BATCHES: Mapping[str, Stacked] = {
    "numpy.linalg.solve, stacked": _solved,
    "numpy.linalg.qr, stacked": _factored,
    "numpy.linalg.svd, stacked": _decomposed,
}


def numeric_rows(settings: Settings) -> list[Row]:
    """Seconds for one null space of the 3-PRS by every method, over the same random states."""
    robot, generic = three_prs_trigonometric(), three_prs_generic()
    states = robot.sample(np.random.default_rng(0), settings.states)
    stack = robot.numbers(states)
    entries = generic.values(stack)
    compiled = _compiled(robot, generic, stack[0])
    from_matrix = block_seconds(compiled["from_matrix"], entries, settings.repeats)

    def row(method: str, kernel: str, inputs: FloatArray, time: Timing, note: str = "") -> Row:
        N = compiled[kernel].batch(inputs)[0]
        return Row("numeric", _NAME, method, "baseline" if "Gauss" in method else "ours", time=time,
                   ratio=time.median / from_matrix.median, reference=time is from_matrix,
                   operations=compiled[kernel].program.tape.operations.arithmetic,
                   residual=max(map(residual, stack, N)), note=note)  # fmt: skip

    def scalar(kernel: str, inputs: FloatArray) -> Timing:
        return native_seconds(compiled[kernel], inputs, settings.repeats)

    def wide(kernel: str, inputs: FloatArray) -> Timing:
        return block_seconds(compiled[kernel], inputs, settings.repeats)

    many = np.tile(entries, (-(-_BATCH // len(entries)), 1))[:_BATCH]
    batch = seconds_per_call(lambda: compiled["from_matrix"].batch(many), _BATCH, settings.repeats, settings.patience)
    kernel = compiled["from_matrix"]
    called = seconds_per_call(lambda: [kernel(e) for e in entries], len(entries), settings.repeats, settings.patience)
    flat, trig = stack.reshape(len(stack), -1), "sin, cos and A included"
    rows = [
        row("nullbody compiled, 8-wide: A to N", "from_matrix", entries, from_matrix, "ratios refer to this"),
        row("nullbody compiled: A to N", "from_matrix", entries, scalar("from_matrix", entries)),
        row("nullbody compiled, 8-wide: A to N, elimination", "fewest", entries, wide("fewest", entries)),
        row("nullbody compiled, 8-wide: state to N", "from_state", states, wide("from_state", states), trig),
        row("nullbody compiled: state to N", "from_state", states, scalar("from_state", states), trig),
        row("nullbody batch, called from Python", "from_matrix", entries, batch, f"{_BATCH} states, copies too"),
        row("nullbody, called from Python", "from_matrix", entries, called, "one state at a time"),
        row("Gauss-Jordan compiled, 8-wide", "gauss", flat, wide("gauss", flat), "no zeros left out, pivots fixed"),
        row("Gauss-Jordan compiled", "gauss", flat, scalar("gauss", flat), "no zeros left out, pivots fixed"),
    ]  # fmt: skip
    rows += [_array_row(words, form, method, stack, settings, from_matrix) for words, form, method in _ARRAYS]
    ready = ordered(robot, stack)
    rows += [_batch_row(name, method, ready, settings, from_matrix) for name, method in BATCHES.items()]
    rows += [
        baseline_row("numeric", _NAME, name, entry, _share(entry, ready), settings, from_matrix)
        for name, entry in BASELINES.items()
    ]
    return rows


_ARRAYS = (
    ("nullbody.null_space of a stack, complete pivoting", "reduced", "complete"),
    ("nullbody.null_space of a stack, Householder QR", "orthonormal", "qr"),
)


def _compiled(robot: Matrix, generic: Matrix, example: FloatArray) -> Mapping[str, Kernel]:
    """N from the state; from the entries of A; the same with the fewest operations; by Gauss-Jordan elimination."""
    other = (
        three_prs_generic()
    )  # a graph of its own: in a shared one, parts of the first N would be taken for the second
    return kernels(
        {
            "from_state": (robot, null_space(robot.rows, robot.independent).basis),
            "from_matrix": (generic, null_space(generic.rows, generic.independent).basis),
            "fewest": (other, null_space(other.rows, other.independent, method="elimination").basis),
            "gauss": eliminated(robot, example),
        }
    )


def ordered(matrix: Matrix, stack: FloatArray) -> FloatArray:
    """A stack with the independent columns last, as the baselines take it."""
    return np.ascontiguousarray(stack[:, :, matrix.order])


def _array_row(words: str, form: str, method: str, stack: FloatArray, settings: Settings, reference: Timing) -> Row:
    def run() -> FloatArray:
        found: FloatArray = null_space(stack, None, form, method).basis  # type: ignore[arg-type]
        return found

    N = run()
    time = seconds_per_call(run, len(stack), settings.repeats, settings.patience)
    return Row("numeric", _NAME, words, "ours", time=time, ratio=time.median / reference.median,
               residual=max(map(residual, stack, N)),
               orthogonality=max(map(orthogonality, N)) if form == "orthonormal" else None)  # fmt: skip


def _batch_row(name: str, method: Stacked, stack: FloatArray, settings: Settings, reference: Timing) -> Row:
    N = method(stack)
    time = seconds_per_call(lambda: method(stack), len(stack), settings.repeats, settings.patience)
    return Row("numeric", _NAME, name, "baseline", time=time, ratio=time.median / reference.median,
               residual=max(map(residual, stack, N)), note=f"{len(stack)} in one call",
               orthogonality=None if method is _solved else max(map(orthogonality, N)))  # fmt: skip


def baseline_row(
    part: str, matrix: str, name: str, entry: Baseline, stack: FloatArray, settings: Settings, reference: Timing | None
) -> Row:
    """One method of the literature over a stack, one matrix at a time as Python code does it."""
    found: list[FloatArray] = []

    def run() -> None:
        method = entry.begin()
        found[:] = [method(A) for A in stack]

    try:
        entry.begin()(np.eye(2, 3))  # loads what is loaded on first use
        time = seconds_per_call(run, len(stack), settings.repeats, settings.patience)
    except np.linalg.LinAlgError as error:
        return Row(part, matrix, name, "baseline", note=f"failed: {error}")
    return Row(
        part,
        matrix,
        name,
        "baseline",
        time=time,
        ratio=time.median / reference.median if reference else None,
        residual=max(map(residual, stack, found)),
        orthogonality=max(map(orthogonality, found)) if entry.kind == "orthonormal" else None,
        nonzeros=_nonzeros(found[0]) if entry.kind in ("sparse", "fixed") else None,
        note=entry.source,
    )


def _share(entry: Baseline, stack: FloatArray) -> FloatArray:
    """All matrices, or a few of them for methods that take milliseconds."""
    return stack[:_FEW] if entry.kind == "sparse" else stack


def _nonzeros(N: FloatArray) -> int:
    return int(np.count_nonzero(np.abs(N) > _ROUNDING * np.abs(N).max()))
