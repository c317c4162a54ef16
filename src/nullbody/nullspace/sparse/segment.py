"""Largest and least values of the rows of a compressed matrix, all at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from nullbody.typing import FloatArray, IndexArray

__all__ = ["NOTHING", "largest", "least", "lines"]

#: What `least` gives for a row without entries.
NOTHING = np.iinfo(np.intp).max


def largest(values: FloatArray, starts: IndexArray) -> FloatArray:
    """The largest of the non-negative values of each row, 0 for an empty one; row i begins at starts[i]."""
    result = np.zeros(len(starts) - 1)
    filled = np.flatnonzero(np.diff(starts))
    if len(filled):
        result[filled] = np.maximum.reduceat(values, starts[filled])
    return result


def least(values: IndexArray, starts: IndexArray) -> IndexArray:
    """The least of the values of each row, `NOTHING` for an empty one."""
    result = np.full(len(starts) - 1, NOTHING)
    filled = np.flatnonzero(np.diff(starts))
    if len(filled):
        result[filled] = np.minimum.reduceat(values, starts[filled])
    return result


def lines(matrix: Any) -> IndexArray:
    """For every stored entry of a compressed matrix the number of its row (CSR) or column (CSC)."""
    return np.repeat(np.arange(len(matrix.indptr) - 1), np.diff(matrix.indptr))
