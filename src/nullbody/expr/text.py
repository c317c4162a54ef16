"""Expressions as text and as LaTeX, as written on paper: sums, products, fractions."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from nullbody.expr.exact import Exact
from nullbody.expr.expression import Expr
from nullbody.expr.graph import Graph

__all__ = ["latex", "latex_symbol", "shared_nodes", "text"]

_GREEK = (
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon phi chi psi omega"
).split()
_SUM, _PRODUCT, _ATOM = 0, 1, 2


@dataclass(frozen=True)
class _Style:
    """How the pieces are written; `times` joins factors."""

    tex: bool

    def symbol(self, name: str) -> str:
        return latex_symbol(name) if self.tex else name

    @property
    def times(self) -> str:
        return r" \, " if self.tex else "*"

    def fenced(self, body: str) -> str:
        return rf"\left({body}\right)" if self.tex else f"({body})"

    def function(self, name: str, body: str) -> str:
        if not self.tex:
            return f"{name}({body})"
        return rf"\sqrt{{{body}}}" if name == "sqrt" else rf"\{name}{{{body}}}"

    def inverse(self, body: str) -> str:
        return rf"\frac{{1}}{{{body}}}" if self.tex else f"1/({body})"

    def constant(self, number: Exact) -> str:
        if not self.tex:
            return str(number)
        return re.sub(r"(\d+\*)?sqrt\((\d+)\)|(\d+)/(\d+)", _tex_part, _tex_quotients(number)).replace("*", r" \, ")


def text(expression: Expr, names: Mapping[int, str] | None = None) -> str:
    """The expression as text; `names` maps nodes to the names under which they are printed."""
    return _write(expression.graph, expression.ref, names or {}, _Style(tex=False))[0]


def latex(expression: Expr, names: Mapping[int, str] | None = None) -> str:
    """The expression as LaTeX."""
    return _write(expression.graph, expression.ref, names or {}, _Style(tex=True))[0]


def latex_symbol(name: str) -> str:
    """A name as LaTeX: alpha1 -> \\alpha_{1}, Ixx -> I_{xx}, q_dot -> \\dot{q}."""
    if name.endswith("_dot"):
        return rf"\dot{{{latex_symbol(name[:-4])}}}"
    stem, digits = re.fullmatch(r"(.*?)_?(\d*)", name).groups()  # type: ignore[union-attr]
    head, *rest = stem.split("_")
    if not rest and head not in _GREEK and len(head) > 1:
        head, rest = head[0], [head[1:]]
    subscript = ",".join([part for part in rest if part] + ([digits] if digits else []))
    base = "\\" + head if head in _GREEK else head
    return f"{base}_{{{subscript}}}" if subscript else base


def shared_nodes(expressions: Sequence[Expr], smallest: int = 3) -> list[int]:
    """Nodes worth a name: used more than once and made of at least `smallest` operations."""
    if not expressions:
        return []
    graph = expressions[0].graph
    nodes = graph.reachable(f.ref for f in expressions)
    uses = dict.fromkeys(nodes, 0)
    size: dict[int, int] = {}
    for node in nodes:
        operands = graph.operands(node)
        size[node] = sum(size[r >> 1] for r in operands) + (1 if operands else 0)
        for ref in operands:
            uses[ref >> 1] += 1
    for f in expressions:
        uses[f.ref >> 1] += 1
    return [node for node in nodes if uses[node] > 1 and size[node] >= smallest]


def _tex_quotients(number: Exact) -> str:
    return str(number)


def _tex_part(match: re.Match[str]) -> str:
    factor, radicand, numerator, denominator = match.groups()
    if radicand:
        return (factor or "").replace("*", "") + rf"\sqrt{{{radicand}}}"
    return rf"\tfrac{{{numerator}}}{{{denominator}}}"


def _write(graph: Graph, ref: int, names: Mapping[int, str], style: _Style) -> tuple[str, int]:
    """(text, rank of its outermost operation) of a reference."""
    node, negative = ref >> 1, ref & 1
    if node in names:
        return _negated(names[node], _ATOM, negative)
    op, a, b = graph.code[node]
    if op == "symbol":
        return _negated(style.symbol(graph.symbols[a]), _ATOM, negative)
    if op == "const":
        number = graph.constants[a]
        body = style.constant(number)
        rank = _SUM if len(number.terms) > 1 else _ATOM if number.fraction is not None and "/" not in str(number) else _PRODUCT
        return (body if not negative else f"-{body}" if rank else f"-{style.fenced(body)}"), (rank if not negative else _SUM)
    if op in ("add", "sub"):
        return _sum(graph, node, negative, names, style), _SUM
    if op == "mul":
        body = style.times.join(_factors(graph, node, names, style))
        return _negated(body, _PRODUCT, negative)
    inner = _write(graph, a, names, style)[0]
    body = style.inverse(inner) if op == "inv" else style.function(op, inner)
    return _negated(body, _ATOM if op != "inv" else _PRODUCT, negative)


def _negated(body: str, rank: int, negative: int) -> tuple[str, int]:
    return (f"-{body}", _SUM) if negative else (body, rank)


def _sum(graph: Graph, node: int, negative: int, names: Mapping[int, str], style: _Style) -> str:
    """Flatten nested sums into one list of signed terms, positive ones first."""
    terms: list[int] = []
    stack = [2 * node | negative]
    while stack:
        ref = stack.pop()
        op, a, b = graph.code[ref >> 1]
        if op in ("add", "sub") and (ref >> 1 == node or ref >> 1 not in names):
            sign = ref & 1
            stack.append(b ^ sign ^ (op == "sub"))
            stack.append(a ^ sign)
        else:
            terms.append(ref)
    terms.sort(key=lambda ref: ref & 1)
    written = [_write(graph, ref, names, style)[0] for ref in terms]
    return written[0] + "".join(f" - {w[1:]}" if w.startswith("-") else f" + {w}" for w in written[1:])


def _factors(graph: Graph, node: int, names: Mapping[int, str], style: _Style) -> list[str]:
    """Flatten nested products into one list of factors, equal ones as powers."""
    counts: dict[int, int] = {}
    stack = [node]
    while stack:
        current = stack.pop()
        op, a, b = graph.code[current]
        if op == "mul" and (current == node or current not in names):
            stack += [b >> 1, a >> 1]
        else:
            counts[current] = counts.get(current, 0) + 1
    factors = []
    for part, power in counts.items():
        body, rank = _write(graph, 2 * part, names, style)
        body = style.fenced(body) if rank == _SUM or (power > 1 and rank < _ATOM) else body
        factors.append(body if power == 1 else _power(graph, part, body, power, style))
    return factors


def _power(graph: Graph, node: int, body: str, power: int, style: _Style) -> str:
    if style.tex and graph.code[node][0] in ("sin", "cos"):
        name = graph.code[node][0]
        return body.replace(rf"\{name}", rf"\{name}^{{{power}}}", 1)
    return f"{body}^{{{power}}}" if style.tex else f"{body}^{power}"
