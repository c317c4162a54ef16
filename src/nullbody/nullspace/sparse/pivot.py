"""Which entries to eliminate next: many pivots at once that do not disturb each other.

Pivots (i, j) and (i', j') with A[i, j'] = A[i', j] = 0 can be eliminated in one step, whose Schur complement is one
sparse product. A candidate has

    |a_ij| >= 1/2 of the largest entry of its row         (entries of B^-1 C stay small: a good chart)
    |a_ij| >= 1/10 of the largest entry of its column     (growth stays small, ranks show)
    (r_i - 1) (c_j - 1) near the least                    (Markowitz: little fill-in)

and of candidates in conflict the cheapest wins; ties go by lot, from a fixed seed, since equal costs along a chain
would otherwise let one pivot through in each step.
Sources: H. M. Markowitz, Management Science 3 (1957) 255-269; T. A. Davis, P.-C. Yew, SIAM Journal on Matrix Analysis
11 (1990) 383-402 (independent sets); P. E. Gill, W. Murray, M. A. Saunders, SIAM Review 47 (2005) 99-131 (rook).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nullbody.nullspace.sparse.segment import NOTHING, largest, least, lines
from nullbody.typing import FloatArray, IndexArray

__all__ = ["Pattern", "independent_pivots"]

#: A pivot is at least these parts of the largest entry in its row, in its column.
_OF_ROW, _OF_COLUMN = 0.5, 0.1

#: A pivot is at least this part of the largest entry that its row ever had; smaller ones are left to the dense end.
_TRUSTED = 1e-8

#: Costs up to this multiple of the least one, or up to the second number, are taken in one step.
_RELAXED, _CHEAP = 4, 8

#: How often the candidates left over are looked through in one step.
_PASSES = 4


@dataclass(frozen=True)
class Pattern:
    """Where the entries of a CSR array stand: by rows as they are stored, by columns through `order`."""

    rows: IndexArray
    columns: IndexArray
    row_starts: IndexArray
    column_starts: IndexArray
    order: IndexArray

    @classmethod
    def of(cls, matrix: Any) -> Pattern:
        """The pattern of a CSR array."""
        columns = matrix.indices
        counts = np.bincount(columns, minlength=matrix.shape[1])
        starts = np.concatenate([[0], np.cumsum(counts)])
        return cls(lines(matrix), columns, matrix.indptr, starts, np.argsort(columns, kind="stable"))

    @property
    def costs(self) -> IndexArray:
        """(r_i - 1) (c_j - 1) of every entry: how many entries its elimination may change."""
        in_row, in_column = np.diff(self.row_starts), np.diff(self.column_starts)
        return (in_row[self.rows].astype(np.intp) - 1) * (in_column[self.columns] - 1)


def independent_pivots(
    matrix: Any, size: FloatArray, allowed: NDArray[np.bool_], lot: np.random.Generator
) -> IndexArray:
    """Places in `matrix.data` of pivots that do not disturb each other; none where no entry is large enough.

    Args:
        matrix: CSR array.
        size: the largest entry that each row ever had.
        allowed: columns in which pivots may lie.
        lot: breaks ties.
    """
    pattern = Pattern.of(matrix)
    weight = np.where(allowed[pattern.columns], abs(matrix.data), 0.0)
    row_size = largest(weight, pattern.row_starts)
    column_size = largest(weight[pattern.order], pattern.column_starts)
    candidate = (weight >= _OF_ROW * row_size[pattern.rows]) & (weight > _TRUSTED * size[pattern.rows])
    candidate &= weight >= _OF_COLUMN * column_size[pattern.columns]
    if not candidate.any():
        return np.zeros(0, np.intp)
    costs = pattern.costs
    candidate &= costs <= max(_CHEAP, _RELAXED * int(costs[candidate].min()))
    places = np.flatnonzero(candidate)
    ranks = np.full(len(weight), NOTHING)
    ranks[places[np.lexsort((lot.permutation(len(places)), costs[places]))]] = np.arange(len(places))
    return _without_conflicts(pattern, ranks)


def _without_conflicts(pattern: Pattern, ranks: IndexArray) -> IndexArray:
    """The candidates that come before all those which they are in conflict with, in a few passes."""
    found = []
    for _ in range(_PASSES):
        first_of_row = least(ranks, pattern.row_starts)
        first_of_column = least(ranks[pattern.order], pattern.column_starts)
        before_row = least(first_of_column[pattern.columns], pattern.row_starts)
        before_column = least(first_of_row[pattern.rows][pattern.order], pattern.column_starts)
        wins = (ranks != NOTHING) & (ranks <= before_row[pattern.rows]) & (ranks <= before_column[pattern.columns])
        places = np.flatnonzero(wins)
        if not len(places):
            break
        found.append(places)
        row_taken = np.zeros(len(pattern.row_starts) - 1, bool)
        column_taken = np.zeros(len(pattern.column_starts) - 1, bool)
        row_taken[pattern.rows[places]] = column_taken[pattern.columns[places]] = True
        column_touched, row_touched = np.zeros_like(column_taken), np.zeros_like(row_taken)
        column_touched[pattern.columns[row_taken[pattern.rows]]] = True
        row_touched[pattern.rows[column_taken[pattern.columns]]] = True
        ranks = np.where(row_touched[pattern.rows] | column_touched[pattern.columns], NOTHING, ranks)
    return np.concatenate(found)
