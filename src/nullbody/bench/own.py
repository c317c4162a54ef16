"""This package's null space of the benchmark's matrices: timed, counted, compiled."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from nullbody.bench.exact import orthogonality, residual
from nullbody.bench.matrix import Matrix
from nullbody.bench.timing import Timing
from nullbody.expr import Expr, Graph, Operations, Tape
from nullbody.kernels import Kernel, Program, compile_programs
from nullbody.nullspace import null_space
from nullbody.typing import FloatArray

__all__ = ["WAYS", "Derived", "Way", "derived", "eliminated", "kernels"]


@dataclass(frozen=True)
class Way:
    """How `null_space` is asked.

    Attributes:
        words: for tables.
        form, method: of `null_space`.
        searched: whether it looks for fewer operations.
    """

    words: str
    form: Any = "reduced"
    method: str = "auto"
    searched: bool = False


#: The forms and methods that the benchmark shows.
WAYS: Mapping[str, Way] = {
    "N": Way("N"),
    "N, elimination": Way("N, fewest operations (elimination)", method="elimination"),
    "N, searched": Way("N, the same, searched", method="elimination", searched=True),
    "N~": Way("N~ = |B| N, no divisions", "scaled"),
    "N~, searched": Way("N~, searched", "scaled", searched=True),
    "orthogonal": Way("orthogonal", "orthogonal", "elimination"),
    "orthonormal": Way("orthonormal", "orthonormal", "elimination"),
}


@dataclass(frozen=True)
class Derived:
    """A null space of symbols.

    Attributes:
        time: to derive it, from a new graph each time, so that nothing is remembered.
        operations: for its entries.
        matrix: whose it is.
        basis: its entries.
        residual: max |A N| / (|A| |N|) at a sample, evaluated as it is written.
        orthogonality: largest |cosine| between two columns there.
    """

    time: Timing
    operations: Operations
    matrix: Matrix
    basis: Sequence[Sequence[Any]]
    residual: float
    orthogonality: float


def derived(make: Callable[[], Matrix], way: Way, repeats: int, patience: float, search: int = 0) -> Derived:
    """Derive the null space of a matrix, some times."""
    seconds: list[float] = []
    end = time.perf_counter() + patience
    while not seconds or (len(seconds) < repeats and time.perf_counter() < end):
        matrix = make()
        begin = time.perf_counter()
        found = null_space(matrix.rows, matrix.independent, way.form, way.method, search=search if way.searched else 0)
        basis = found.basis
        seconds.append(time.perf_counter() - begin)
    values = matrix.sample(np.random.default_rng(0), 1)
    N = np.array(_program("N", matrix, basis).tape.run(values[0].tolist())).reshape(matrix.shape[1], -1)
    return Derived(
        Timing.of(seconds), found.operations, matrix, basis, residual(matrix.numbers(values)[0], N), orthogonality(N)
    )


def kernels(programs: Mapping[str, tuple[Matrix, Sequence[Sequence[Any]]]]) -> Mapping[str, Kernel]:
    """Native functions from the symbols of a matrix to a basis, by name; also over blocks of 8 states."""
    made = [_program(name, matrix, basis) for name, (matrix, basis) in programs.items()]
    return compile_programs(made, wide=True).kernels


def _program(name: str, matrix: Matrix, basis: Sequence[Sequence[Any]]) -> Program:
    graph = matrix.rows[0][0].graph
    zero = next((entry.graph for row in basis for entry in row if isinstance(entry, Expr)), graph).constant(0)
    tape = Tape.of([zero + entry for row in basis for entry in row], matrix.inputs)
    return Program(name, (("A", len(matrix.inputs)),), (("N", (len(basis), len(basis[0]))),), tape)


def eliminated(matrix: Matrix, example: FloatArray) -> tuple[Matrix, list[list[Any]]]:
    """N by Gauss-Jordan elimination of all entries as straight-line code, and the matrix of symbols that it takes.

    The pivot rows are those of partial pivoting at an example, fixed: cheaper than the search of a safe program.
    """
    graph = Graph()
    order = list(matrix.order)
    A = [[graph.symbol(f"A_{i}_{j}") for j in range(matrix.shape[1])] for i in range(matrix.shape[0])]
    dense = Matrix(
        f"{matrix.name}, all entries",
        tuple(tuple(row) for row in A),
        matrix.independent,
        tuple(graph.symbols),
        lambda random, count: matrix.numbers(matrix.sample(random, count)).reshape(count, -1),
    )
    R, shadow = [[row[j] for j in order] for row in A], example[:, order].copy()
    rows, size = shadow.shape
    for k in range(rows):
        pivot = k + int(np.argmax(np.abs(shadow[k:, k])))
        R[k], R[pivot] = R[pivot], R[k]
        shadow[[k, pivot]] = shadow[[pivot, k]]
        inverse = 1 / R[k][k]
        R[k] = [entry * inverse for entry in R[k]]
        shadow[k] /= shadow[k, k]
        for i in range(rows):
            if i != k:
                factor = R[i][k]
                R[i] = [entry - factor * lead for entry, lead in zip(R[i], R[k], strict=True)]
                shadow[i] -= shadow[i, k] * shadow[k]
    solved: list[list[Any]] = [[-entry for entry in row[rows:]] for row in R]
    solved += [[graph.constant(int(i == j)) for j in range(size - rows)] for i in range(size - rows)]
    basis: list[list[Any]] = [[] for _ in range(size)]
    for place, row in zip(order, solved, strict=True):
        basis[place] = row
    return dense, basis
