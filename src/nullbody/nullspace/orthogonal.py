"""The paper's orthogonal basis of the null space [14-18], by its own procedure.

Take the first column N_1 of a null space of A, append N_1^T to A as a row, and repeat: each new column is
orthogonal to all before it. A N^ = 0 and N^^T N^ = D is diagonal.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from nullbody.expr.matrix import Matrix
from nullbody.nullspace.basis import null_space

__all__ = ["orthogonal_basis"]


def orthogonal_basis(
    A: Matrix, independent: Sequence[int] | None = None, *, scaled: bool = False
) -> tuple[tuple[Any, ...], ...]:
    """N^, n x d, with A N^ = 0 and N^^T N^ diagonal.

    q' = N^ u, where u are quasi-velocities: combinations of the independent velocities.

    Args:
        A: the constraint Jacobian, m x n.
        independent: the free columns, in the order in which they enter.
        scaled: take each column from the division-free null space, as [13] does.

    Raises:
        InputError, SingularityError: as `null_space`.
    """
    rows: list[Sequence[Any]] = [list(row) for row in A]
    first = null_space(rows, independent)
    rows = [rows[i] for i in first.rows] or rows[:1]
    free = list(first.independent)
    columns: list[list[Any]] = []
    while free:
        space = null_space(rows, free)
        basis = space.scaled if scaled else space.basis
        columns.append([row[0] for row in basis])
        rows.append(columns[-1])
        free.pop(0)
    return tuple(zip(*columns, strict=True)) if columns else first.basis
