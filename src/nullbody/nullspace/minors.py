"""Determinant and adjugate of a small matrix by memoised minors: no division, every minor once, none in vain.

The matrix is cut into lines (its columns, or its rows), counted from 0; places are positions along a line. P[k][S]
(`_prefix`) is the minor of the first k lines on the places S, Q[k][S] (`_suffix`) that of the lines k, k+1, ... . A
cofactor is a Laplace sum of products P Q over the two sides of the line that it leaves out (Gentleman and Johnson
1976); a minor is made when the first cofactor asks for it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from nullbody.errors import InputError
from nullbody.expr.matrix import Matrix, total
from nullbody.nullspace.given import scalar_rows
from nullbody.nullspace.scalar import is_zero

__all__ = ["LARGEST", "Minors", "adjugate", "parity"]

#: The largest irreducible matrix that is expanded by minors; the number of minors doubles with each column.
LARGEST = 14


class Minors:
    """The minors of a square matrix B, each made once, when it is asked for.

    Args:
        matrix: B, n x n, of any scalar type.
        order: the order of the lines; sparse lines first where none is given.
        by_rows: lines are rows; otherwise columns.

    Raises:
        InputError: the matrix is larger than `LARGEST`.
    """

    def __init__(self, matrix: Matrix, order: Sequence[int] | None = None, *, by_rows: bool = False) -> None:
        n = len(matrix)
        if n > LARGEST:
            raise InputError(
                f"an irreducible {n} x {n} matrix is too large to expand by minors (at most {LARGEST}); "
                'the methods "auto" and "elimination" take pivots there'
            )
        lines = [list(row) for row in matrix] if by_rows else [[row[j] for row in matrix] for j in range(n)]
        if order is None:
            order = sorted(range(n), key=lambda k: sum(not is_zero(entry) for entry in lines[k]))
        self._position = {line: k for k, line in enumerate(order)}
        self._sign = parity(list(order))
        self._by_rows = by_rows
        self._lines = [[(1 << p, p, entry) for p, entry in enumerate(lines[k]) if not is_zero(entry)] for k in order]
        self._all = (1 << n) - 1
        self._first: list[dict[int, Any]] = [{0: 1}, *({} for _ in range(n))]
        self._last: list[dict[int, Any]] = [*({} for _ in range(n)), {0: 1}]
        self._cofactors: dict[tuple[int, int], Any] = {}

    @property
    def determinant(self) -> Any:
        """|B|"""
        return _signed(self._sign, self._prefix(len(self._lines), self._all))

    def cofactor(self, row: int, column: int) -> Any:
        """(-1)^(row + column) times the minor without that row and column: entry (column, row) of adj(B)."""
        key = row, column
        if key not in self._cofactors:
            self._cofactors[key] = self._cofactor(row, column)
        return self._cofactors[key]

    def _cofactor(self, row: int, column: int) -> Any:
        line, place = (row, column) if self._by_rows else (column, row)
        k = self._position[line]
        rest = self._all & ~(1 << place)
        terms = []
        for chosen in self._sets(k, rest):
            left = self._prefix(k, chosen)
            if is_zero(left):
                continue
            right = self._suffix(k + 1, rest & ~chosen)
            if not is_zero(right):
                # the places are ordered chosen, `place`, others: the sign of that arrangement
                terms.append(_signed(_shuffle(chosen, place, rest & ~chosen), left * right))
        return _signed(self._sign, total(terms))

    def _sets(self, k: int, within: int) -> list[int]:
        """The places on which the first k lines can have a minor, the rest of `within` being left to the others."""
        found = {0}
        for line in self._lines[:k]:
            found = {chosen | bit for chosen in found for bit, _, _ in line if within & bit and not chosen & bit}
        return sorted(found)

    def _prefix(self, k: int, places: int) -> Any:
        """P[k][places], expanded along its last line."""
        known = self._first[k]
        if places not in known:
            known[places] = total(
                _signed(
                    -1 if (places & ~((bit << 1) - 1)).bit_count() & 1 else 1, self._times(entry, k - 1, places ^ bit)
                )
                for bit, _, entry in self._lines[k - 1]
                if places & bit
            )
        return known[places]

    def _times(self, entry: Any, k: int, places: int) -> Any:
        minor = self._prefix(k, places)
        return 0 if is_zero(minor) else entry * minor

    def _suffix(self, k: int, places: int) -> Any:
        """Q[k][places], expanded along its first line."""
        known = self._last[k]
        if places not in known:
            terms = []
            for bit, _, entry in self._lines[k]:
                if places & bit:
                    minor = self._suffix(k + 1, places ^ bit)
                    if not is_zero(minor):
                        terms.append(_signed(-1 if (places & (bit - 1)).bit_count() & 1 else 1, entry * minor))
            known[places] = total(terms)
        return known[places]


def adjugate(matrix: Matrix) -> tuple[list[list[Any]], Any]:
    """(adj(B), |B|) with B adj(B) = |B| I, for an n x n matrix B of any scalar type.

    Raises:
        InputError: the matrix is not square, or larger than `LARGEST`.
    """
    rows = scalar_rows(matrix, "an adjugate needs a square matrix: rows of scalars")
    n = len(rows)
    if any(len(row) != n for row in rows):
        raise InputError(f"an adjugate needs a square matrix, not {n} rows of {sorted({len(row) for row in rows})}")
    if any(hasattr(entry, "__len__") for row in rows for entry in row):
        raise InputError("an adjugate needs a matrix of scalars, not of lists or arrays")
    minors = Minors(rows)
    return [[minors.cofactor(row, column) for row in range(n)] for column in range(n)], minors.determinant


def parity(order: Sequence[int]) -> int:
    """+1 for an even permutation, -1 for an odd one; of any distinct numbers, by their cycles."""
    rank = {value: k for k, value in enumerate(sorted(order))}
    places = [rank[value] for value in order]
    seen = [False] * len(places)
    sign = 1
    for start in range(len(places)):
        k = places[start]
        while not seen[start] and k != start:  # a cycle of n places takes n - 1 exchanges
            seen[k] = True
            k = places[k]
            sign = -sign
    return sign


def _shuffle(first: int, middle: int, last: int) -> int:
    """Parity of the arrangement: the places of `first`, then `middle`, then those of `last`, each in order."""
    inversions = (first >> (middle + 1)).bit_count() + (last & ((1 << middle) - 1)).bit_count()
    while first:
        low = first & -first
        inversions += (last & (low - 1)).bit_count()
        first ^= low
    return -1 if inversions & 1 else 1


def _signed(sign: int, scalar: Any) -> Any:
    return scalar if sign > 0 else -scalar
