"""Determinant and adjugate of a small matrix by memoised minors: no division, every minor once.

With P[k][S] the minor of rows S in the first k columns and Q[k][S] that of rows S in columns k, k+1, ..., every
cofactor is a Laplace sum of products P Q over the two sides of the deleted column (Gentleman and Johnson 1976).
"""

from __future__ import annotations

from itertools import combinations
from typing import Any

from nullbody.errors import InputError
from nullbody.expr.matrix import Matrix, total
from nullbody.nullspace.scalar import is_zero

__all__ = ["LARGEST", "adjugate", "parity"]

#: The largest irreducible matrix that is expanded by minors; the number of minors doubles with each column.
LARGEST = 14

_Minors = list[dict[int, Any]]


def adjugate(matrix: Matrix) -> tuple[list[list[Any]], Any]:
    """(adj(B), |B|) with B adj(B) = |B| I, for an n x n matrix B of any scalar type; sparse columns first.

    Raises:
        InputError: the matrix is larger than `LARGEST`.
    """
    n = len(matrix)
    if n > LARGEST:
        raise InputError(f"an irreducible {n} x {n} matrix is too large to expand by minors (at most {LARGEST})")
    order = sorted(range(n), key=lambda j: sum(not is_zero(row[j]) for row in matrix))
    ordered = [[row[j] for j in order] for row in matrix]
    prefix, suffix = _prefix_minors(ordered), _suffix_minors(ordered)
    sign = parity(order)
    rows: list[list[Any]] = [[] for _ in range(n)]
    for k in range(n):
        rows[order[k]] = [_signed(sign, _cofactor(prefix[k], suffix[k + 1], n, r, k)) for r in range(n)]
    return rows, _signed(sign, prefix[n].get((1 << n) - 1, 0))


def parity(order: list[int]) -> int:
    """+1 for an even permutation, -1 for an odd one."""
    inversions = sum(a > b for a, b in combinations(order, 2))
    return -1 if inversions % 2 else 1


def _signed(sign: int, scalar: Any) -> Any:
    return scalar if sign > 0 else -scalar


def _prefix_minors(matrix: Matrix) -> _Minors:
    """P[k][S]: minors of the first k columns, expanded along their last one; zero minors are left out."""
    n = len(matrix)
    minors: _Minors = [{0: 1}]
    for k in range(n):
        minors.append(_expanded(minors[k], [row[k] for row in matrix], lambda below, k=k: k - below))
    return minors


def _suffix_minors(matrix: Matrix) -> _Minors:
    """Q[k][S]: minors of columns k, k+1, ..., expanded along their first one."""
    n = len(matrix)
    minors: _Minors = [{0: 1}]
    for k in reversed(range(n)):
        minors.append(_expanded(minors[-1], [row[k] for row in matrix], lambda below: below))
    return minors[::-1]


def _expanded(smaller: dict[int, Any], column: list[Any], exponent: Any) -> dict[int, Any]:
    """Minors with one more column: sum over the rows r of the set, (-1)^exponent(rows of S above r)."""
    terms: dict[int, list[Any]] = {}
    for rows, minor in smaller.items():
        for r, entry in enumerate(column):
            if rows >> r & 1 or is_zero(entry):
                continue
            product = entry * minor if rows else entry
            odd = exponent((rows & ((1 << r) - 1)).bit_count()) % 2
            terms.setdefault(rows | 1 << r, []).append(-product if odd else product)
    summed = {rows: total(parts) for rows, parts in sorted(terms.items())}
    return {rows: minor for rows, minor in summed.items() if not is_zero(minor)}


def _cofactor(before: dict[int, Any], after: dict[int, Any], n: int, row: int, column: int) -> Any:
    """(-1)^(row + column) times the minor without that row and column, as a Laplace sum over both sides."""
    rest = ((1 << n) - 1) ^ (1 << row)
    terms = []
    for rows, left in before.items():
        right = after.get(rest ^ rows) if rows & ~rest == 0 else None
        if right is None:
            continue
        places = [(rest & ((1 << r) - 1)).bit_count() for r in range(n) if rows >> r & 1]
        odd = (sum(places) - column * (column - 1) // 2 + row + column) % 2
        product = right if not rows else left if rows == rest else left * right
        terms.append(-product if odd else product)
    return total(terms)
