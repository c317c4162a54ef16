"""The elimination once more, with symbols for the entries of A: the operations that lead to N, written out.

The pivots are those of the numbers that A had; they were not small there.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from nullbody.expr import Expr, Graph
from nullbody.nullspace.sparse.factor import Factors
from nullbody.typing import IndexArray

__all__ = ["replayed"]

_Row = dict[int, Expr]


def replayed(places: IndexArray, factors: Factors, most: int) -> tuple[list[str], list[tuple[int, int, Expr]]] | None:
    """Names of symbols for the stored entries of A, and the entries (i, k, N_ik) of N's dependent rows.

    Args:
        places: i n + j of each stored entry.
        factors: say which pivots, in which order.
        most: operations after which it is given up.

    Returns:
        None where it was given up.
    """
    n, graph = factors.shape[1], Graph()
    names = [f"a{k}" for k in range(len(places))]
    rows: dict[int, _Row] = {i: {} for i in factors.rows.tolist()}
    for place, name in zip(places.tolist(), names, strict=True):
        if place // n in rows:
            rows[place // n][place % n] = graph.symbol(name)
    limit = len(graph) + most
    pivots = _pivots(factors)
    inverses: list[Expr] = []
    where: dict[int, set[int]] = {}
    for i, row in rows.items():
        for j in row:
            where.setdefault(j, set()).add(i)
    for i, j in pivots:
        row = rows[i]
        inverses.append(1 / row[j])
        for c in row:
            where[c].discard(i)
        for other in sorted(where[j]):
            _subtract(rows[other], row, j, inverses[-1], where, other)
        if len(graph) > limit:
            return None
    basis: dict[int, _Row] = {j: {k: graph.constant(1)} for k, j in enumerate(factors.independent.tolist())}
    for (i, j), inverse in zip(reversed(pivots), reversed(inverses), strict=True):
        basis[j] = _solved(rows[i], j, inverse, basis)
        if len(graph) > limit:
            return None
    return names, [(j, k, entry) for _, j in pivots for k, entry in basis[j].items()]


def _pivots(factors: Factors) -> list[tuple[int, int]]:
    """Row and column of every pivot, in order; the dense core exchanged rows in its turn."""
    rows, columns = factors.order
    _, swaps = factors.core.factors
    first = len(rows) - len(swaps)
    for k, other in enumerate(np.asarray(swaps) + first):
        rows[[first + k, other]] = rows[[other, first + k]]
    return list(zip(rows.tolist(), columns.tolist(), strict=True))


def _subtract(target: _Row, row: _Row, j: int, inverse: Expr, where: dict[int, set[int]], number: int) -> None:
    """target -= target[j] / pivot * row, which removes its entry in column j."""
    factor = target.pop(j) * inverse
    where[j].discard(number)
    for c, entry in row.items():
        if c == j:
            continue
        if c in target:
            target[c] = target[c] - factor * entry
        else:
            target[c] = -(factor * entry)
            where[c].add(number)


def _solved(row: _Row, j: int, inverse: Expr, basis: dict[int, _Row]) -> _Row:
    """The row of N in place j: minus the rest of the pivot's row times those of N, over the pivot."""
    total: dict[int, Any] = {}
    for c, entry in row.items():
        if c == j:
            continue
        for k, known in basis[c].items():
            product = entry * known
            total[k] = total[k] + product if k in total else product
    return {k: -(entry * inverse) for k, entry in total.items()}
