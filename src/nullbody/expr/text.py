"""Expressions as text and as LaTeX, as written on paper: sums, products, fractions."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from nullbody.expr.exact import Exact
from nullbody.expr.expression import Expr
from nullbody.expr.graph import Graph

__all__ = ["latex", "latex_symbol", "shared_nodes", "text"]

_GREEK = {
    *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu"),
    *("nu", "xi", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega"),
}
_SUM, _PRODUCT, _ATOM = 0, 1, 2


@dataclass(frozen=True)
class _Style:
    """How the pieces are written."""

    tex: bool

    def symbol(self, name: str) -> str:
        return latex_symbol(name) if self.tex else name

    def times(self, factors: Sequence[str]) -> str:
        return (r" \, " if self.tex else "*").join(factors)

    def fenced(self, body: str) -> str:
        return rf"\left({body}\right)" if self.tex else f"({body})"

    def function(self, name: str, body: str) -> str:
        if not self.tex:
            return f"{name}({body})"
        return rf"\sqrt{{{body}}}" if name == "sqrt" else rf"\{name}{{{body}}}"

    def quotient(self, above: str, below: str) -> str:
        return rf"\frac{{{above}}}{{{below}}}" if self.tex else f"{above}/({below})"

    def power(self, body: str, power: int) -> str:
        return f"{body}^{{{power}}}" if self.tex else f"{body}^{power}"

    def constant(self, number: Exact) -> str:
        """A positive constant; in LaTeX sqrt(3)/2 is a small fraction."""
        if not self.tex:
            return str(number)
        terms = [_tex_term(k, part) for k, part in number.terms]
        return terms[0] + "".join(f" - {t[1:]}" if t.startswith("-") else f" + {t}" for t in terms[1:])


def text(expression: Expr, names: Mapping[int, str] | None = None) -> str:
    """The expression as text; `names` maps nodes to the names under which they are printed."""
    return _write(expression.graph, expression.ref, names or {}, _Style(tex=False))[0]


def latex(expression: Expr, names: Mapping[int, str] | None = None) -> str:
    """The expression as LaTeX."""
    return _write(expression.graph, expression.ref, names or {}, _Style(tex=True))[0]


def latex_symbol(name: str) -> str:
    r"""A name as LaTeX: alpha1 -> \alpha_{1}, Ixx -> I_{xx}, q_dot -> \dot{q}."""
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


def _tex_term(radicand: int, part: Fraction) -> str:
    above = str(abs(part.numerator))
    if radicand > 1:
        above = ("" if above == "1" else above) + rf"\sqrt{{{radicand}}}"
    sign = "-" if part < 0 else ""
    return sign + (above if part.denominator == 1 else rf"\tfrac{{{above}}}{{{part.denominator}}}")


def _write(graph: Graph, ref: int, names: Mapping[int, str], style: _Style) -> tuple[str, int]:
    """(text, rank of its outermost operation) of a reference."""
    node, negative = ref >> 1, ref & 1
    if node in names:
        return _negated(names[node], _ATOM, negative)
    op, a, b = graph.code[node]
    if op == "symbol":
        return _negated(style.symbol(graph.symbols[a]), _ATOM, negative)
    if op == "const":
        return _constant(graph.constants[a], negative, style)
    if op in ("add", "sub"):
        return _sum(graph, node, negative, names, style), _SUM
    if op in ("mul", "inv"):
        return _negated(_product(graph, node, names, style), _PRODUCT, negative)
    return _negated(style.function(op, _write(graph, a, names, style)[0]), _ATOM, negative)


def _constant(number: Exact, negative: int, style: _Style) -> tuple[str, int]:
    body = style.constant(number)
    if len(number.terms) > 1:
        return (f"-{style.fenced(body)}" if negative else body), _SUM
    return _negated(
        body, _ATOM if number.fraction is not None and number.fraction.denominator == 1 else _PRODUCT, negative
    )


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


def _product(graph: Graph, node: int, names: Mapping[int, str], style: _Style) -> str:
    """Flatten nested products: the constant first, then symbols, then the rest, reciprocals below."""
    constant = Exact.of(1)
    above: dict[int, int] = {}
    below: dict[int, int] = {}
    stack = [(node, above, below)]
    while stack:
        current, here, there = stack.pop()
        op, a, b = graph.code[current]
        if op == "mul" and (current == node or current not in names):
            stack += [(b >> 1, here, there), (a >> 1, here, there)]
        elif op == "inv" and (current == node or current not in names):
            stack.append((a >> 1, there, here))
        elif op == "const":
            constant = constant * (graph.constants[a] if here is above else graph.constants[a].inverse())
        else:
            here[current] = here.get(current, 0) + 1
    factors = _factors(graph, above, names, style)
    if constant != Exact.of(1) or not factors:
        body, rank = _constant(constant, 0, style)
        factors.insert(0, style.fenced(body) if rank == _SUM else body)
    written = style.times(factors)
    return style.quotient(written, style.times(_factors(graph, below, names, style))) if below else written


def _factors(graph: Graph, counts: Mapping[int, int], names: Mapping[int, str], style: _Style) -> list[str]:
    """The factors as powers, simple ones first."""
    order = {"symbol": 0, "sin": 2, "cos": 2, "sqrt": 2, "add": 3, "sub": 3}
    factors = []
    for part in sorted(counts, key=lambda n: (1 if n in names else order.get(graph.code[n][0], 2), n)):
        body, rank = _write(graph, 2 * part, names, style)
        power = counts[part]
        if style.tex and power > 1 and part not in names and graph.code[part][0] in ("sin", "cos"):
            name = graph.code[part][0]
            factors.append(body.replace(rf"\{name}", rf"\{name}^{{{power}}}", 1))
            continue
        body = style.fenced(body) if rank == _SUM else body
        factors.append(body if power == 1 else style.power(body, power))
    return factors
