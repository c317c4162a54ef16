"""Expressions as text and as LaTeX, as written on paper: sums, products, fractions."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from nullbody.expr.exact import Exact
from nullbody.expr.expression import Expr
from nullbody.expr.graph import Graph
from nullbody.expr.tape import operations

__all__ = ["latex", "latex_symbol", "shared_nodes", "shown", "text"]

_GREEK = {
    *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu"),
    *("nu", "xi", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega"),
}
_SUM, _PRODUCT, _ATOM = 0, 1, 2
_LARGEST_SHOWN = 2000  # symbols, numbers and signs in what `repr` writes out


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
        terms = [_tex_term(k, part) for k, part in number.terms] or ["0"]
        return terms[0] + "".join(f" - {t[1:]}" if t.startswith("-") else f" + {t}" for t in terms[1:])


def text(expression: Expr, names: Mapping[int, str] | None = None) -> str:
    """The expression as text; `names` maps nodes to the names under which they are printed."""
    return _write(expression.graph, expression.ref, names or {}, _Style(tex=False))[0]


def shown(expression: Expr) -> str:
    """The expression as text where that fits a screen, otherwise what it is: shared parts would be written out."""
    graph, sizes = expression.graph, dict[int, int]()
    for node in graph.reachable([expression.ref]):
        sizes[node] = min(10**18, 1 + sum(sizes[ref >> 1] for ref in graph.operands(node)))
    written = sizes[expression.ref >> 1]
    if written <= _LARGEST_SHOWN:
        return text(expression)
    return f"<Expr of {operations([expression])} operations, {written:.3g} symbols when written out: see text()>"


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


@dataclass(frozen=True)
class _Product:
    """constant * product of nodes above / product of nodes below, each node with its power."""

    constant: Exact
    above: dict[int, int]
    below: dict[int, int]

    @property
    def key(self) -> tuple[frozenset[tuple[int, int]], frozenset[tuple[int, int]]]:
        """Equal for like terms."""
        return frozenset(self.above.items()), frozenset(self.below.items())


def _write(graph: Graph, ref: int, names: Mapping[int, str], style: _Style) -> tuple[str, int]:
    """(text, rank of its outermost operation) of a reference."""
    node, negative = ref >> 1, ref & 1
    if node in names:
        return _negated(names[node], _ATOM, negative)
    op, a, _ = graph.code[node]
    if op == "symbol":
        return _negated(style.symbol(graph.symbols[a]), _ATOM, negative)
    if op == "const":
        return _constant(graph.constants[a], negative, style)
    if op in ("add", "sub"):
        return _sum(graph, ref, names, style)
    if op in ("mul", "inv"):
        return _negated(_factored(graph, _product(graph, node, names), names, style), _PRODUCT, negative)
    return _negated(style.function(op, _write(graph, a, names, style)[0]), _ATOM, negative)


def _constant(number: Exact, negative: int, style: _Style) -> tuple[str, int]:
    body = style.constant(number)
    if len(number.terms) > 1:
        return (f"-{style.fenced(body)}" if negative else body), _SUM
    whole = number.fraction is not None and number.fraction.denominator == 1
    return _negated(body, _ATOM if whole else _PRODUCT, negative)


def _negated(body: str, rank: int, negative: int) -> tuple[str, int]:
    return (f"-{body}", _SUM) if negative else (body, rank)


def _sum(graph: Graph, ref: int, names: Mapping[int, str], style: _Style) -> tuple[str, int]:
    """Flatten nested sums, add up like terms, positive and short ones first."""
    terms: dict[object, _Product] = {}
    stack = [ref]
    while stack:
        current = stack.pop()
        op, a, b = graph.code[current >> 1]
        if op in ("add", "sub") and current >> 1 not in names:
            sign = current & 1
            stack += [a ^ sign, b ^ sign ^ (op == "sub")]
            continue
        part = _product(graph, current >> 1, names)
        constant = -part.constant if current & 1 else part.constant
        if part.key in terms:
            constant = constant + terms[part.key].constant
        terms[part.key] = _Product(constant, part.above, part.below)
    signed = []
    for part in terms.values():
        if part.constant.terms:
            size = -part.constant if part.constant.negative else part.constant
            body = _factored(graph, _Product(size, part.above, part.below), names, style)
            signed.append((part.constant.negative, len(body), body))
    if not signed:
        return "0", _ATOM
    signed.sort()
    if len(signed) == 1:
        return _negated(signed[0][2], _PRODUCT, int(signed[0][0]))
    first = ("-" if signed[0][0] else "") + signed[0][2]
    return first + "".join(f" {'-' if negative else '+'} {body}" for negative, _, body in signed[1:]), _SUM


def _product(graph: Graph, node: int, names: Mapping[int, str]) -> _Product:
    """Flatten nested products and reciprocals."""
    constant = Exact.of(1)
    above: dict[int, int] = {}
    below: dict[int, int] = {}
    stack = [(node, above, below)]
    while stack:
        current, here, there = stack.pop()
        op, a, b = graph.code[current]
        if op == "mul" and current not in names:
            stack += [(b >> 1, here, there), (a >> 1, here, there)]
        elif op == "inv" and current not in names:
            stack.append((a >> 1, there, here))
        elif op == "const":
            constant = constant * (graph.constants[a] if here is above else graph.constants[a].inverse())
        else:
            here[current] = here.get(current, 0) + 1
    return _Product(constant, above, below)


def _factored(graph: Graph, product: _Product, names: Mapping[int, str], style: _Style) -> str:
    """A product as written: the constant first, then symbols, then the rest, reciprocals below."""
    factors = _factors(graph, product.above, names, style)
    if product.constant != Exact.of(1) or not factors:
        body, rank = _constant(product.constant, 0, style)
        factors.insert(0, style.fenced(body) if rank == _SUM else body)
    written = style.times(factors)
    if not product.below:
        return written
    return style.quotient(written, style.times(_factors(graph, product.below, names, style)))


def _factors(graph: Graph, counts: Mapping[int, int], names: Mapping[int, str], style: _Style) -> list[str]:
    """The factors as powers: symbols by name, named parts, functions, sums."""

    def place(node: int) -> tuple[int, str, int]:
        op, a, _ = graph.code[node]
        if node in names:
            return 1, "", node
        if op == "symbol":
            return 0, graph.symbols[a].lower(), node
        return 3 if op in ("add", "sub") else 2, "", node

    factors = []
    for part in sorted(counts, key=place):
        body, rank = _write(graph, 2 * part, names, style)
        power = counts[part]
        if style.tex and power > 1 and part not in names and graph.code[part][0] in ("sin", "cos"):
            name = graph.code[part][0]
            factors.append(body.replace(rf"\{name}", rf"\{name}^{{{power}}}", 1))
            continue
        body = style.fenced(body) if rank == _SUM or (power > 1 and rank == _PRODUCT) else body
        factors.append(body if power == 1 else style.power(body, power))
    return factors
