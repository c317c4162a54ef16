"""Pivots of a dense matrix, row after row: a row that repeats those before it, or nearly, is passed over.

Elimination by rows with the largest entry of each row as its pivot (partial pivoting by columns), in blocks of rows so
that nearly all work is products of matrices.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from nullbody.nullspace.numeric.equilibrate import Array
from nullbody.typing import IndexArray

__all__ = ["greedy_pivots"]

#: Rows that are eliminated together.
_BLOCK = 48


def greedy_pivots(matrix: Array, least: float) -> tuple[IndexArray, IndexArray]:
    """Rows in increasing order, and the column of the pivot of each.

    Args:
        matrix: p x q.
        least: a row whose entries are all at most that, once those before it are eliminated, gets no pivot.
    """
    from scipy.linalg import solve_triangular

    p, q = matrix.shape
    columns = np.arange(q)
    found: list[int] = []
    upper: Any = np.zeros((min(p, q), q), matrix.dtype)
    for start in range(0, p, _BLOCK):
        r = len(found)
        if r == min(p, q):
            break
        block = matrix[start : start + _BLOCK][:, columns]
        if r:
            factors = solve_triangular(upper[:r, :r], block[:, :r].T, trans="T", check_finite=False).T
            block[:, r:] -= factors @ upper[:r, r:]
        for k in range(len(block)):
            r = len(found)
            if r == q:
                break
            j = r + int(np.argmax(abs(block[k, r:])))
            if not abs(block[k, j]) > least:
                continue
            for array in (columns[None], upper[:r], block):
                array[:, [r, j]] = array[:, [j, r]]
            upper[r, r:] = block[k, r:]
            block[k + 1 :, r:] -= np.outer(block[k + 1 :, r] / block[k, r], block[k, r:])
            found.append(start + k)
    return np.array(found, np.intp), columns[: len(found)]
