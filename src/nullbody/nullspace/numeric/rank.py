"""What counts as zero, one rank for a whole stack, and how redundant rows repeat others."""

from __future__ import annotations

from typing import Any

import numpy as np

from nullbody.errors import InputError
from nullbody.nullspace.given import checked_tolerance
from nullbody.nullspace.numeric.equilibrate import Array, Matrices
from nullbody.typing import FloatArray, IndexArray

__all__ = ["CLEAR", "combinations", "one_rank", "others", "relative_tolerance", "singular_values"]

#: A rank is in doubt where a pivot or singular value is less than this factor away from the tolerance.
CLEAR = 1e3

#: Coefficients of a combination below this multiple of the tolerance are nothing but rounding.
_ROUNDING = 32


def relative_tolerance(matrices: Matrices, given: float | None = None) -> float:
    """What counts as zero, relative to the Frobenius norm of a matrix with scaled rows.

    The default is eps max(m, n, 10) with the eps of the entries' type.

    Raises:
        InputError: the given one is not in 0..1.
    """
    given = checked_tolerance(given)
    if given is None:
        return float(np.finfo(matrices.dtype).eps) * max(*matrices.shape, 10)
    return given


def one_rank(ranks: IndexArray, matrices: Matrices) -> int:
    """The rank that all matrices have.

    Raises:
        InputError: two have different ranks, or only 0 is in the null space.
    """
    n = matrices.shape[1]
    other = np.flatnonzero(ranks != ranks[0])
    if len(other):
        raise InputError(
            f"the matrices of a stack must have one rank: matrix {matrices.labels[0]} has rank {ranks[0]}, matrix "
            f"{matrices.labels[other[0]]} has rank {ranks[other[0]]} ({len(other)} of {len(ranks)} differ from the "
            "first); sort them by rank, or set the tolerance"
        )
    if ranks[0] == n:
        raise InputError(f"only 0 is in the null space: A has rank {n}, as many as columns")
    return int(ranks[0])


def others(chosen: IndexArray, count: int) -> IndexArray:
    """The numbers in 0..count-1 that are not chosen, in increasing order; one row for each row of `chosen`."""
    free = np.ones((len(chosen), count), bool)
    free[np.arange(len(chosen))[:, None], chosen] = False
    return np.nonzero(free)[1].reshape(len(chosen), count - chosen.shape[1])


def singular_values(stack: Array) -> FloatArray:
    """k x min(m, n), decreasing."""
    if 0 in stack.shape:
        return np.zeros((len(stack), min(stack.shape[1:])))
    values: Any = np.linalg.svd(stack, compute_uv=False)
    return np.asarray(values, np.float64)


def combinations(stack: Array, rows: IndexArray, redundant: IndexArray, tolerance: float) -> Array:
    """K, k x (m - r) x r: the redundant rows are K times the others, in the sense of least squares.

    Coefficients that are nothing but rounding are 0.
    """
    kept = np.take_along_axis(stack, rows[:, :, None], axis=1)
    repeated = np.take_along_axis(stack, redundant[:, :, None], axis=1)
    if 0 in (rows.shape[1], redundant.shape[1], len(stack)):
        return np.zeros((len(stack), redundant.shape[1], rows.shape[1]), stack.dtype)
    Q, R = np.linalg.qr(kept.conj().swapaxes(1, 2))
    K = np.linalg.solve(R, Q.conj().swapaxes(1, 2) @ repeated.conj().swapaxes(1, 2)).conj().swapaxes(1, 2)
    size = abs(K)
    K[size <= _ROUNDING * tolerance * np.maximum(size.max(axis=(1, 2), keepdims=True), 1)] = 0
    return np.asarray(K)
