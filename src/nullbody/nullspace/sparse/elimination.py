"""Sparse elimination that shows the rank: steps of independent pivots while A stays sparse, a dense core at the end.

After each step the Schur complement S - L U takes the place of S, with L = S[below, j] / pivots and U = S[i, right].
Entries of S that are nothing but rounding (4 eps of the largest entry that their row ever had) are dropped; a row
of which only rounding is left repeats others.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nullbody.errors import InputError
from nullbody.nullspace.sparse.core import dense_pivots
from nullbody.nullspace.sparse.factor import Core, Factors, Step
from nullbody.nullspace.sparse.pivot import independent_pivots
from nullbody.nullspace.sparse.segment import largest, lines
from nullbody.tolerances import EPS
from nullbody.typing import FloatArray, IndexArray

__all__ = ["Elimination", "eliminated"]

#: The rest is treated as dense from this density on, or once it has so few rows or columns.
_DENSE, _FEW = 0.15, 24

#: Entries of a dense core that fit into memory, a few times over.
_LARGEST_CORE = 200_000_000

#: Breaks ties between pivots; the same matrix gives the same result.
_SEED = 0


@dataclass(frozen=True)
class Elimination:
    """What an elimination found.

    Attributes:
        factors: of the chosen rows and columns.
        complete: nothing but rounding was left; otherwise rows still have entries outside the allowed columns.
    """

    factors: Factors
    complete: bool


@dataclass(frozen=True)
class _Active:
    """The Schur complement that is left, with the numbers of its rows and columns in A."""

    matrix: Any
    rows: IndexArray
    columns: IndexArray
    size: FloatArray

    def cleaned(self, tolerance: float) -> _Active:
        """Without rounding, rows of rounding, and empty columns."""
        matrix = self.matrix
        weight = abs(matrix.data)
        row_size = largest(weight, matrix.indptr)
        size = np.maximum(self.size, row_size)
        noise = weight <= 4 * EPS * size[lines(matrix)]
        if noise.any():
            matrix.data[noise] = 0
            matrix.eliminate_zeros()
        rows = np.flatnonzero(row_size > tolerance * size)
        if len(rows) < matrix.shape[0]:
            matrix = matrix[rows]
        columns = np.flatnonzero(np.bincount(matrix.indices, minlength=matrix.shape[1]))
        if len(columns) < matrix.shape[1]:
            matrix = matrix[:, columns]
        return _Active(matrix, self.rows[rows], self.columns[columns], size[rows])

    @property
    def dense(self) -> bool:
        k, w = self.matrix.shape
        return min(k, w) <= _FEW or self.matrix.nnz > _DENSE * k * w

    def step(self, places: IndexArray) -> tuple[Step, _Active]:
        """Eliminate the pivots at these places of the data."""
        from scipy.sparse import dia_array

        matrix = self.matrix
        i, j, pivots = lines(matrix)[places], matrix.indices[places], matrix.data[places]
        others, right = _others(i, matrix.shape[0]), _others(j, matrix.shape[1])
        below = matrix[others]
        lower = below[:, j] @ dia_array((1 / pivots[None], [0]), shape=(len(j), len(j)))
        upper = matrix[i][:, right]
        rest = (below[:, right] - lower @ upper).tocsr()
        touched = np.flatnonzero(np.diff(lower.indptr))
        used = np.flatnonzero(np.bincount(upper.indices, minlength=len(right)))
        step = Step(
            self.rows[i],
            self.columns[j],
            pivots,
            self.rows[others[touched]],
            lower[touched].tocsr(),
            self.columns[right[used]],
            upper[:, used].tocsr(),
        )
        return step, _Active(rest, self.rows[others], self.columns[right], self.size[others])


def eliminated(matrix: Any, tolerance: float, allowed: NDArray[np.bool_] | None = None) -> Elimination:
    """Eliminate a CSR array with scaled rows.

    Args:
        matrix: m x n.
        tolerance: entries below this part of a row's largest one are rounding.
        allowed: columns in which pivots may lie; all by default.

    Raises:
        InputError: the matrix fills in so much that its core does not fit into memory.
    """
    m, n = matrix.shape
    allowed = np.ones(n, bool) if allowed is None else allowed
    lot = np.random.default_rng(_SEED)
    active = _Active(matrix.copy(), np.arange(m), np.arange(n), np.zeros(m)).cleaned(tolerance)
    steps: list[Step] = []
    while not active.dense:
        places = independent_pivots(active.matrix, active.size, allowed[active.columns], lot)
        if not len(places):
            break
        step, active = active.step(places)
        active = active.cleaned(tolerance)
        steps.append(step)
    core, complete = _core(active, allowed[active.columns], tolerance)
    return Elimination(Factors.of((m, n), tuple(steps), core), complete)


def _core(active: _Active, allowed: NDArray[np.bool_], tolerance: float) -> tuple[Core, bool]:
    """Pivots of what is left; rows without entries in allowed columns are not worth a dense matrix."""
    k, w = active.matrix.shape
    if not k or not allowed.any():
        return Core.of(np.zeros((0, 0), active.matrix.dtype), *(np.zeros(0, np.intp),) * 3), k == 0
    if k * w > _LARGEST_CORE:
        raise InputError(
            f"A fills in: a dense {k} x {w} part is left of {k * w:.0e} entries, at most {_LARGEST_CORE:.0e} are "
            "worked on; order a part of it by hand, or give other independent columns"
        )
    dense = active.matrix.toarray()
    rows, columns, complete = dense_pivots(dense, active.size, allowed, tolerance)
    right = _others(columns, w)
    part = np.concatenate([dense[np.ix_(rows, columns)], dense[np.ix_(rows, right)]], axis=1)
    return Core.of(part, active.rows[rows], active.columns[columns], active.columns[right]), complete


def _others(chosen: IndexArray, count: int) -> IndexArray:
    free = np.ones(count, bool)
    free[chosen] = False
    return np.flatnonzero(free)
