"""Which columns of a sparse matrix are independent, where the caller has a say.

A set of columns can be independent exactly if its rows of N, in any chart, are regular. So a preference, or advice for
a choice that is singular, comes from rows of a basis that is already known; the elimination is then repeated in the
chart that was found.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from nullbody.errors import InputError, SingularityError
from nullbody.nullspace.sparse.basis import DENSE_ENTRIES
from nullbody.nullspace.sparse.elimination import Elimination, eliminated
from nullbody.nullspace.sparse.factor import Factors
from nullbody.nullspace.sparse.greedy import greedy_pivots
from nullbody.typing import IndexArray

__all__ = ["in_chart", "preferred"]

#: A preferred column is passed over where its pivot in N is not above this: |N| would exceed about 1e8.
_WEAK = 1e-8

#: So many column numbers fit into a message.
_SHOWN = 40


def in_chart(matrix: Any, independent: IndexArray, tolerance: float) -> Factors:
    """The factors with these independent columns.

    Raises:
        InputError: their number does not fit the rank.
        SingularityError: they cannot be independent; the message names columns that would do.
    """
    n = matrix.shape[1]
    allowed = np.ones(n, bool)
    allowed[independent] = False
    found = eliminated(matrix, tolerance, allowed)
    regular = len(found.factors.dependent) == n - len(independent)
    if regular and found.complete:
        return found.factors
    free = eliminated(matrix, tolerance).factors
    rank = len(free.rows)
    if rank != n - len(independent):
        _refuse_full_rank(rank, n)
        raise InputError(
            f"A has {n} columns and rank {rank}: choose {n - rank} independent columns, not {len(independent)}"
        )
    if regular:
        return found.factors
    raise SingularityError(_advice(free, independent, found))


def preferred(matrix: Any, prefer: IndexArray, tolerance: float) -> Factors:
    """The factors in the chart that has the preferred columns as far as they can be independent, the first ones first.

    Raises:
        InputError: only 0 is in the null space, or too many columns are preferred.
    """
    free = eliminated(matrix, tolerance).factors
    _refuse_full_rank(len(free.rows), matrix.shape[1])
    chart = _exchanged(free, prefer)
    if np.array_equal(chart, free.independent):
        return free
    return in_chart(matrix, chart, tolerance)


def _exchanged(factors: Factors, wanted: IndexArray) -> IndexArray:
    """Independent columns, increasing: the wanted ones, one after the other, take the places of others."""
    known = factors.independent
    if len(wanted) * len(known) > DENSE_ENTRIES:
        raise InputError(
            f"{len(wanted)} preferred of {len(known)} independent columns are too many to be sorted out "
            f"(at most {DENSE_ENTRIES:.0e} entries of N): give fewer, or the independent columns themselves"
        )
    rows = np.zeros((len(wanted), len(known)), factors.core.upper.dtype)
    width = max(1, DENSE_ENTRIES // (10 * factors.shape[1]))
    for start in range(0, len(known), width):
        which = np.arange(start, min(start + width, len(known)))
        rows[:, which] = factors.null_columns(which)[wanted]
    taken, left = greedy_pivots(rows, _WEAK)
    return np.sort(np.concatenate([wanted[taken], np.delete(known, left)]))


def _advice(free: Factors, independent: IndexArray, found: Elimination) -> str:
    missing = len(free.dependent) - len(found.factors.dependent)
    would_do = _exchanged(free, independent)
    leave, enter = np.setdiff1d(independent, would_do).tolist(), np.setdiff1d(would_do, independent).tolist()
    text = (
        f"columns {_shown(independent.tolist())} cannot be the independent ones: the determinant of the others is zero "
        f"to rounding ({missing} of {len(free.dependent)} pivots are missing); "
    )
    if len(would_do) <= _SHOWN:
        return text + f"columns {would_do.tolist()} would do"
    if len(leave) <= _SHOWN:
        return text + f"with columns {enter} in the places of {leave} they would do"
    return text + f"{len(leave)} of them must be others: leave them out, or give them as `prefer`"


def _shown(columns: list[int]) -> str:
    if len(columns) <= _SHOWN:
        return str(columns)
    return f"[{', '.join(map(str, columns[:5]))}, ... {columns[-1]}] ({len(columns)})"


def _refuse_full_rank(rank: int, n: int) -> None:
    if rank == n:
        raise InputError(f"only 0 is in the null space: A has rank {rank}, as many as columns")
