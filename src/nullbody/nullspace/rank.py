"""Rank of a matrix of exact scalars or expressions: which rows are independent, which columns can be dependent.

The echelon form is made of the entries' witnesses: rationals themselves, or the values of expressions at a
random point of a prime field. The rank is then the generic one, near-certainly (`nullbody.expr.field`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from heapq import heappop, heappush
from typing import Any

from nullbody.errors import InputError
from nullbody.expr import Exact, Expr, Graph
from nullbody.expr.matrix import Matrix
from nullbody.nullspace.given import checked_columns, scalar_rows
from nullbody.nullspace.scalar import exact_rational
from nullbody.nullspace.steps import Sparse, sparse_rows

__all__ = ["Echelon", "echelon", "sparse_echelon"]


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


def echelon(matrix: Matrix, columns: Sequence[int] | None = None) -> Echelon:
    """Echelon form by witnesses, pivots taken in the given order of columns.

    Args:
        matrix: rows of one length, of int, Fraction and expressions of one graph.
        columns: the columns in which pivots are looked for, in order; all by default.

    Raises:
        InputError: ragged rows, scalars without an exact witness (floats, SymPy expressions), or wrong columns.
    """
    rows = scalar_rows(matrix, "an echelon form needs rows of exact numbers or expressions of a graph")
    n = len(rows[0]) if rows else 0
    if any(len(row) != n for row in rows):
        raise InputError("an echelon form needs rows of equal length")
    graphs = {id(entry.graph) for row in rows for entry in row if isinstance(entry, Expr)}
    if len(graphs) > 1:
        raise InputError("an echelon form needs expressions of one graph: write all entries in one")
    return sparse_echelon(sparse_rows(rows), range(n) if columns is None else checked_columns(columns, n, "pivot"))


def sparse_echelon(rows: Sequence[Sparse], columns: Sequence[int]) -> Echelon:
    """The same of rows without their zeros."""
    graph = next((entry.graph for row in rows for entry in row.values() if isinstance(entry, Expr)), None)
    form = _Form(None if graph is None else graph.prime, {j: k for k, j in enumerate(columns)})
    for i, row in enumerate(rows):
        witnesses = {j: _witness(entry, graph) for j, entry in row.items()}
        form.add(i, {j: witness for j, witness in witnesses.items() if witness})
    return Echelon(tuple(form.rows), tuple(form.pivots), tuple(form.redundant))


class _Form:
    """The echelon form of sparse rows, which come one by one.

    A kept row has a 1 at its pivot and nothing at the pivots of the rows kept before it.
    """

    def __init__(self, prime: int | None, position: dict[int, int]) -> None:
        self.prime = prime
        self.position = position
        self.kept: list[dict[int, Any]] = []
        self.row_of: dict[int, int] = {}  # pivot column -> place in `kept`
        self.rows: list[int] = []
        self.pivots: list[int] = []
        self.redundant: list[int] = []

    def add(self, i: int, row: dict[int, Any]) -> None:
        """Reduce row i by the rows that are kept; keep what is left of it, if anything is.

        Subtracting kept row k may fill in pivots of rows kept later, never earlier: kept rows are taken in the order in
        which they were kept. A pivot that was filled, cancelled and filled again is queued twice; the second time its
        entry is gone.
        """
        waiting = sorted(self.row_of[j] for j in row if j in self.row_of)
        while waiting:
            known = self.kept[k := heappop(waiting)]
            factor = row.get(self.pivots[k])
            if factor is None:
                continue
            for j, entry in known.items():
                value = _reduced(row.get(j, 0) - factor * entry, self.prime)
                if value:
                    if j not in row and j in self.row_of:
                        heappush(waiting, self.row_of[j])
                    row[j] = value
                else:
                    row.pop(j, None)
        pivot = min((j for j in row if j in self.position), key=self.position.__getitem__, default=None)
        if pivot is None:
            self.redundant.append(i)
            return
        inverse = _inverse(row[pivot], self.prime)
        self.row_of[pivot] = len(self.kept)
        self.kept.append({j: _reduced(entry * inverse, self.prime) for j, entry in row.items()})
        self.rows.append(i)
        self.pivots.append(pivot)


def _witness(entry: Any, graph: Graph | None) -> Any:
    if isinstance(entry, Expr):
        return entry.graph.value(entry.ref)
    if not exact_rational(entry):
        raise InputError(f"an echelon form needs exact numbers or expressions of a graph, not {entry!r}")
    return Fraction(entry) if graph is None else graph.residue(Exact.of(entry))


def _reduced(number: Any, prime: int | None) -> Any:
    return number if prime is None else number % prime


def _inverse(number: Any, prime: int | None) -> Any:
    return 1 / Fraction(number) if prime is None else pow(int(number), -1, prime)
