"""Orthonormal bases Z of null spaces: Z^H Z = I, by Householder reflections or singular values, never by Gram.

Z is turned so that its rows at the independent columns v are upper triangular with a positive diagonal. That makes
it the normalised N^ = N T of the paper [14-18] with T unit upper triangular, and makes it unique: every method
gives the same Z. Z loses no accuracy where |B| = 0.
"""

from __future__ import annotations

import numpy as np

from nullbody.nullspace.numeric.equilibrate import Array
from nullbody.nullspace.numeric.rank import CLEAR
from nullbody.typing import FloatArray, IndexArray

__all__ = ["by_householder", "by_singular_values", "orthonormalised", "reduced_of", "rows_at", "turned", "well_spread"]


def by_householder(stack: Array, threshold: FloatArray) -> tuple[Array, IndexArray, IndexArray]:
    """Householder QR of A^H = Q R.

    Rows that are clearly independent (|R^-1| far below 1/threshold) need no pivoting; other matrices are done once
    more, one at a time, with pivoting of A's rows, which shows the rank.

    Returns:
        Q (k, n, n), whose columns from the rank on span the null space; the ranks (k,); A's rows in the order of
        elimination (k, m).
    """
    k, m, n = stack.shape
    ranks, order = np.full(k, m), np.tile(np.arange(m), (k, 1))
    if m == 0 or k == 0:
        return np.tile(np.eye(n, dtype=stack.dtype), (k, 1, 1)), ranks, order
    Q, R = np.linalg.qr(stack.conj().swapaxes(1, 2), mode="complete")
    clear = np.zeros(k, bool)
    if m < n:
        least = CLEAR * threshold
        clear = abs(np.diagonal(R, axis1=1, axis2=2)).min(axis=1) > least
        clear[clear] = np.linalg.norm(np.linalg.inv(R[clear, :m]), axis=(1, 2)) * least[clear] < 1
    for i in np.flatnonzero(~clear):
        Q[i], ranks[i], order[i] = _pivoted(stack[i], float(threshold[i]))
    return Q, ranks, order


def _pivoted(A: Array, threshold: float) -> tuple[Array, int, IndexArray]:
    """QR of one A^H with column pivoting."""
    from scipy.linalg import qr

    Q, R, order = qr(A.conj().T, pivoting=True)
    return Q, int((abs(np.diagonal(R)) > threshold).sum()), order


def by_singular_values(stack: Array, threshold: FloatArray) -> tuple[Array, IndexArray]:
    """V (k, n, n) of A = U S V^H, whose columns from the rank on span the null space, and the ranks (k,)."""
    k, m, n = stack.shape
    if m == 0 or k == 0:
        return np.tile(np.eye(n, dtype=stack.dtype), (k, 1, 1)), np.zeros(k, np.intp)
    _, sizes, V = np.linalg.svd(stack)
    return V.conj().swapaxes(1, 2), (sizes > threshold[:, None]).sum(axis=1)


def well_spread(Z: Array) -> IndexArray:
    """Columns of A (k, d) that make a good chart: Z^H by QR with column pivoting, whatever way Z is turned."""
    k, _, d = Z.shape
    rest = Z.copy()
    chart = np.zeros((k, d), np.intp)
    for p in range(d):
        chart[:, p] = np.linalg.norm(rest, axis=2).argmax(axis=1)
        row = rest[np.arange(k), chart[:, p]]
        row /= np.linalg.norm(row, axis=1)[:, None]
        rest -= (rest @ row.conj()[:, :, None]) * row[:, None, :]
        rest[np.arange(k)[:, None], chart[:, : p + 1]] = 0
    return chart


def rows_at(basis: Array, columns: IndexArray) -> Array:
    """The rows (k, d, d) of bases (k, n, d) at the given columns of A (k, d)."""
    return np.take_along_axis(basis, columns[:, :, None], axis=1)


def turned(Z: Array, independent: IndexArray) -> Array:
    """Z U with U unitary such that the rows at the independent columns are upper triangular, with diagonal >= 0."""
    if 0 in Z.shape:
        return Z
    corner = rows_at(Z, independent)  # = R Q with R upper triangular, by QR of its reversed conjugate transpose
    Q = np.linalg.qr(corner[:, ::-1].conj().swapaxes(1, 2))[0][:, :, ::-1]
    result = Z @ Q
    result = result * _phases(np.diagonal(rows_at(result, independent), axis1=1, axis2=2)).conj()[:, None, :]
    below = np.tri(result.shape[2], k=-1, dtype=bool)
    np.put_along_axis(result, independent[:, :, None], np.where(below, 0, rows_at(result, independent)), axis=1)
    return np.asarray(result)


def orthonormalised(N: Array) -> tuple[Array, FloatArray]:
    """(Z, lengths) of N^ = Z diag(lengths): the orthogonal form of a reduced basis N = Z R, by Householder QR."""
    if 0 in N.shape:
        return N, np.ones((len(N), N.shape[2]))
    Q, R = np.linalg.qr(N)
    diagonal = np.diagonal(R, axis1=1, axis2=2)
    return Q * _phases(diagonal)[:, None, :], abs(diagonal)


def reduced_of(Z: Array, independent: IndexArray) -> Array:
    """N = Z Z_v^-1, with the identity exactly at the independent columns v; Z_v must be regular."""
    N = np.linalg.solve(rows_at(Z, independent).swapaxes(1, 2), Z.swapaxes(1, 2)).swapaxes(1, 2)
    identity = np.broadcast_to(np.eye(Z.shape[2], dtype=Z.dtype), rows_at(Z, independent).shape)
    np.put_along_axis(N, independent[:, :, None], identity, axis=1)
    return np.asarray(N)


def _phases(numbers: Array) -> Array:
    """numbers / |numbers|; 1 for 0."""
    size = abs(numbers)
    return np.asarray(np.where(size > 0, numbers, 1) / np.where(size > 0, size, 1))
