"""Chains of four-bars: how operations and seconds grow with their number."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from nullbody.bench.baseline import BASELINES
from nullbody.bench.exact import residual
from nullbody.bench.matrix import Matrix, absolute_chain, relative_chain
from nullbody.bench.numeric import baseline_row, ordered
from nullbody.bench.own import kernels
from nullbody.bench.peer import Heat
from nullbody.bench.result import Row
from nullbody.bench.settings import Settings
from nullbody.bench.symbolic import own_rows
from nullbody.bench.timing import block_seconds, native_seconds, seconds_per_call
from nullbody.nullspace import null_space
from nullbody.typing import FloatArray

__all__ = ["CHAINS", "chain_heats", "chain_rows"]

#: The two kinds by the names that processes know.
CHAINS = {"relative_chain": relative_chain, "absolute_chain": absolute_chain}

_NUMERIC = ("numpy.linalg.solve", "numpy.linalg.qr", "scipy.linalg.null_space", "Wehage-Haug", "turnback")
_STATES = 16
_LARGE = 100  # rows from which slow methods of numbers run on one state only


def chain_rows(settings: Settings) -> Iterator[list[Row]]:
    """The rows of each chain, one chain after the other."""
    for make in CHAINS.values():
        for count in settings.chains:
            symbolic = own_rows("chains", lambda make=make, n=count: make(n), ("N", "N, elimination", "N~"), settings)  # type: ignore[misc]
            yield symbolic + _numeric(make(count), settings)


def chain_heats(settings: Settings) -> list[Heat]:
    """The methods of other tools that get farthest, each on longer and longer chains until it is stopped."""
    return [
        Heat(method, tuple(f"{kind}:{count}" for count in settings.chains), settings.limit)
        for method in settings.growing
        for kind in CHAINS
    ]


def _numeric(matrix: Matrix, settings: Settings) -> list[Row]:
    """Compiled code against SciPy's sparse LU, dense NumPy, and the sparse basis by turnback."""
    name = f"{matrix.name}, numbers"
    values = matrix.sample(np.random.default_rng(0), _STATES)
    stack = matrix.numbers(values)
    kernel = kernels({"chain": (matrix, null_space(matrix.rows, matrix.independent).basis)})["chain"]
    N = kernel.batch(values)[0]
    wide, scalar = block_seconds(kernel, values, settings.repeats), native_seconds(kernel, values, settings.repeats)
    worst = max(map(residual, stack, N))
    count = kernel.program.tape.operations.arithmetic
    rows = [
        Row("chains", name, words, "ours", time=time, ratio=time.median / wide.median, reference=time is wide,
            operations=count, residual=worst, nonzeros=int(np.count_nonzero(N[0])))
        for words, time in (("nullbody compiled, 8-wide", wide), ("nullbody compiled", scalar))
    ]  # fmt: skip
    run, solved = _sparse_lu(matrix, stack)
    time = seconds_per_call(run, len(stack), settings.repeats, settings.patience)
    rows.append(
        Row("chains", name, "scipy.sparse.linalg.splu", "baseline", time=time, ratio=time.median / wide.median,
            residual=residual(stack[0], solved), note="SuperLU; A is sparse already")
    )  # fmt: skip
    few = stack[: 1 if matrix.shape[0] >= _LARGE else 4]
    for method in _NUMERIC:
        entry = BASELINES[method]
        given = few if entry.kind == "sparse" else ordered(matrix, few)
        rows.append(baseline_row("chains", name, method, entry, given, settings, wide))
    return rows


def _sparse_lu(matrix: Matrix, stack: FloatArray) -> tuple[Callable[[], None], FloatArray]:
    """-B^-1 C by SuperLU for all matrices of a stack, and N of the first."""
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    rows, size = matrix.shape
    dependent, independent = list(matrix.order[:rows]), list(matrix.independent)
    pairs = [(csc_matrix(A[:, dependent]), np.ascontiguousarray(A[:, independent])) for A in stack]

    def run() -> None:
        for B, C in pairs:
            splu(B).solve(C)

    N = np.zeros((size, size - rows))
    N[dependent] = -splu(pairs[0][0]).solve(pairs[0][1])
    N[independent] = np.eye(size - rows)
    return run, N
