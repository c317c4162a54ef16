"""A null space over a field: of Fractions, or of residues modulo a prime, where expressions have their values."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from nullbody.errors import InputError
from nullbody.expr.matrix import Matrix

__all__ = ["determinant", "null_basis"]


def null_basis(rows: Matrix, order: Sequence[int], prime: int | None = None) -> tuple[list[int], list[list[Any]]]:
    """(independent rows, N with the identity in the free columns), by Gauss-Jordan elimination.

    Args:
        rows: Fractions, or integers modulo a prime.
        order: all columns; the later ones stay free where they can. The basis has them in increasing order.
        prime: that prime.

    Raises:
        InputError: there is nothing but 0 in the null space.
    """
    pivots: dict[int, list[Any]] = {}
    kept = []
    for i, row in enumerate(rows):
        work = list(row)
        for j, known in pivots.items():
            work = _cleared(work, known, j, prime)
        pivot = next((j for j in order if work[j]), None)
        if pivot is not None:
            work = _unit(work, pivot, prime)
            pivots = {j: _cleared(known, work, pivot, prime) for j, known in pivots.items()} | {pivot: work}
            kept.append(i)
    free = sorted(set(order) - set(pivots))
    if not free:
        raise InputError(f"A has full column rank {len(order)}: there is nothing but 0 in its null space")
    return kept, [[-pivots[j][k] if j in pivots else int(j == k) for k in free] for j in range(len(order))]


def determinant(matrix: Matrix, prime: int | None = None) -> Any:
    """The determinant of Fractions, or of integers modulo a prime; exact."""
    work, result = [list(row) for row in matrix], 1
    while work:
        place = next((i for i, row in enumerate(work) if row[0]), None)
        if place is None:
            return 0
        pivot = work.pop(place)
        result = _reduced(-result * pivot[0] if place % 2 else result * pivot[0], prime)
        unit = _unit(pivot, 0, prime)
        work = [_cleared(row, unit, 0, prime)[1:] for row in work]
    return result


def _unit(row: Sequence[Any], column: int, prime: int | None) -> list[Any]:
    """The row with 1 in a column."""
    inverse = 1 / Fraction(row[column]) if prime is None else pow(row[column], -1, prime)
    return [_reduced(a * inverse, prime) for a in row]


def _cleared(row: list[Any], unit: Sequence[Any], column: int, prime: int | None) -> list[Any]:
    """The row with 0 in the column where another one has 1."""
    factor = row[column]
    return [_reduced(a - factor * b, prime) for a, b in zip(row, unit, strict=True)] if factor else row


def _reduced(number: Any, prime: int | None) -> Any:
    return number if prime is None else number % prime
