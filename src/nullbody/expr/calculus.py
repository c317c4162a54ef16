"""Exact derivatives and substitution on the graph (forward mode)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from nullbody.errors import InputError
from nullbody.expr.expression import Expr
from nullbody.expr.graph import ONE, ZERO, Graph

__all__ = ["derivative", "directional", "jacobian", "substitute"]


def directional(functions: Sequence[Expr], seeds: Mapping[Expr, Expr]) -> list[Expr]:
    """Directional derivatives sum_k (df/dx_k) s_k of each function f, for seeds {x_k: s_k}.

    With x = q and s = q' this is the time derivative along a motion.
    """
    if not functions:
        return []
    graph = functions[0].graph
    mask = _symbols(graph, seeds)
    tangent = {x.ref >> 1: s.ref for x, s in seeds.items()}
    for node in graph.reachable(f.ref for f in functions if graph.depends[f.ref >> 1] & mask):
        if node not in tangent:
            tangent[node] = _tangent(graph, node, tangent) if graph.depends[node] & mask else ZERO
    return [Expr(graph, _signed(graph, tangent.get(f.ref >> 1, ZERO), f.ref)) for f in functions]


def derivative(function: Expr, symbol: Expr) -> Expr:
    """df/dx."""
    return directional([function], {symbol: Expr(symbol.graph, ONE)})[0]


def jacobian(functions: Sequence[Expr], symbols: Sequence[Expr]) -> list[list[Expr]]:
    """The matrix df_i/dx_j, a row for each function."""
    columns = [directional(functions, {x: Expr(x.graph, ONE)}) for x in symbols]
    return [[column[i] for column in columns] for i in range(len(functions))]


def substitute(functions: Sequence[Expr], values: Mapping[Expr, Expr]) -> list[Expr]:
    """The functions with each symbol x replaced by values[x]."""
    if not functions:
        return []
    graph = functions[0].graph
    mask = _symbols(graph, values)
    image = {x.ref >> 1: g.ref for x, g in values.items()}
    for node in graph.reachable(f.ref for f in functions):
        if node not in image:
            image[node] = _rebuilt(graph, node, image) if graph.depends[node] & mask else 2 * node
    return [Expr(graph, _signed(graph, image[f.ref >> 1], f.ref)) for f in functions]


def _symbols(graph: Graph, values: Mapping[Expr, Expr]) -> int:
    """The keys as a set of symbols, a bit mask like `graph.depends`.

    Raises:
        InputError: a key is no symbol, or something belongs to another graph.
    """
    mask = 0
    for x, g in values.items():
        if x.graph is not graph or g.graph is not graph:
            raise InputError("two expressions of different graphs cannot be combined")
        if x.name is None:
            raise InputError(f"expected a symbol, not {x!r}")
        mask |= graph.depends[x.ref >> 1]
    return mask


def _signed(graph: Graph, ref: int, like: int) -> int:
    return graph.negate(ref) if like & 1 else ref


def _tangent(graph: Graph, node: int, tangent: dict[int, int]) -> int:
    op, a, b = graph.code[node]
    if op == "symbol":
        return ZERO
    da = _signed(graph, tangent[a >> 1], a)
    if op in ("add", "sub"):
        db = _signed(graph, tangent[b >> 1], b)
        return graph.add(da, db if op == "add" else graph.negate(db))
    if op == "mul":
        db = _signed(graph, tangent[b >> 1], b)
        return graph.add(graph.multiply(da, b), graph.multiply(a, db))
    if op == "sin":
        return graph.multiply(graph.cosine(a), da)
    if op == "cos":
        return graph.negate(graph.multiply(graph.sine(a), da))
    itself = 2 * node
    if op == "inv":
        return graph.negate(graph.multiply(graph.multiply(itself, itself), da))
    half = graph.invert(graph.add(itself, itself))  # op == "sqrt": d sqrt(a) = da / (2 sqrt(a))
    return graph.multiply(half, da)


def _rebuilt(graph: Graph, node: int, image: dict[int, int]) -> int:
    op, a, b = graph.code[node]
    right = _signed(graph, image[b >> 1], b) if op in ("add", "sub", "mul") else ZERO
    return graph.operate(op, _signed(graph, image[a >> 1], a), right)
