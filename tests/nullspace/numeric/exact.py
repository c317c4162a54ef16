"""The exact null space of a matrix of floats, and the exact angle between it and a computed one.

Every double is a rational number: elimination of Fractions gives N without error, mpmath the angle with 60 digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np

__all__ = ["exact_angle", "exact_basis", "exact_rank"]

mpmath.mp.dps = 60


def exact_basis(A: Any, independent: Sequence[int]) -> list[list[Fraction]]:
    """N = [-B^-1 C; I], n x d, of a real matrix, by Gauss-Jordan elimination of Fractions."""
    n = len(A[0])
    dependent = [j for j in range(n) if j not in independent]
    pivots = _echelon(A, dependent)
    assert len(pivots) == len(dependent), "B is singular"
    N = [[Fraction(0)] * len(independent) for _ in range(n)]
    for k, j in enumerate(independent):
        N[j][k] = Fraction(1)
        for row, p in pivots:
            N[p][k] = -row[j]
    return N


def exact_rank(A: Any) -> int:
    return len(_echelon(A, range(len(A[0]))))


def exact_angle(N: Any, exact: Sequence[Sequence[Fraction]]) -> float:
    """The largest principal angle between the space of computed columns and the exact one, without rounding."""
    Q, Z = _orthonormal(exact), _orthonormal(np.asarray(N, float).tolist())
    rest = Z - Q * (Q.T * Z)
    largest = mpmath.sqrt(max(mpmath.eigsy(rest.T * rest, eigvals_only=True)))
    return float(mpmath.asin(min(largest, 1)))


def _echelon(A: Any, columns: Sequence[int]) -> list[tuple[list[Fraction], int]]:
    """(row, pivot column) of the reduced echelon form, pivots among some columns."""
    work = [[Fraction(entry) for entry in np.asarray(row).tolist()] for row in A]
    pivots: list[tuple[list[Fraction], int]] = []
    for j in columns:
        i = next((i for i, row in enumerate(work) if row[j]), None)
        if i is None:
            continue
        chosen = work.pop(i)
        row = [entry / chosen[j] for entry in chosen]
        work = [[a - other[j] * b for a, b in zip(other, row, strict=True)] for other in work]
        pivots = [([a - other[j] * b for a, b in zip(other, row, strict=True)], p) for other, p in pivots]
        pivots.append((row, j))
    return pivots


def _orthonormal(columns: Any) -> Any:
    """The columns of a matrix made orthonormal, with 60 digits."""
    exact = [[mpmath.mpf(Fraction(e).numerator) / Fraction(e).denominator for e in row] for row in columns]
    Q, _ = mpmath.qr(mpmath.matrix(exact), mode="skinny")
    return Q
