"""Factors of a sparse matrix in a chart, and what is solved with them.

Each step holds pivots D that do not disturb each other, what they were subtracted from (L) and the rest of their
rows (U):

    forwards    b[below] -= L b[rows]                    in the order of the steps, then the core
    backwards   x[columns] = D^-1 (b[rows] - U x[right]) in the reverse order

With b = 0 and the identity in the independent places, going backwards gives N itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from nullbody.nullspace.numeric.equilibrate import Array
from nullbody.typing import IndexArray

__all__ = ["Core", "Factors", "Step"]


@dataclass(frozen=True)
class Step:
    """Pivots that were eliminated together; numbers of rows and columns are those of A.

    Attributes:
        rows, columns, pivots: one of each for every pivot.
        below, lower: rows that changed, and L, CSR.
        right, upper: columns of the rest of the pivots' rows, and U, CSR.
    """

    rows: IndexArray
    columns: IndexArray
    pivots: Array
    below: IndexArray
    lower: Any
    right: IndexArray
    upper: Any


@dataclass(frozen=True)
class Core:
    """The dense part: rows, dependent columns, and the independent columns that it holds.

    Attributes:
        factors: LU of the square part (`scipy.linalg.lu_factor`).
        upper: the columns `right` of its rows.
    """

    rows: IndexArray
    columns: IndexArray
    right: IndexArray
    factors: tuple[Array, IndexArray]
    upper: Array

    @classmethod
    def of(cls, part: Array, rows: IndexArray, columns: IndexArray, right: IndexArray) -> Core:
        """From the rows' entries in the dependent columns, then in the others."""
        from scipy.linalg import lu_factor

        k = len(rows)
        square = part[:, :k]
        factors = lu_factor(square, check_finite=False) if k else (square, np.zeros(0, np.intp))
        return cls(rows, columns, right, factors, part[:, k:])

    def solve(self, b: Array, transposed: bool = False) -> Array:
        """x with B x = b, or B^T x = b, for the square part B."""
        from scipy.linalg import lu_solve

        return lu_solve(self.factors, b, trans=int(transposed), check_finite=False) if len(self.rows) else b


@dataclass(frozen=True)
class Factors:
    """L and U of the rows of A that were used; right sides and solutions have as many rows as A has rows or columns.

    Attributes:
        shape: (m, n).
        rows: independent rows, increasing.
        dependent, independent: columns, increasing.
    """

    shape: tuple[int, int]
    steps: tuple[Step, ...]
    core: Core
    rows: IndexArray
    dependent: IndexArray
    independent: IndexArray

    @classmethod
    def of(cls, shape: tuple[int, int], steps: tuple[Step, ...], core: Core) -> Factors:
        """Sort out rows and columns."""
        rows = np.sort(np.concatenate([*(step.rows for step in steps), core.rows]))
        dependent = np.sort(np.concatenate([*(step.columns for step in steps), core.columns]))
        return cls(shape, steps, core, rows, dependent, np.setdiff1d(np.arange(shape[1]), dependent))

    @property
    def order(self) -> tuple[IndexArray, IndexArray]:
        """Rows and dependent columns in the order in which they were eliminated."""
        rows = np.concatenate([*(step.rows for step in self.steps), self.core.rows])
        return rows, np.concatenate([*(step.columns for step in self.steps), self.core.columns])

    def null_columns(self, which: IndexArray) -> Array:
        """Columns of N, n x p: those of the independent columns with these places in `independent`."""
        x = np.zeros((self.shape[1], len(which)), self.core.upper.dtype)
        x[self.independent[which], np.arange(len(which))] = 1
        self._backwards(None, x)
        return x

    def move(self, v: Array) -> Array:
        """N v for velocities v (d, p)."""
        x = np.zeros((self.shape[1], v.shape[1]), np.result_type(v, self.core.upper))
        x[self.independent] = v
        self._backwards(None, x)
        return x

    def solve(self, b: Array) -> Array:
        """x (n, p) with A x = b in the used rows, and zeros in the independent places; b is (m, p)."""
        b = np.array(b, np.result_type(b, self.core.upper))
        for step in self.steps:
            b[step.below] -= step.lower @ b[step.rows]
        x = np.zeros((self.shape[1], b.shape[1]), b.dtype)
        self._backwards(b, x)
        return x

    def transposed(self, f: Array) -> tuple[Array, Array]:
        """y (m, p) with B^T y = f in the dependent places and 0 for redundant rows; and N^T f (d, p), for f (n, p)."""
        f = np.array(f, np.result_type(f, self.core.upper))
        y = np.zeros((self.shape[0], f.shape[1]), f.dtype)
        for step in self.steps:
            part = f[step.columns] / step.pivots[:, None]
            f[step.right] -= step.upper.T @ part
            y[step.rows] = part
        part = self.core.solve(f[self.core.columns], transposed=True)
        f[self.core.right] -= self.core.upper.T @ part
        y[self.core.rows] = part
        for step in reversed(self.steps):
            y[step.rows] -= step.lower.T @ y[step.below]
        return y, f[self.independent]

    def _backwards(self, b: Array | None, x: Array) -> None:
        """Fill in the dependent places of x, given the independent ones; b = 0 where it is None."""
        rest = -self.core.upper @ x[self.core.right]
        x[self.core.columns] = self.core.solve(rest if b is None else rest + b[self.core.rows])
        for step in reversed(self.steps):
            rest = -(step.upper @ x[step.right])
            x[step.columns] = (rest if b is None else rest + b[step.rows]) / step.pivots[:, None]
