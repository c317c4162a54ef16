"""What values in a prime field cannot see: square roots of expressions.

There sqrt(f) is an independent number, for its sign would be arbitrary: that sqrt(f) sqrt(f g) = f sqrt(g) goes
unseen, and a row that repeats others by such an identity would count as independent. A matrix with such roots is
looked at in doubles too, at two generic points; the lower rank is the true one.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nullbody.expr import Expr
from nullbody.nullspace.rank import Echelon, sparse_echelon
from nullbody.nullspace.sample import generic_point, sampled
from nullbody.nullspace.steps import Sparse, dense_rows
from nullbody.typing import FloatArray

__all__ = ["generic_echelon", "has_roots"]

_DEPENDENT = 1e-9  # what is left of a row or column that depends on others, relative to its length


def generic_echelon(rows: Sequence[Sparse], columns: Sequence[int]) -> Echelon:
    """Echelon form by values in the field and, where there are roots of expressions, in doubles.

    Args:
        rows: rows of numbers or of expressions of one graph.
        columns: all columns, in the order in which pivots are looked for.
    """
    found = sparse_echelon(rows, columns)
    if not has_roots(rows):
        return found
    near = generic_point(next(e.graph for row in rows for e in row.values() if isinstance(e, Expr)).symbols)
    points = [near, {name: 1.0 + number for name, number in near.items()}]
    seen = [_real_echelon(values, columns) for values in sampled(dense_rows(rows, len(columns)), points)]
    real = max((form for form in seen if form is not None), key=lambda form: form.rank, default=found)
    return real if real.rank <= found.rank else found


def has_roots(rows: Sequence[Sparse]) -> bool:
    """Whether there are square roots of expressions."""
    expressions = [entry for row in rows for entry in row.values() if isinstance(entry, Expr)]
    if not expressions:
        return False
    graph = expressions[0].graph
    return any(graph.code[node][0] == "sqrt" for node in graph.reachable(entry.ref for entry in expressions))


def _real_echelon(values: FloatArray, columns: Sequence[int]) -> Echelon | None:
    """The first independent rows, and the first independent columns among them; None without real values."""
    if not np.isfinite(values).all():
        return None
    rows = _first_independent(values, range(len(values)))
    pivots = _first_independent(values[list(rows)].T, columns)
    redundant = tuple(i for i in range(len(values)) if i not in rows)
    return Echelon(rows, pivots, redundant) if len(rows) == len(pivots) else None


def _first_independent(vectors: FloatArray, order: Sequence[int]) -> tuple[int, ...]:
    """The vectors that do not depend on those before them, by orthogonal projection."""
    kept: list[int] = []
    basis = np.zeros((0, vectors.shape[1] if vectors.ndim == 2 else 0))
    for k in order:
        length = float(np.linalg.norm(vectors[k]))
        left = vectors[k]
        for _ in range(2):  # twice is enough
            left = left - basis.T @ (basis @ left)
        if length > 0 and float(np.linalg.norm(left)) > _DEPENDENT * length:
            kept.append(k)
            basis = np.vstack([basis, left / np.linalg.norm(left)])
    return tuple(kept)
