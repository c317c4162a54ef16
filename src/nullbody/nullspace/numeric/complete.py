"""Gaussian elimination with complete pivoting, on a whole stack at once.

The largest entry that is left becomes the next pivot. That shows the rank, and the columns that never became a pivot
are a good choice of independent ones: the pivots' columns B have entries of B^-1 C of moderate size.
Source: N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., 2002, section 9.1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nullbody.nullspace.numeric.equilibrate import Array
from nullbody.typing import FloatArray, IndexArray

__all__ = ["Elimination", "eliminated"]

_CHUNK = 1000  # matrices that are worked on at a time: they stay in the second cache


@dataclass(frozen=True)
class Elimination:
    """P A Q = L U for every matrix of a stack; L is not kept.

    Attributes:
        upper: U, k x m x n, in its upper triangle.
        rows: k x m, the rows of A in the order of P A.
        columns: k x n, the columns of A in the order of A Q.
        sizes: absolute values of the pivots, in order; they need not decrease, but the last are the small ones.
    """

    upper: Array
    rows: IndexArray
    columns: IndexArray
    sizes: FloatArray

    def ranks(self, threshold: FloatArray) -> IndexArray:
        """How many pivots exceed the threshold (k,), which is raised where the elimination let entries grow."""
        growth = np.maximum.accumulate(np.maximum(self.sizes, 1.0), axis=1)
        small = self.sizes <= threshold[:, None] * growth
        ends = np.concatenate([small, np.ones((len(small), 1), bool)], axis=1)
        return ends.argmax(axis=1)

    def null_space(self, rank: int) -> Array:
        """N = [-B^-1 C; I], k x n x d, in A's order of columns; B are the columns of the first `rank` pivots."""
        k, _, n = self.upper.shape
        X = self.upper[:, :rank, rank:].copy()
        for p in reversed(range(rank)):  # back substitution: U_B X = U_C
            X[:, p] /= self.upper[:, p, p, None]
            X[:, :p] -= self.upper[:, :p, p, None] * X[:, p, None, :]
        N = np.zeros((k, n, n - rank), X.dtype)
        places = np.arange(k)[:, None]
        N[places, self.columns[:, :rank]] = -X
        N[places, self.columns[:, rank:]] = np.eye(n - rank)
        return N


def eliminated(stack: Array, order: IndexArray | None = None, among: int | None = None) -> Elimination:
    """Eliminate every matrix of a stack k x m x n.

    Args:
        stack: the matrices, rows scaled alike.
        order: k x n, the order in which the columns are laid out; as they are by default.
        among: pivots are looked for in that many columns only, the first ones of the order; all by default.
    """
    k, _, n = stack.shape
    among = n if among is None else among
    order = np.broadcast_to(np.arange(n), (k, n)) if order is None else order
    if k <= _CHUNK:
        return _eliminated(stack, order, among)
    starts = range(0, k, _CHUNK)
    parts = [_eliminated(stack[a : a + _CHUNK], order[a : a + _CHUNK], among) for a in starts]
    fields = zip(*((e.upper, e.rows, e.columns, e.sizes) for e in parts), strict=True)
    return Elimination(*(np.concatenate(field) for field in fields))


def _eliminated(stack: Array, order: IndexArray, among: int) -> Elimination:
    k, m, _ = stack.shape
    rows, columns = np.tile(np.arange(m), (k, 1)), order.copy()
    U = np.take_along_axis(stack, columns[:, None, :], axis=2)
    across = U.swapaxes(1, 2)  # the same memory, columns first
    sizes = np.zeros((k, min(m, among)))
    every = np.arange(k)
    for p in range(min(m, among)):
        block = abs(U[:, p:, p:among]).reshape(k, -1)
        place = block.argmax(axis=1)
        sizes[:, p] = block[every, place]
        i, j = np.divmod(place, among - p)
        for lines, other in ((U, p + i), (rows, p + i), (across, p + j), (columns, p + j)):
            moved = lines[every, other]
            lines[every, other] = lines[:, p]
            lines[:, p] = moved
        pivot = np.where(sizes[:, p] > 0, U[:, p, p], 1)
        factors = U[:, p + 1 :, p] / pivot[:, None]
        U[:, p + 1 :, p + 1 :] -= factors[:, :, None] * U[:, p, None, p + 1 :]
    return Elimination(U, rows, columns, sizes)
