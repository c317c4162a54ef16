"""The dense end of a sparse elimination: which rows and columns are left to be pivots, and the numerical rank.

LU with partial pivoting does most of it. Rows (or columns, where there are fewer) that turn out to repeat others,
nearly, are put off; QR with column pivoting of their Schur complement decides how many of them are independent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nullbody.nullspace.numeric.equilibrate import Array
from nullbody.typing import FloatArray, IndexArray

__all__ = ["dense_pivots"]

#: A line whose pivot is below this part of its size is put off: it would magnify rounding.
_PUT_OFF = 0.03

#: How often LU is repeated without the lines that were put off (their pivots had taken places of others) before all
#: is left to QR.
_REPEATED = 8


def dense_pivots(
    matrix: Array, size: FloatArray, allowed: NDArray[np.bool_], tolerance: float
) -> tuple[IndexArray, IndexArray, bool]:
    """Rows and columns of a regular square part as large as the rank, to rounding.

    Args:
        matrix: k x w.
        size: (k,), what the entries of each row are compared with.
        allowed: columns in which pivots may lie.
        tolerance: entries below this part of a row's size are rounding.

    Returns:
        The rows, their columns, and whether nothing but rounding is left without them, in all columns.
    """
    scaled = matrix / size[:, None]
    among = np.flatnonzero(allowed)
    safe = _safe_pivots(scaled[:, among])
    doubtful = np.flatnonzero((abs(safe.rest) > tolerance).any(axis=1))
    rows, columns = safe.rows, safe.columns
    if len(doubtful):
        more_rows, more_columns = _by_orthogonalisation(safe.rest[doubtful], tolerance)
        rows = np.concatenate([rows, safe.other_rows[doubtful[more_rows]]])
        columns = np.concatenate([columns, safe.other_columns[more_columns]])
    columns = among[columns]
    return rows, columns, bool(allowed.all()) or _nothing_left(scaled, rows, columns, tolerance)


@dataclass(frozen=True)
class _Safe:
    """A regular square part, and the Schur complement `rest` that it leaves of the other rows and columns."""

    rows: IndexArray
    columns: IndexArray
    other_rows: IndexArray
    other_columns: IndexArray
    rest: Array

    @property
    def transposed(self) -> _Safe:
        return _Safe(self.columns, self.rows, self.other_columns, self.other_rows, self.rest.T)


def _safe_pivots(matrix: Array) -> _Safe:
    """A pivot for each line of the shorter side, as far as that is safe."""
    if matrix.shape[0] < matrix.shape[1]:
        return _safe_pivots(matrix.T).transposed
    from scipy.linalg import lu, solve_triangular

    m, n = matrix.shape
    kept = np.arange(n)
    for _ in range(_REPEATED):
        order, lower, upper = lu(matrix[:, kept], p_indices=True, check_finite=False)
        safe = abs(np.diagonal(upper)) > _PUT_OFF
        if not safe.all():
            kept = kept[safe]
            continue
        r, order, others = len(kept), np.argsort(order), np.setdiff1d(np.arange(n), kept)
        part: Any = matrix[np.ix_(order, others)]
        if part.size and r:
            first = solve_triangular(lower[:r], part[:r], lower=True, unit_diagonal=True, check_finite=False)
            part = np.concatenate([part[:r], part[r:] - lower[r:] @ first])
        return _Safe(order[:r], kept, order[r:], others, part[r:])
    return _Safe(kept[:0], kept[:0], np.arange(m), np.arange(n), matrix)


def _nothing_left(matrix: Array, rows: IndexArray, columns: IndexArray, tolerance: float) -> bool:
    """Whether the other rows are combinations of these, in all columns."""
    others = np.setdiff1d(np.arange(len(matrix)), rows)
    rest = matrix[others]
    if rest.size and len(rows):
        combination = np.linalg.solve(matrix[np.ix_(rows, columns)].T, matrix[np.ix_(others, columns)].T)
        rest = rest - combination.T @ matrix[rows]
    return not (abs(rest) > tolerance).any()


def _by_orthogonalisation(matrix: Array, tolerance: float) -> tuple[IndexArray, IndexArray]:
    """Rows and columns of a regular square part, by QR with column pivoting: first columns, then their rows."""
    from scipy.linalg import qr

    triangle, columns = qr(matrix, mode="r", pivoting=True, check_finite=False)
    rank = int(np.count_nonzero(abs(np.diagonal(triangle)) > tolerance))
    if rank == len(matrix):
        return np.arange(rank), columns[:rank]
    if rank == 0:
        return np.zeros(0, np.intp), np.zeros(0, np.intp)
    rows = qr(matrix[:, columns[:rank]].T, mode="r", pivoting=True, check_finite=False)[1]
    return rows[:rank], columns[:rank]
