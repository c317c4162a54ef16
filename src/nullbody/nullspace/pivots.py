"""Elimination by pivots: constants that can be divided by everywhere, and, where a block is large, expressions.

A pivot's row is set aside for back substitution, its column is cleared from the other rows. The pivot that makes the
fewest new operations goes first (Markowitz 1957).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from nullbody.expr import Expr
from nullbody.expr.matrix import dot, total
from nullbody.nullspace.scalar import is_constant, is_unit, reciprocal
from nullbody.nullspace.steps import Shear, Sparse

__all__ = ["Pivot", "eliminated"]

_SMALL = 0.1  # of the largest entry of its column: a pivot that is at least so large at all points is good
_FAIR = 0.5  # where none is: of the best there is
_NOTHING = 1e-300


@dataclass(frozen=True)
class Pivot:
    """A pivot of B: a stage of the solution with one unknown.

    Attributes:
        rows, columns: where it stands.
        value: the pivot.
        rivals: the entries of its column that it was chosen from; none for a constant.
    """

    rows: tuple[int]
    columns: tuple[int]
    value: Any
    rivals: tuple[Any, ...]

    @cached_property
    def inverse(self) -> Any:
        """1 / pivot"""
        return reciprocal(self.value)

    def solved(self, y: Sparse) -> Sparse:
        """The unknown, by column."""
        return {self.columns[0]: y[self.rows[0]] * self.inverse}

    @property
    def doubt(self) -> Any:
        """(length of the rivals / pivot)^2; 0 for a constant, which cannot be doubted."""
        return dot(self.rivals, self.rivals) * (self.inverse * self.inverse) if self.rivals else 0

    @property
    def plain(self) -> bool:
        """Whether dividing by it costs and risks nothing."""
        return is_constant(self.value)

    def scaled(self, y: Sparse) -> Sparse:
        """The unknown times the pivot, by column."""
        return {self.columns[0]: y[self.rows[0]]}

    def scaled_transposed(self, y: Sparse) -> Sparse:
        """The same of the transposed system, by row."""
        return {self.rows[0]: y[self.columns[0]]} if y else {}


def eliminated(
    rows: list[Sparse],
    active: Iterable[int],
    columns: Iterable[int],
    tie: Callable[[], float],
    *,
    constants: bool,
    sizes: Callable[[Any], Any] | None = None,
) -> tuple[list[Pivot], list[Shear]]:
    """Eliminate in some rows and columns as long as there are pivots; `rows` is changed.

    Args:
        rows: the rows of B, by column.
        active: the rows to work on.
        columns: the columns in which pivots are looked for.
        tie: decides between pivots of equal cost: the smaller number wins.
        constants: whether only constants may be pivots.
        sizes: absolute values of an entry at points that matter, an array; None takes any expression as a pivot.
    """
    work = _Work(rows, set(active), set(columns), (tie, constants, sizes))
    pivots: list[Pivot] = []
    steps: list[Shear] = []
    while (place := work.cheapest()) is not None:
        pivot, made = work.clear(*place)
        pivots.append(pivot)
        steps += made
    return pivots, steps


class _Work:
    """The rows that are left, and where their columns have entries."""

    def __init__(
        self,
        rows: list[Sparse],
        active: set[int],
        columns: set[int],
        rules: tuple[Callable[[], float], bool, Callable[[Any], Any] | None],
    ) -> None:
        self.rows = rows
        self.active = active
        self.tie, self.constants, self.sizes = rules
        self.rows_of: dict[int, set[int]] = {j: set() for j in sorted(columns)}  # column -> rows with an entry there
        for i in sorted(active):
            for j in rows[i]:
                if j in self.rows_of:
                    self.rows_of[j].add(i)
        self.best: dict[int, tuple[float, float, int, int]] = {}  # column -> (cost, tie, column, row) of its best pivot
        self.changed = set(self.rows_of)  # columns whose best pivot has to be found anew

    def cheapest(self) -> tuple[int, int] | None:
        """(row, column) of the pivot that makes the fewest operations, or None."""
        for j in sorted(self.changed & self.rows_of.keys()):
            costs = [(self._cost(i, j), self.tie(), j, i) for i in self._allowed(j)]
            self.best.pop(j, None)
            if costs:
                self.best[j] = min(costs)
        self.changed.clear()
        _, _, j, i = min(self.best.values(), default=(0.0, 0.0, -1, -1))
        return None if i < 0 else (i, j)

    def _allowed(self, j: int) -> list[int]:
        """Rows of a column that may give its pivot: at every point large against the others, if there are such."""
        members = sorted(self.rows_of[j])
        if self.constants:
            return [i for i in members if is_constant(self.rows[i][j])]
        if self.sizes is None or len(members) < 2:
            return members
        sizes = np.nan_to_num(np.array([self.sizes(self.rows[i][j]) for i in members]), nan=0.0, posinf=0.0)
        quality = np.min(sizes / np.maximum(sizes.max(axis=0), _NOTHING), axis=1)
        enough = min(_SMALL, _FAIR * float(quality.max()))
        return [i for i, found in zip(members, quality, strict=True) if found >= enough]

    def clear(self, i: int, j: int) -> tuple[Pivot, list[Shear]]:
        """Clear column j from the other rows with row i, which leaves the work."""
        value = self.rows[i][j]
        members = self.rows_of.pop(j)
        self.best.pop(j, None)
        rivals = () if is_constant(value) else tuple(self.rows[k][j] for k in sorted(members))
        pivot, steps = Pivot((i,), (j,), value, rivals), []
        for k in sorted(members - {i}):
            factor = self.rows[k].pop(j) * pivot.inverse
            steps.append(Shear(k, i, factor))
            self._subtract(k, i, j, factor)
        for k in members:
            self.changed.update(self.rows[k])
        self.active.remove(i)
        for c in self.rows[i]:
            if c in self.rows_of:
                self.rows_of[c].discard(i)
        return pivot, steps

    def _subtract(self, k: int, i: int, pivot: int, factor: Any) -> None:
        row = self.rows[k]
        for c, entry in self.rows[i].items():
            if c == pivot:
                continue
            value = total((row.get(c, 0), -(factor * entry)))
            if value == 0:
                row.pop(c, None)
            else:
                row[c] = value
            if c in self.rows_of:
                (self.rows_of[c].discard if value == 0 else self.rows_of[c].add)(k)

    def _cost(self, i: int, j: int) -> float:
        """Operations of this pivot; of plain numbers, the most entries that can fill in.

        A product or a sum counts 1. Factors of rows by a constant pivot count 0.2, those of 1 or -1 count 0.1: they
        decide between pivots that are as good otherwise.
        """
        row, members = self.rows[i], self.rows_of[j]
        pivot = row[j]
        if not isinstance(pivot, Expr):
            return (len(members) - 1) * (len(row) - 1)
        cost = 0.0 if is_constant(pivot) else 1.0
        for k in members:
            if k == i:
                continue
            plain = is_unit(self.rows[k][j]) and is_unit(pivot)
            cost += 0.1 if plain else 0.2 if is_constant(pivot) else 1.0
            for c, entry in row.items():
                if c != j:
                    cost += (c in self.rows[k]) + (0.0 if plain or is_unit(entry) else 1.0)
        return cost
