"""Row operations: what was done to the rows of B has to be done to every right-hand side.

Shear   row i becomes  row i - f row s          |B| stays
Scale   row i becomes  f row i, f a constant    |B| becomes f |B|
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from nullbody.expr.matrix import total
from nullbody.nullspace.scalar import is_zero

__all__ = ["Scale", "Shear", "Sparse", "Step", "combined", "dense_rows", "forward", "sparse_rows", "transposed"]

#: A row, or a right-hand side: its non-zero entries by place.
Sparse = dict[int, Any]


class Shear(NamedTuple):
    """Row `row` minus `factor` times row `source`."""

    row: int
    source: int
    factor: Any

    def moved(self, places: Sequence[int]) -> Shear:
        """The same step where row k stands at places[k]."""
        return Shear(places[self.row], places[self.source], self.factor)


class Scale(NamedTuple):
    """Row `row` times `factor`, a constant that is not zero."""

    row: int
    factor: Any

    def moved(self, places: Sequence[int]) -> Scale:
        """The same step where row k stands at places[k]."""
        return Scale(places[self.row], self.factor)


Step = Shear | Scale


def sparse_rows(matrix: Iterable[Sequence[Any]]) -> list[Sparse]:
    """The rows of a matrix without their zeros."""
    return [{j: entry for j, entry in enumerate(row) if not is_zero(entry)} for row in matrix]


def dense_rows(rows: Iterable[Sparse], columns: int, zero: Any = 0) -> tuple[tuple[Any, ...], ...]:
    """Rows with a zero in every empty place."""
    return tuple(tuple(row.get(j, zero) for j in range(columns)) for row in rows)


def combined(*terms: tuple[Any, Any]) -> Any:
    """The sum of the products; factors that are zero cost nothing."""
    return total(a * b for a, b in terms if not (is_zero(a) or is_zero(b)))


def forward(steps: Iterable[Step], right: Sparse) -> None:
    """Take a right-hand side through the steps, in place."""
    for step in steps:
        if isinstance(step, Scale):
            if step.row in right:
                right[step.row] = step.factor * right[step.row]
        elif step.source in right:
            _store(right, step.row, total((right.get(step.row, 0), -(step.factor * right[step.source]))))


def transposed(steps: Iterable[Step], left: Sparse) -> None:
    """Take a left-hand factor back through the steps, last step first, in place: y^T (E B) = (E^T y)^T B."""
    for step in reversed(list(steps)):
        if step.row not in left:
            continue
        if isinstance(step, Scale):
            left[step.row] = step.factor * left[step.row]
        else:
            _store(left, step.source, total((left.get(step.source, 0), -(step.factor * left[step.row]))))


def _store(vector: Sparse, place: int, value: Any) -> None:
    if is_zero(value):
        vector.pop(place, None)
    else:
        vector[place] = value
