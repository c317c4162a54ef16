"""Sparse null spaces: every column of N is a small set of dependent columns of A (m x n of rank m).

Columns count as dependent where the remainder of a projection is less than `_ROUNDING` of their length.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from nullbody.typing import FloatArray

__all__ = ["fundamental", "triangular", "turnback"]

_ROUNDING = 1e-11

Filled = np.ndarray[tuple[int, ...], np.dtype[np.bool_]]  # where entries are not 0


def turnback(A: FloatArray) -> FloatArray:
    """For every column that depends on those left of it, the shortest run of columns to its left that it depends on.

    Banded where A is. The last non-zero entries stand in different rows, so that the vectors are independent.

    Topcu (1979); M. W. Berry, M. T. Heath, I. Kaneko, M. Lawo, R. J. Plemmons, R. C. Ward: An algorithm to compute a
    sparse basis of the null space. Numerische Mathematik 47 (1985) 483-504.
    """
    starts = sorted(set(range(A.shape[1])) - set(_independent(A, range(A.shape[1]))))
    return np.column_stack([_circuit(A, j, range(j - 1, -1, -1)) for j in starts])


def fundamental(A: FloatArray) -> FloatArray:
    """Variable reduction with sparse columns in B, each null vector from what alternating paths of a matching reach.

    With a perfect matching of B's rows and columns, column j of C needs those columns of B only that its rows lead
    to: row -> matched column -> rows of that column, and so on. Columns enter B from the sparsest on, where they are
    numerically independent of those before.

    T. F. Coleman, A. Pothen: The null space problem II. Algorithms. SIAM J. Algebraic and Discrete Methods 8 (1987)
    544-563; the numerical test as in J. R. Gilbert, M. T. Heath: Computing a sparse basis for the null space (same
    journal, 1987, 446-459).
    """
    filled = A != 0
    order = sorted(range(A.shape[1]), key=lambda j: int(filled[:, j].sum()))
    basic = sorted(_independent(A, order))
    match = _matching(filled[:, basic])
    vectors = []
    for j in sorted(set(range(A.shape[1])) - set(basic)):
        rows: set[int] = set()
        front = np.flatnonzero(filled[:, j]).tolist()
        while front:
            row = front.pop()
            if row not in rows:
                rows.add(row)
                front += np.flatnonzero(filled[:, basic[match[row]]]).tolist()
        used = sorted(rows)
        columns = [basic[match[row]] for row in used]
        vectors.append(_vector(A, j, columns, np.linalg.solve(A[np.ix_(used, columns)], -A[used, j])))
    return np.column_stack(vectors)


def triangular(A: FloatArray) -> FloatArray:
    """Locally greedy: take the sparsest dependent set, leave out its start column, repeat: N holds a triangle.

    Each column looks for dependence on columns that are near to it (fewest steps column - row - column first).

    T. F. Coleman, A. Pothen (1987), the triangular basis; the order of search stands for their matching.
    """
    alive = set(range(A.shape[1]))
    near = {j: _by_distance(A != 0, j) for j in alive}
    known: dict[int, FloatArray] = {}
    vectors: list[FloatArray] = []
    for _ in range(A.shape[1] - len(A)):
        for j in alive - set(known):
            known[j] = _circuit(A, j, (k for k in near[j] if k in alive))
        start = min(known, key=lambda j: int(np.count_nonzero(known[j])) or A.shape[1] + 1)
        vectors.append(known[start])
        alive.discard(start)
        known = {j: vector for j, vector in known.items() if j != start and vector[start] == 0}
    return np.column_stack(vectors)


def _independent(A: FloatArray, order: Iterable[int]) -> list[int]:
    """The columns, in this order, that do not depend on those before them."""
    Q, found = np.empty((len(A), 0)), []
    for j in order:
        rest = _remainder(Q, A[:, j])
        if np.linalg.norm(rest) > _ROUNDING * np.linalg.norm(A[:, j]):
            Q = np.column_stack([Q, rest / np.linalg.norm(rest)])
            found.append(j)
    return found


def _remainder(Q: FloatArray, x: FloatArray) -> FloatArray:
    """x without its part in the span of Q's orthonormal columns; projected twice, which is enough."""
    rest = x - Q @ (Q.T @ x)
    again: FloatArray = rest - Q @ (Q.T @ rest)
    return again


def _circuit(A: FloatArray, j: int, order: Iterable[int]) -> FloatArray:
    """The null vector of column j and the first columns, in this order, that it depends on; zeros where there is none.

    Columns that depend on those taken before them are left out.
    """
    size = np.linalg.norm(A[:, j])
    Q, taken, rest = np.empty((len(A), 0)), [], A[:, j]
    for k in order:
        if np.linalg.norm(rest) <= _ROUNDING * size:
            break
        new = _remainder(Q, A[:, k])
        if np.linalg.norm(new) > _ROUNDING * np.linalg.norm(A[:, k]):
            Q = np.column_stack([Q, new / np.linalg.norm(new)])
            taken.append(k)
            rest = _remainder(Q, A[:, j])
    if np.linalg.norm(rest) > _ROUNDING * size:
        return np.zeros(A.shape[1])
    return _vector(A, j, taken, np.linalg.lstsq(A[:, taken], -A[:, j], rcond=None)[0] if taken else np.empty(0))


def _vector(A: FloatArray, j: int, columns: Sequence[int], values: Any) -> FloatArray:
    """1 in place j, the values in those of the columns, exact zeros where they add nothing but rounding."""
    vector = np.zeros(A.shape[1])
    vector[j] = 1
    weights = np.linalg.norm(A[:, columns], axis=0) * np.abs(values)
    vector[columns] = np.where(weights > _ROUNDING * np.linalg.norm(A[:, j]), values, 0)
    return vector


def _matching(filled: Filled) -> list[int]:
    """For every row of a regular square matrix the column that is matched with it."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_bipartite_matching

    matched = maximum_bipartite_matching(csr_array(filled), perm_type="column")
    return [int(column) for column in matched]


def _by_distance(filled: Filled, start: int) -> list[int]:
    """The other columns by their distance in the graph of rows and columns, near ones and sparse ones first."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import breadth_first_order, shortest_path

    near = csr_array((filled.T.astype(int) @ filled.astype(int)) > 0)
    reached = breadth_first_order(near, start, directed=False, return_predecessors=False)
    steps = shortest_path(near, unweighted=True, indices=start)
    return sorted((int(j) for j in reached if j != start), key=lambda j: (steps[j], int(filled[:, j].sum()), -j))
