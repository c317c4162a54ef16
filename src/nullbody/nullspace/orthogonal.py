"""The paper's orthogonal basis of the null space [14-18], by its own procedure: the reference for `gram`.

Take the first column N_1 of a null space of A, append N_1^T to A as a row, and repeat: each new column is
orthogonal to all before it. A N^ = 0 and N^^T N^ = D is diagonal.

Every appended row is dense, and so are the determinants from then on. The Gram matrix gives the same columns for about
half the operations: `gram.orthogonal`, and `gram.paper_scaled` in the scaling of [13].
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from nullbody.errors import InputError
from nullbody.nullspace.call import null_space
from nullbody.nullspace.given import scalar_rows

__all__ = ["orthogonal_basis"]

_WHAT = "orthogonal_basis takes one dense matrix: rows of scalars, an array (m, n) or a SymPy matrix"


def orthogonal_basis(
    A: Any, independent: Sequence[int] | None = None, *, scaled: bool = False, method: str = "minors"
) -> tuple[tuple[Any, ...], ...]:
    """N^, n x d, with A N^ = 0 and N^^T N^ diagonal.

    q' = N^ u, where u are quasi-velocities: combinations of the independent velocities.

    Args:
        A: the constraint Jacobian, m x n: one matrix of any kind but sparse.
        independent: the free columns, in the order in which they enter.
        scaled: take each column from the division-free null space, as [13] does.
        method: of `null_space`; the paper's is "minors", for blocks up to 14.

    Returns:
        Rows of scalars of A's kind.

    Raises:
        InputError, SingularityError: as `null_space`; A is a stack of matrices, or sparse.
    """
    if getattr(A, "ndim", 2) != 2 or hasattr(A, "tocsr"):
        raise InputError(_WHAT)
    rows = scalar_rows(A, _WHAT)
    first = null_space(rows or A, independent, method=method)
    rows = [rows[i] for i in first.rows] or [[0] * first.shape[0]]
    free = list(first.independent)
    columns: list[list[Any]] = []
    while free:
        basis = null_space(rows, free, "scaled" if scaled else "reduced", method).basis
        columns.append([row[0] for row in scalar_rows(basis, _WHAT)])
        rows.append(columns[-1])
        free.pop(0)
    return tuple(zip(*columns, strict=True))
