"""Exact derivatives and substitution on the graph: forward mode, and reverse mode for a gradient."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from nullbody.errors import InputError
from nullbody.expr.expression import Expr
from nullbody.expr.graph import ONE, ZERO, Graph

__all__ = ["derivative", "directional", "gradient", "jacobian", "substitute"]


def directional(functions: Sequence[Expr], seeds: Mapping[Expr, Expr]) -> list[Expr]:
    """Directional derivatives sum_k (df/dx_k) s_k of each function f, for seeds {x_k: s_k}.

    With x = q and s = q' this is the time derivative along a motion.
    """
    if not functions:
        return []
    graph = functions[0].graph
    mask = _symbols(graph, seeds)
    nodes = graph.reachable(f.ref for f in functions if graph.depends[f.ref >> 1] & mask)
    return _tangents(functions, nodes, seeds, mask)


def derivative(function: Expr, symbol: Expr) -> Expr:
    """df/dx."""
    return directional([function], {symbol: Expr(symbol.graph, ONE)})[0]


def jacobian(functions: Sequence[Expr], symbols: Sequence[Expr]) -> list[list[Expr]]:
    """The matrix df_i/dx_j, a row for each function: one pass for each x over what depends on it."""
    if not functions:
        return []
    graph = functions[0].graph
    mask = _symbols(graph, dict.fromkeys(symbols, functions[0]))
    nodes = graph.reachable(f.ref for f in functions if graph.depends[f.ref >> 1] & mask)
    columns = []
    for x in symbols:
        own = graph.depends[x.ref >> 1]
        moving = [node for node in nodes if graph.depends[node] & own]
        columns.append(_tangents(functions, moving, {x: Expr(graph, ONE)}, own))
    return [[column[i] for column in columns] for i in range(len(functions))]


def gradient(function: Expr, symbols: Sequence[Expr]) -> list[Expr]:
    """df/dx_j of one function for all symbols in one pass backwards, at most about four times the operations of f.

    For a few functions of many symbols; where functions share their sub-expressions, as those of a mechanism do, a
    `jacobian` takes fewer operations from about three functions on.
    """
    graph = function.graph
    mask = _symbols(graph, dict.fromkeys(symbols, function))
    adjoint = {function.ref >> 1: ONE ^ function.ref & 1}
    for node in reversed(graph.reachable([function.ref] if graph.depends[function.ref >> 1] & mask else [])):
        weight = adjoint.get(node, ZERO)
        if weight != ZERO and graph.depends[node] & mask:
            for ref, share in _shares(graph, node, weight):
                if graph.depends[ref >> 1] & mask:
                    adjoint[ref >> 1] = graph.add(adjoint.get(ref >> 1, ZERO), _signed(graph, share, ref))
    return [Expr(graph, adjoint.get(x.ref >> 1, ZERO)) for x in symbols]


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


def _tangents(functions: Sequence[Expr], nodes: Sequence[int], seeds: Mapping[Expr, Expr], mask: int) -> list[Expr]:
    """Forward mode over some nodes in their order; those left out have no tangent."""
    graph = functions[0].graph
    tangent = {x.ref >> 1: s.ref for x, s in seeds.items()}
    for node in nodes:
        if graph.depends[node] & mask and node not in tangent:
            tangent[node] = _tangent(graph, node, tangent)
    return [Expr(graph, _signed(graph, tangent.get(f.ref >> 1, ZERO), f.ref)) for f in functions]


def _tangent(graph: Graph, node: int, tangent: dict[int, int]) -> int:
    op, a, b = graph.code[node]
    if op == "symbol":
        return ZERO
    da = _signed(graph, tangent.get(a >> 1, ZERO), a)
    if op in ("add", "sub"):
        db = _signed(graph, tangent.get(b >> 1, ZERO), b)
        return graph.add(da, db if op == "add" else graph.negate(db))
    if op == "mul":
        db = _signed(graph, tangent.get(b >> 1, ZERO), b)
        return graph.add(graph.multiply(da, b), graph.multiply(a, db))
    return graph.multiply(_slope(graph, node), da)


def _shares(graph: Graph, node: int, weight: int) -> list[tuple[int, int]]:
    """The operands of a node, each with what it adds to the gradient for the node's own weight."""
    op, a, b = graph.code[node]
    if op in ("add", "sub"):
        return [(a, weight), (b, weight if op == "add" else graph.negate(weight))]
    if op == "mul":
        return [(a, graph.multiply(weight, b)), (b, graph.multiply(weight, a))]
    return [] if op in ("symbol", "const") else [(a, graph.multiply(weight, _slope(graph, node)))]


def _slope(graph: Graph, node: int) -> int:
    """df/da of a node f(a) with one operand."""
    op, a, _ = graph.code[node]
    if op == "sin":
        return graph.cosine(a)
    if op == "cos":
        return graph.negate(graph.sine(a))
    itself = 2 * node
    if op == "inv":
        return graph.negate(graph.multiply(itself, itself))
    return graph.invert(graph.add(itself, itself))  # op == "sqrt": 1 / (2 sqrt(a))


def _rebuilt(graph: Graph, node: int, image: dict[int, int]) -> int:
    op, a, b = graph.code[node]
    right = _signed(graph, image[b >> 1], b) if op in ("add", "sub", "mul") else ZERO
    return graph.operate(op, _signed(graph, image[a >> 1], a), right)
