"""Numeric null spaces of a 9 x 12 matrix by other methods, in NumPy and SciPy, for the comparison of Table 4.

gauss_jordan   row operations with partial pivoting on [B | C]: the paper's conventional method
determinants   N_ij = -|B(i <- C_j)| / |B|, every determinant on its own: the paper's proposed method [11]
solve          -B^-1 C by LAPACK's LU: coordinate partitioning (Wehage and Haug 1982)
orthogonal     the tail of Q in A^T = Q R (Kim and Vanderploeg 1986)
svd            the right singular vectors of the zeros (Singh and Likins 1985; scipy.linalg.null_space)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from nullbody.typing import FloatArray

__all__ = ["METHODS", "determinants", "gauss_jordan", "orthogonal", "solve", "svd"]


def gauss_jordan(A: FloatArray) -> FloatArray:
    """N by Gauss-Jordan elimination, row by row, with the largest pivot of each column."""
    rows, size = A.shape
    R = A.copy()
    for k in range(rows):
        pivot = k + int(np.argmax(np.abs(R[k:, k])))
        if pivot != k:
            R[[k, pivot]] = R[[pivot, k]]
        R[k] /= R[k, k]
        for i in range(rows):
            if i != k:
                R[i] -= R[i, k] * R[k]
    return np.vstack([-R[:, rows:], np.eye(size - rows)])


def determinants(A: FloatArray) -> FloatArray:
    """N by Cramer's rule, one determinant for each entry."""
    rows, size = A.shape
    B, C = A[:, :rows], A[:, rows:]
    N = np.eye(size)[:, rows:]
    delta = np.linalg.det(B)
    for j in range(size - rows):
        for i in range(rows):
            replaced = B.copy()
            replaced[:, i] = C[:, j]
            N[i, j] = -np.linalg.det(replaced) / delta
    return N


def solve(A: FloatArray) -> FloatArray:
    """N by LAPACK's pivoted LU."""
    rows, size = A.shape
    return np.vstack([-np.linalg.solve(A[:, :rows], A[:, rows:]), np.eye(size - rows)])


def orthogonal(A: FloatArray) -> FloatArray:
    """An orthonormal basis by Householder QR of A^T."""
    return np.linalg.qr(A.T, mode="complete")[0][:, A.shape[0] :]


def svd(A: FloatArray) -> FloatArray:
    """An orthonormal basis by singular values."""
    from scipy.linalg import null_space

    found: FloatArray = null_space(A)
    return found


METHODS: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "Gauss-Jordan, row by row (NumPy)": gauss_jordan,
    "28 determinants (NumPy), the paper's formula": determinants,
    "pivoted LU, numpy.linalg.solve": solve,
    "QR of Aᵀ, numpy.linalg.qr": orthogonal,
    "singular values, scipy.linalg.null_space": svd,
}
