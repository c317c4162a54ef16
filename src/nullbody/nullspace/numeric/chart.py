"""Charts: which columns are independent - the user's choice, a preference, or what is left by complete pivoting."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nullbody.errors import InputError, SingularityError
from nullbody.nullspace.given import checked_columns
from nullbody.nullspace.numeric.complete import eliminated
from nullbody.nullspace.numeric.determinant import relative_determinants
from nullbody.nullspace.numeric.equilibrate import Array, Matrices
from nullbody.nullspace.numeric.rank import one_rank, others, relative_tolerance
from nullbody.typing import FloatArray, IndexArray

__all__ = ["PREFERRED", "Chart", "Request", "chosen", "dependent_part", "preferred", "refused"]

#: Preferred columns are taken as long as the condition of N stays below this multiple of what complete pivoting gives.
PREFERRED = 1e3


@dataclass(frozen=True)
class Request:
    """What the caller asked for.

    Attributes:
        independent: the independent columns, or None.
        prefer: columns in the order in which they should stay independent.
        tolerance: what counts as zero, relative.
    """

    independent: tuple[int, ...] | None
    prefer: tuple[int, ...]
    tolerance: float

    @classmethod
    def of(
        cls,
        matrices: Matrices,
        independent: Sequence[int] | None,
        prefer: Sequence[int] | None,
        tolerance: float | None,
    ) -> Request:
        """The checked request.

        Raises:
            InputError: columns that are not there or twice, both columns and a preference, a bad tolerance.
        """
        n = matrices.shape[1]
        if independent is not None and prefer is not None:
            raise InputError("give the independent columns or a preference among columns, not both")
        columns = None if independent is None else checked_columns(independent, n, "independent")
        return cls(columns, checked_columns(prefer or (), n, "preferred"), relative_tolerance(matrices, tolerance))

    def threshold(self, matrices: Matrices) -> FloatArray:
        """What counts as zero in each matrix, (k,)."""
        return self.tolerance * matrices.size


@dataclass(frozen=True)
class Chart:
    """Columns and rows that were chosen, one choice for each matrix of a stack.

    Attributes:
        independent: k x d, in the order of the basis's columns.
        dependent: k x r, increasing.
        rows: k x r, increasing; independent rows.
    """

    independent: IndexArray
    dependent: IndexArray
    rows: IndexArray

    @property
    def order(self) -> IndexArray:
        """k x n: the dependent columns, then the independent ones."""
        return np.concatenate([self.dependent, self.independent], axis=1)


def chosen(matrices: Matrices, request: Request) -> tuple[Chart, Array | None]:
    """The chart that a request leads to, and N where complete pivoting has found it on the way.

    Where columns are given and as many others as A has rows are left, nothing is computed: that |B| is not zero shows
    when B is solved for.

    Raises:
        InputError: the number of columns does not fit the rank, the ranks differ, or only 0 is in the null space.
        SingularityError: |B| = 0 with redundant rows.
    """
    k, (m, n), threshold = len(matrices), matrices.shape, request.threshold(matrices)
    if request.independent is not None:
        given = np.tile(np.array(request.independent, np.intp), (k, 1))
        dependent = others(given, n)
        if dependent.shape[1] > m:
            raise _wrong_number(n, f"at most {m}", f"at least {n - m}", request.independent)
        if dependent.shape[1] == m < n:
            return Chart(given, dependent, np.tile(np.arange(m), (k, 1))), None
        return Chart(given, dependent, _rows(matrices, given, dependent, request)), None
    found = eliminated(matrices.scaled)
    rank = one_rank(found.ranks(threshold), matrices)
    N, left = found.null_space(rank), found.columns[:, rank:]
    free = np.sort(preferred(N, left, request.prefer) if request.prefer else left, axis=1)
    chart = Chart(free, others(free, n), np.sort(found.rows[:, :rank], axis=1))
    if request.prefer:
        return chart, None
    return chart, np.take_along_axis(N, np.argsort(left, axis=1)[:, None, :], axis=2)


def dependent_part(matrices: Matrices, chart: Chart) -> Array:
    """B (k, r, r), rows scaled."""
    kept = np.take_along_axis(matrices.scaled, chart.rows[:, :, None], axis=1)
    return np.take_along_axis(kept, chart.dependent[:, None, :], axis=2)


def preferred(N: Array, chart: IndexArray, order: Sequence[int]) -> IndexArray:
    """Exchange columns until those of `order` are independent, one after the other, as far as that is wise.

    Column j takes the place of the one with the largest coefficient in row j of N, among those that are not preferred
    themselves, unless the condition of N would exceed `PREFERRED` times what it was at first.

    Args:
        N: the reduced bases (k, n, d) in the chart.
        chart: independent columns (k, d).
        order: columns, the most wanted first.
    """
    N, chart = N.copy(), chart.copy()
    if 0 in N.shape:
        return chart
    bound = PREFERRED * np.linalg.norm(N, 2, axis=(1, 2))
    taken = np.zeros(chart.shape, bool)
    every = np.arange(len(N))
    for j in order:
        row = N[:, j].copy()
        place = np.where(taken, -1, abs(row)).argmax(axis=1)
        pivot = row[every, place]
        possible = (pivot != 0) & ~taken[every, place]
        column = N[every, :, place] / np.where(possible, pivot, 1)[:, None]
        changed = N - column[:, :, None] * row[:, None, :]
        changed[every, :, place] = column
        possible &= np.linalg.norm(changed, 2, axis=(1, 2)) <= bound
        N[possible] = changed[possible]
        chart[every[possible], place[possible]] = j
        taken[every[possible], place[possible]] = True
    return chart


def refused(matrices: Matrices, chart: Chart, index: int, request: Request) -> InputError | SingularityError:
    """What to raise where B of matrix `index` is singular to rounding: the rank does not fit, or the columns do not."""
    one, n = matrices.at([index]), matrices.shape[1]
    given = [int(j) for j in chart.independent[index]]
    found = eliminated(one.scaled)
    rank = one_rank(found.ranks(request.threshold(one)), one)
    if rank != n - len(given):
        return _wrong_number(n, str(rank), str(n - rank), given, one.name(0))
    own = Chart(chart.independent[[index]], chart.dependent[[index]], chart.rows[[index]])
    size = relative_determinants(dependent_part(one, own))[0]
    advice = np.sort(preferred(found.null_space(rank), found.columns[:, rank:], given)[0]).tolist()
    return SingularityError(
        f"columns {given} cannot be the independent ones of {one.name(0)}: the determinant of the others is zero to "
        f"rounding ({size:.1e} of the product of its columns' lengths); columns {advice} would do"
    )


def _rows(matrices: Matrices, given: IndexArray, dependent: IndexArray, request: Request) -> IndexArray:
    """Independent rows for given columns, where there are more rows than dependent columns."""
    threshold, r = request.threshold(matrices), dependent.shape[1]
    rank = one_rank(eliminated(matrices.scaled).ranks(threshold), matrices)
    if rank != r:
        raise _wrong_number(matrices.shape[1], str(rank), str(matrices.shape[1] - rank), given[0])
    found = eliminated(matrices.scaled, np.concatenate([dependent, given], axis=1), r)
    weak = np.flatnonzero(found.ranks(threshold) < r)
    rows = np.sort(found.rows[:, :r], axis=1)
    if len(weak):
        raise refused(matrices, Chart(given, dependent, rows), int(weak[0]), request)
    return rows


def _wrong_number(n: int, rank: str, wanted: str, given: Sequence[int], name: str = "A") -> InputError:
    return InputError(f"{name} has {n} columns and rank {rank}: choose {wanted} independent columns, not {len(given)}")
