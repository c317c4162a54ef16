"""The search for fewer operations: other plans, each tried in a graph of its own, factored and counted exactly."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from nullbody.expr import Expr, Graph, factored, operations
from nullbody.expr.transplant import transplant
from nullbody.nullspace.plan import Plan
from nullbody.nullspace.steps import Sparse
from nullbody.nullspace.symbolic import Rows

__all__ = ["cheapest"]

#: A basis is factored if fewer than so many that were factored before it took fewer operations.
_AMONG = 4


def cheapest(
    rows: Sequence[Sparse], basis: Callable[[Sequence[Sparse], Plan], Rows], plan: Plan, trials: int
) -> tuple[Plan, Rows]:
    """The plan whose basis takes the fewest operations after factoring, and that basis in the graph of the rows.

    Args:
        rows: independent rows of A, expressions of one graph among them.
        basis: makes the basis of such rows by a plan.
        plan: the first one.
        trials: how many random ones to try beside it; trial k is the same in every search, and more trials never
            end with more operations.
    """
    graph = next(entry.graph for row in rows for entry in row.values() if isinstance(entry, Expr))
    counts: dict[Any, int] = {}
    tried: list[tuple[int, Plan, Rows, list[Expr]]] = []
    for candidate in (plan, *(Plan.random(seed, plan) for seed in range(trials))):
        scratch = graph.copy()
        found = basis(_copied(rows, scratch), candidate)
        entries = _expressions(found)
        program = tuple(scratch.code[node] for node in scratch.reachable(entry.ref for entry in entries))
        count = operations(entries).arithmetic
        if program in counts or sum(other < count for other in counts.values()) >= _AMONG:
            continue
        counts[program] = count
        for written in (entries, factored(entries)):
            # counted where it will stand: what A itself has in another form keeps that
            standing = operations(transplant(written, graph.copy())).arithmetic
            tried.append((standing, candidate, found, written))
    _, chosen, found, written = min(tried, key=lambda trial: trial[0])
    moved = iter(transplant(written, graph))
    return chosen, tuple(tuple(next(moved) if isinstance(entry, Expr) else entry for entry in row) for row in found)


def _expressions(rows: Rows) -> list[Expr]:
    return [entry for row in rows for entry in row if isinstance(entry, Expr)]


def _copied(rows: Sequence[Sparse], graph: Graph) -> list[Sparse]:
    """The rows in a graph of their own: a node of equal value in theirs would be taken for free."""
    return [{j: Expr(graph, e.ref) if isinstance(e, Expr) else e for j, e in row.items()} for row in rows]
