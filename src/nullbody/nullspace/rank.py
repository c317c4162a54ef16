"""Rank of a matrix of exact scalars or expressions: which rows are independent, which columns can be dependent.

The echelon form is made of the entries' witnesses: rationals themselves, or the values of expressions at a
random point of a prime field. The rank is then the generic one, near-certainly (`nullbody.expr.field`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from nullbody.expr import Exact, Expr, Graph
from nullbody.expr.matrix import Matrix
from nullbody.nullspace.scalar import exact_rational

__all__ = ["Echelon", "echelon", "float_echelon"]

_ROUNDING = 1e-12  # relative to the largest entry: a pivot below is nothing but rounding


@dataclass(frozen=True)
class Echelon:
    """What the echelon form of a matrix shows.

    Attributes:
        rows: the first rows that are independent of the ones before them.
        columns: for each of them the pivot column.
        redundant: the other rows, combinations of the rows before them.
    """

    rows: tuple[int, ...]
    columns: tuple[int, ...]
    redundant: tuple[int, ...]

    @property
    def rank(self) -> int:
        """The rank."""
        return len(self.rows)


def float_echelon(matrix: Matrix) -> Echelon:
    """Echelon form of floats by complete pivoting: the pivots that are largest, and the rank to rounding."""
    work = [list(map(float, row)) for row in matrix]
    largest = max(abs(entry) for row in work for entry in row)
    rows, columns = list(range(len(work))), list(range(len(work[0])))
    found: list[tuple[int, int]] = []
    while rows and columns:
        i, j = max(((i, j) for i in rows for j in columns), key=lambda place: abs(work[place[0]][place[1]]))
        if abs(work[i][j]) <= _ROUNDING * largest:
            break
        for k in rows:
            if k != i:
                factor = work[k][j] / work[i][j]
                work[k] = [a - factor * b for a, b in zip(work[k], work[i], strict=True)]
        rows.remove(i)
        columns.remove(j)
        found.append((i, j))
    found.sort()
    return Echelon(tuple(i for i, _ in found), tuple(j for _, j in found), tuple(rows))


def echelon(matrix: Matrix, columns: Sequence[int] | None = None) -> Echelon | None:
    """Echelon form by witnesses, pivots taken in the given order of columns.

    Returns:
        None where the scalars have no exact witness (floats, SymPy expressions).
    """
    graph = next((entry.graph for row in matrix for entry in row if isinstance(entry, Expr)), None)
    prime = None if graph is None else graph.prime
    witnesses = [[_witness(entry, graph) for entry in row] for row in matrix]
    if any(entry is None for row in witnesses for entry in row):
        return None
    order = list(columns) if columns is not None else list(range(len(matrix[0]) if matrix else 0))
    kept: list[list[Any]] = []
    rows: list[int] = []
    pivots: list[int] = []
    redundant: list[int] = []
    for i, row in enumerate(witnesses):
        work = list(row)
        for pivot, known in zip(pivots, kept, strict=True):
            if work[pivot]:
                factor = work[pivot]
                work = [_reduced(a - factor * b, prime) for a, b in zip(work, known, strict=True)]
        pivot_column = next((j for j in order if work[j]), None)
        if pivot_column is None:
            redundant.append(i)
            continue
        inverse = _inverse(work[pivot_column], prime)
        kept.append([_reduced(a * inverse, prime) for a in work])
        rows.append(i)
        pivots.append(pivot_column)
    return Echelon(tuple(rows), tuple(pivots), tuple(redundant))


def _witness(entry: Any, graph: Graph | None) -> Any:
    if isinstance(entry, Expr):
        return entry.graph.value(entry.ref)
    if not exact_rational(entry):
        return None
    return Fraction(entry) if graph is None else graph.residue(Exact.of(entry))


def _reduced(number: Any, prime: int | None) -> Any:
    return number if prime is None else number % prime


def _inverse(number: Any, prime: int | None) -> Any:
    return 1 / Fraction(number) if prime is None else pow(int(number), -1, prime)
