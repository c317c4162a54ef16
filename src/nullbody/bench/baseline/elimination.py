"""Null spaces by elimination: the dependent columns are solved for, N = [-B^-1 C; I].

A is m x n of rank m. Unless a method chooses for itself, the last n - m columns are the independent ones.
"""

from __future__ import annotations

import numpy as np

from nullbody.typing import FloatArray

__all__ = ["gauss_jordan", "lapack_solve", "maggi_kane", "wehage_haug"]


def gauss_jordan(A: FloatArray) -> FloatArray:
    """Row operations with partial pivoting that turn [B | C] into [I | B^-1 C]: the paper's conventional method.

    The chosen columns are fixed: near |B| = 0 the last pivots are small whatever the order of the rows.

    Raises:
        LinAlgError: a column has no pivot left, |B| = 0.
    """
    rows, size = A.shape
    R = np.array(A, dtype=np.float64)
    for k in range(rows):
        pivot = k + int(np.argmax(np.abs(R[k:, k])))
        if pivot != k:
            R[[k, pivot]] = R[[pivot, k]]
        if R[k, k] == 0:
            raise np.linalg.LinAlgError("Singular matrix")
        R[k] /= R[k, k]
        for i in range(rows):
            if i != k:
                R[i] -= R[i, k] * R[k]
    return np.vstack([-R[:, rows:], np.eye(size - rows)])


def lapack_solve(A: FloatArray) -> FloatArray:
    """-B^-1 C by LAPACK's row-pivoted LU (gesv): what one writes first in NumPy."""
    rows, size = A.shape
    return np.vstack([-np.linalg.solve(A[:, :rows], A[:, rows:]), np.eye(size - rows)])


def wehage_haug(A: FloatArray) -> FloatArray:
    """Coordinate partitioning: P A Q = L [U | W] with full pivoting; pivot columns are the dependent coordinates.

    R. A. Wehage, E. J. Haug: Generalized coordinate partitioning for dimension reduction in analysis of constrained
    dynamic systems. J. Mechanical Design 104 (1982) 247-255.
    """
    rows, size = A.shape
    R, columns = np.array(A, dtype=np.float64), np.arange(size)
    for k in range(rows):
        i, j = divmod(int(np.argmax(np.abs(R[k:, k:]))), size - k)
        R[[k, k + i]] = R[[k + i, k]]
        R[:, [k, k + j]] = R[:, [k + j, k]]
        columns[[k, k + j]] = columns[[k + j, k]]
        factors = R[k + 1 :, k] / R[k, k]
        R[k + 1 :, k:] -= np.outer(factors, R[k, k:])
    X = -R[:, rows:]
    for k in reversed(range(rows)):  # back substitution in U X = -W
        X[k] = (X[k] - R[k, k + 1 : rows] @ X[k + 1 :]) / R[k, k]
    N = np.empty((size, size - rows))
    N[columns] = np.vstack([X, np.eye(size - rows)])
    return N


def maggi_kane(A: FloatArray, U: FloatArray | None = None) -> FloatArray:
    """The last columns of the inverse of [A; U], where u = U q' are the chosen speeds: U N = I.

    Maggi's equations in Kane's form; A. Laulusa, O. A. Bauchau: Review of classical approaches for constraint
    enforcement in multibody systems. J. Computational and Nonlinear Dynamics 3 (2008) 011004.

    Args:
        A: m x n.
        U: (n - m) x n; by default it picks the last coordinates.
    """
    rows, size = A.shape
    speeds = np.eye(size)[rows:] if U is None else U
    return np.linalg.inv(np.vstack([A, speeds]))[:, rows:]
