"""Expressions written anew in another graph, where nothing that was made before has a say in their form."""

from __future__ import annotations

from collections.abc import Sequence

from nullbody.expr.expression import Expr
from nullbody.expr.graph import Graph

__all__ = ["transplant"]


def transplant(expressions: Sequence[Expr], graph: Graph) -> list[Expr]:
    """The same expressions in another graph; their symbols keep their names.

    Args:
        expressions: expressions of one graph.
        graph: where they are written. In one with another seed they meet another random point, which confirms
            (or refutes) what was seen by value at the first.
    """
    if not expressions:
        return []
    source = expressions[0].graph
    image: dict[int, int] = {}

    def moved(ref: int) -> int:
        return graph.negate(image[ref >> 1]) if ref & 1 else image[ref >> 1]

    for node in source.reachable(f.ref for f in expressions):
        op, a, _ = source.code[node]
        if op == "symbol":
            image[node] = graph.symbol(source.symbols[a]).ref
        elif op == "const":
            image[node] = graph.constant_ref(source.constants[a])
        else:
            image[node] = graph.operate(op, *map(moved, source.operands(node)))
    return [Expr(graph, moved(f.ref)) for f in expressions]
