"""The atlas of a null space: its charts, sorted by what they cost or by how good they are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from nullbody.errors import InputError, SingularityError, UnknownName
from nullbody.expr import Operations
from nullbody.nullspace.given import checked_columns
from nullbody.tolerances import EPS

__all__ = ["Atlas", "By", "Chart"]

#: What charts are sorted by: operations of N, operations of N~, or the largest singular value of N.
By = Literal["operations", "scaled_operations", "condition"]


@dataclass(frozen=True, repr=False)
class Chart:
    """A choice of independent columns.

    Attributes:
        independent: the columns that stay free, increasing.
        singular: |B| is identically zero; for an array, zero to rounding.
        operations: what N takes; None for numbers, and where the chart is singular.
        scaled_operations: what N~ = |B| N takes, likewise.
        condition: the largest singular value of N at the point or, of several points, at the worst one; infinite where
            |B| = 0 to rounding there, that is beyond 1 / (n eps).
    """

    independent: tuple[int, ...]
    singular: bool
    operations: Operations | None
    scaled_operations: Operations | None
    condition: float

    @property
    def subspace_error(self) -> float:
        """About eps * condition: the angle [rad] by which rounding turns the subspace where N is taken in doubles."""
        return EPS * self.condition

    def __repr__(self) -> str:
        if self.singular:
            return f"<Chart {self.independent}: singular>"
        cost = "" if self.operations is None else f"{self.operations} operations, "
        return f"<Chart {self.independent}: {cost}condition {self.condition:.3g}>"


@dataclass(frozen=True, repr=False)
class Atlas:
    """Charts of one matrix, in the order of their columns; `atlas[0, 2, 7]` is one, in any order of its columns.

    Attributes:
        charts: all of them, singular ones too.
        columns: how many columns A has.
    """

    charts: tuple[Chart, ...]
    columns: int

    def __len__(self) -> int:
        return len(self.charts)

    def __iter__(self) -> Iterator[Chart]:
        return iter(self.charts)

    def __getitem__(self, independent: int | Sequence[int]) -> Chart:
        """The chart of these independent columns.

        Raises:
            InputError: there is none, or these are no columns.
        """
        chosen = checked_columns(
            [independent] if isinstance(independent, int) else independent, self.columns, "a chart's"
        )
        chart = self._by_columns.get(frozenset(chosen))
        if chart is None or len(chosen) != len(chart.independent):
            raise InputError(f"there is no chart with the independent columns {list(chosen)} in {self!r}")
        return chart

    @cached_property
    def _by_columns(self) -> dict[frozenset[int], Chart]:
        return {frozenset(chart.independent): chart for chart in self.charts}

    @property
    def regular(self) -> tuple[Chart, ...]:
        """The charts with |B| not identically zero."""
        return tuple(chart for chart in self.charts if not chart.singular)

    @property
    def singular(self) -> tuple[Chart, ...]:
        """The charts with |B| identically zero: no choice anywhere."""
        return tuple(chart for chart in self.charts if chart.singular)

    def best(self, by: By | None = None) -> Chart:
        """The chart with the fewest operations for N or N~, or with the smallest condition.

        Args:
            by: what counts first; by default operations, for numbers condition. The other one decides ties.

        Raises:
            SingularityError: all charts are singular.
            InputError: numbers have no operations.
        """
        ranked = self.ranked(by)
        if not ranked:
            raise SingularityError(f"all {len(self)} charts are singular: allow more columns to be independent")
        return ranked[0]

    def ranked(self, by: By | None = None) -> list[Chart]:
        """The regular charts, the best one first; argument and errors as `best`."""
        regular = self.regular
        counted = all(chart.operations is not None for chart in regular)
        if by is None:
            by = "operations" if counted else "condition"
        if by not in ("operations", "scaled_operations", "condition"):
            raise UnknownName("order of charts", by, ("operations", "scaled_operations", "condition"))
        if by != "condition" and not counted:
            raise InputError("numbers take no operations; order their charts by 'condition'")
        return sorted(regular, key=lambda chart: _figures(chart, by))

    def table(self, k: int = 10, by: By | None = None) -> str:
        """The k best charts as text, one line each; arguments and errors as `best`.

        Raises:
            InputError: k is no whole number, 0 or more.
        """
        if type(k) is not int or k < 0:
            raise InputError(f"k is a number of charts, 0 or more, not {k!r}")
        ranked = self.ranked(by)[:k]
        width = max([len(str(chart.independent)) for chart in ranked], default=0)
        width = max(width, len("independent"))
        lines = [f"{'independent':<{width}}  {'N':>6}  {'N~':>6}  {'condition':>9}  {'subspace error':>14}"]
        for chart in ranked:
            counts = [
                "-" if count is None else str(count.arithmetic) for count in (chart.operations, chart.scaled_operations)
            ]
            figures = f"{chart.condition:>9.3g}  {chart.subspace_error:>14.1e}"
            lines.append(f"{chart.independent!s:<{width}}  {counts[0]:>6}  {counts[1]:>6}  {figures}")
        return "\n".join(lines)

    def __repr__(self) -> str:
        size = len(self.charts[0].independent)
        text = f"{len(self)} charts of {size} columns in {self.columns}, {len(self.singular)} identically singular"
        if not self.regular:
            return f"<Atlas of {text}>"
        best = self.best("condition")
        text += f"; best conditioned {best.independent}: {best.condition:.3g}"
        if best.operations is not None:
            cheapest = self.best("operations")
            count = cheapest.operations.arithmetic if cheapest.operations else 0
            text += f"; cheapest {cheapest.independent}: {count} operations"
        return f"<Atlas of {text}>"


def _figures(chart: Chart, by: By) -> tuple[float, float, tuple[int, ...]]:
    count = chart.scaled_operations if by == "scaled_operations" else chart.operations
    cost = float(count.arithmetic) if count is not None else 0.0
    condition = float(f"{chart.condition:.9g}")  # what is equal but for rounding counts as equal
    pair = (condition, cost) if by == "condition" else (cost, condition)
    return (*pair, chart.independent)
