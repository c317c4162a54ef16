"""The null space in exact rational arithmetic, rounded once, and how far others are from it."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from nullbody.typing import FloatArray

__all__ = ["exact_null_space", "orthogonality", "residual", "subspace_error"]


def exact_null_space(A: FloatArray) -> FloatArray:
    """N of the doubles in A taken as exact numbers, by Gauss-Jordan with complete pivoting over the rationals.

    The largest pivots choose the columns, so that N's entries stay small; each is rounded once.

    Raises:
        ZeroDivisionError: A has not full row rank.
    """
    rows, size = A.shape
    R = [[Fraction(float(entry)) for entry in row] for row in A]
    pivots: dict[int, int] = {}  # row of each dependent column
    for _ in range(rows):
        places = ((i, j) for i in range(rows) for j in range(size) if i not in pivots.values() and j not in pivots)
        i, j = max(places, key=lambda place: abs(R[place[0]][place[1]]))
        head = R[i][j]
        R[i] = [entry / head for entry in R[i]]
        for k in range(rows):
            if k != i and (factor := R[k][j]):
                R[k] = [a - factor * b for a, b in zip(R[k], R[i], strict=True)]
        pivots[j] = i
    free = [j for j in range(size) if j not in pivots]
    N = np.zeros((size, len(free)))
    N[free, range(len(free))] = 1
    for j, i in pivots.items():
        N[j] = [-float(R[i][k]) for k in free]
    return N


def residual(A: FloatArray, N: FloatArray) -> float:
    """max |A N| / (max |A| max |N|); NaN where N is not finite, or nothing but zeros."""
    size = float(np.abs(A).max() * np.abs(N).max())
    return float(np.abs(A @ N).max() / size) if np.isfinite(size) and size > 0 else float("nan")


def orthogonality(N: FloatArray) -> float:
    """The largest |cosine| between two columns; 0 for one column, NaN where N is not finite or a column vanishes."""
    length = np.linalg.norm(N, axis=0)
    if not np.all(np.isfinite(N)) or not np.all(length > 0):
        return float("nan")
    Z = N / length
    return float(np.abs(Z.T @ Z - np.eye(N.shape[1])).max()) if N.shape[1] > 1 else 0.0


def subspace_error(N: FloatArray, exact: FloatArray) -> float:
    """Sine of the largest angle between the spans of N and of the exact basis; 1 where N has lost its rank.

    Columns are brought to length 1 first, as their lengths mean nothing.
    """
    length = np.linalg.norm(N, axis=0)
    if not np.all(np.isfinite(N)) or not np.all(length > 0):
        return 1.0
    Z, R = np.linalg.qr(N / length)
    if np.abs(np.diag(R)).min() == 0:
        return 1.0
    Q = np.linalg.qr(exact)[0]
    return min(1.0, float(np.linalg.norm(Z - Q @ (Q.T @ Z), 2)))
