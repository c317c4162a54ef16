"""Determinants of stacks of square matrices that neither overflow nor underflow on the way."""

from __future__ import annotations

import math

import numpy as np

from nullbody.nullspace.numeric.equilibrate import Array, shifted
from nullbody.typing import FloatArray, IndexArray

__all__ = ["determinants", "relative_determinants"]


def determinants(stack: Array, exponents: IndexArray) -> Array:
    """|B| (k,) of matrices k x r x r with their rows times 2^exponents; infinite or 0 beyond the range of doubles."""
    phase, size = np.linalg.slogdet(stack)
    power = np.where(np.isfinite(size), np.rint(size / math.log(2)), 0)
    with np.errstate(under="ignore"):
        mantissa = phase * np.exp(size - power * math.log(2))
    return shifted(np.asarray(mantissa), power.astype(np.int64) + exponents.sum(axis=1))


def relative_determinants(stack: Array) -> FloatArray:
    """|det B| over the product of the lengths of B's columns: 1 for orthogonal columns, 0 for dependent ones."""
    size = np.linalg.slogdet(stack)[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        lengths = np.log(np.linalg.norm(stack, axis=1)).sum(axis=1)
        return np.exp(np.where(np.isfinite(size), size - lengths, -np.inf))
