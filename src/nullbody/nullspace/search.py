"""The search for fewer operations: other plans, each tried in a graph of its own and counted exactly."""

from __future__ import annotations

from collections.abc import Sequence

from nullbody.expr import Expr, Graph, operations
from nullbody.nullspace.elimination import eliminate
from nullbody.nullspace.plan import Plan
from nullbody.nullspace.result import Form
from nullbody.nullspace.scalar import is_zero
from nullbody.nullspace.steps import Sparse

__all__ = ["cheapest_plan"]


def cheapest_plan(
    rows: Sequence[Sparse],
    independent: Sequence[int],
    dependent: Sequence[int],
    form: Form,
    plan: Plan,
    trials: int,
) -> Plan:
    """The plan with the fewest operations for N, or N~ for the form "scaled": the given one or a random one.

    Args:
        rows: independent rows of A.
        independent, dependent: columns of A.
        form: what is counted; the orthogonal forms count N.
        plan: the first one.
        trials: how many others; trial k is the same in every search.
    """
    candidates = [plan, *(Plan.random(seed, plan) for seed in range(trials))]
    counts = [_count(_copied(rows), independent, dependent, form == "scaled", candidate) for candidate in candidates]
    return candidates[min(range(len(counts)), key=counts.__getitem__)]


def _count(rows: list[Sparse], independent: Sequence[int], dependent: Sequence[int], scaled: bool, plan: Plan) -> float:
    factors = eliminate(rows, dependent, plan)
    if is_zero(factors.delta):
        return float("inf")
    solve = factors.solve_column_scaled if scaled else factors.solve_column
    entries = [entry for j in independent for entry in solve(j)]
    entries += [factors.delta] if scaled else []
    return operations([entry for entry in entries if isinstance(entry, Expr)]).arithmetic


def _copied(rows: Sequence[Sparse]) -> list[Sparse]:
    """The rows in a graph of their own: a node of equal value in theirs would be taken for free."""
    graph: Graph | None = None
    copied: list[Sparse] = []
    for row in rows:
        copied.append(dict(row))
        for j, entry in row.items():
            if isinstance(entry, Expr):
                graph = graph or entry.graph.copy()
                copied[-1][j] = Expr(graph, entry.ref)
    return copied
