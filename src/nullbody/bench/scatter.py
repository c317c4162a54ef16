"""Random matrices: dense, sparse and banded, by symbols and by numbers."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nullbody.bench.baseline import BASELINES
from nullbody.bench.exact import residual
from nullbody.bench.matrix import Matrix
from nullbody.bench.numeric import baseline_row, ordered
from nullbody.bench.own import kernels
from nullbody.bench.peer import Heat
from nullbody.bench.peer.process import named_matrix
from nullbody.bench.result import Row
from nullbody.bench.settings import Settings
from nullbody.bench.symbolic import own_rows
from nullbody.bench.timing import block_seconds
from nullbody.nullspace import null_space

__all__ = ["NAMES", "random_heats", "random_rows"]

#: The matrices by the names that processes know.
NAMES = ("random_dense:6:9", "random_sparse:20:28", "random_banded:30:45")

_SLOW = ("determinants", "Dai-Jones cofactors")  # of numbers: hundreds of determinants
_STATES = 16  # of compiled code
_FEW = 2  # of methods in Python


def random_rows(settings: Settings) -> Iterator[list[Row]]:
    """The rows of each matrix, one after the other."""
    for name in NAMES:
        ways = ("N", "N, elimination", "N~", "orthonormal")
        yield own_rows("random", lambda name=name: named_matrix(name), ways, settings) + _numeric(  # type: ignore[misc]
            named_matrix(name), settings
        )


def random_heats(settings: Settings) -> list[Heat]:
    """Tools that solve B X = C in fixed order, which is right for random entries."""
    return [Heat(method, NAMES, settings.limit) for method in settings.scattered]


def _numeric(matrix: Matrix, settings: Settings) -> list[Row]:
    name = f"{matrix.name}, numbers"
    values = matrix.sample(np.random.default_rng(0), _STATES)
    stack = matrix.numbers(values)
    kernel = kernels({"random": (matrix, null_space(matrix.rows, matrix.independent).basis)})["random"]
    N = kernel.batch(values)[0]
    time = block_seconds(kernel, values, settings.repeats)
    rows = [
        Row("random", name, "nullbody compiled, 8-wide", "ours", time=time, ratio=1.0, reference=True,
            operations=kernel.program.tape.operations.arithmetic, residual=max(map(residual, stack, N)),
            nonzeros=int(np.count_nonzero(N[0])))
    ]  # fmt: skip
    for method, entry in BASELINES.items():
        if method not in _SLOW:
            given = stack[:_FEW] if entry.kind == "sparse" else ordered(matrix, stack[:_FEW])
            rows.append(baseline_row("random", name, method, entry, given, settings, time))
    return rows
