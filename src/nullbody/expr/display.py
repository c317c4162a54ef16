"""Scalars, vectors and matrices of expressions as LaTeX, the sub-expressions that they share under names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import count
from typing import Any

from nullbody.expr.expression import Expr
from nullbody.expr.graph import Graph
from nullbody.expr.text import latex, latex_symbol, shared_nodes

__all__ = ["flat", "latex_equation"]


def flat(output: Any) -> Iterator[Any]:
    """The entries of a scalar, vector or matrix, row by row."""
    if isinstance(output, Sequence):
        for part in output:
            yield from flat(part)
    else:
        yield output


def latex_equation(symbol: str, value: Any, names: Mapping[str, str] | None = None, below: bool = False) -> str:
    r"""`symbol = value` as LaTeX (amsmath, `aligned`), with z_1 = ..., z_2 = ... for what the entries share.

    Args:
        symbol: LaTeX of the left side; "" for none.
        value: a scalar, a vector (written as a column) or a matrix of expressions and numbers.
        names: LaTeX of symbols by name, where it is not to be made from the name.
        below: list the shared sub-expressions below the equation, not above; each only needs those before it.
    """
    entries = [e for e in flat(value) if isinstance(e, Expr)]
    graph = entries[0].graph if entries else Graph()
    known = {graph.symbol(name).ref >> 1: shown for name, shown in (names or {}).items() if name in graph.symbols}
    taken = {(names or {}).get(name) or latex_symbol(name) for name in graph.symbols}
    letters = (letter for letter in (f"z_{{{number}}}" for number in count(1)) if letter not in taken)
    lines = []
    for node in shared_nodes(entries):
        letter = next(letters)
        lines.append(rf"{letter} &= {latex(Expr(graph, 2 * node), known)}")
        known[node] = letter

    def entry(e: Any) -> str:
        return latex(e if isinstance(e, Expr) else graph.constant(e), known)

    if isinstance(value, Sequence):
        body = r" \\ ".join(" & ".join(entry(e) for e in flat(row)) for row in value)
        shown = rf"\begin{{bmatrix}} {body} \end{{bmatrix}}"
    else:
        shown = entry(value)
    equation = rf"{symbol} &= {shown}" if symbol else rf"& {shown}"
    lines = [equation, *lines] if below else [*lines, equation]
    return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"
