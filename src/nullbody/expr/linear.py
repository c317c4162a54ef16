"""Expressions as linear combinations of products, so that constant combinations of them cancel for good.

    f = sum_k c_k t_k,      c_k exact constants, t_k products of factors that are no sums of their own

A sum in a graph keeps the form in which it was first written: 2 f - g is two whole expressions even where their terms
cancel one by one. Collected first, the terms are gone.
"""

from __future__ import annotations

from nullbody.expr.exact import Exact
from nullbody.expr.expression import Expr
from nullbody.expr.graph import ONE, ZERO, Graph

__all__ = ["LinearForm"]

_Term = tuple[int, ...]  # nodes of the factors, sorted


class LinearForm:
    """The terms of an expression with their coefficients.

    Args:
        graph: where they are.
        terms: coefficients by product.
    """

    def __init__(self, graph: Graph, terms: dict[_Term, Exact]) -> None:
        self.graph = graph
        self.terms = terms

    @classmethod
    def of(cls, f: Expr) -> LinearForm:
        """The form of an expression; only sums and products with constants are taken apart."""
        found = cls(f.graph, {})
        found._collect(f.ref, Exact.of(1))
        return found

    def scaled(self, factor: Exact) -> LinearForm:
        """The form times a constant."""
        return LinearForm(self.graph, {term: factor * c for term, c in self.terms.items()})

    def minus(self, factor: Exact, other: LinearForm) -> LinearForm:
        """This form minus a constant times another one; terms that cancel are left out."""
        terms = dict(self.terms)
        for term, c in other.terms.items():
            terms[term] = terms.get(term, Exact.of(0)) + -(factor * c)
        return LinearForm(self.graph, {term: c for term, c in terms.items() if c != Exact.of(0)})

    def expression(self) -> Expr:
        """The form written down: terms of equal coefficients together, so that each coefficient is one product."""
        graph = self.graph
        groups: dict[Exact, list[tuple[bool, int]]] = {}
        for term, c in self.terms.items():
            groups.setdefault(-c if c.negative else c, []).append((c.negative, self._product(term)))
        total = ZERO
        for c, members in sorted(groups.items(), key=lambda group: -len(group[1])):
            part = ZERO
            for negative, ref in sorted(members):
                part = graph.add(part, graph.negate(ref) if negative else ref)
            total = graph.add(total, graph.multiply(graph.constant_ref(c), part))
        return Expr(graph, total)

    def _collect(self, ref: int, coefficient: Exact) -> None:
        code, stack = self.graph.code, [(ref, coefficient)]
        while stack:
            ref, coefficient = stack.pop()
            coefficient = -coefficient if ref & 1 else coefficient
            op, a, b = code[ref >> 1]
            if op in ("add", "sub"):
                stack += [(a, coefficient), (b, coefficient if op == "add" else -coefficient)]
                continue
            constant, factors = self._factors(ref & ~1)
            if len(factors) == 1 and code[factors[0]][0] in ("add", "sub"):
                stack.append((2 * factors[0], coefficient * constant))
            else:
                self._add(factors, coefficient * constant)

    def _add(self, term: _Term, coefficient: Exact) -> None:
        total = self.terms.get(term, Exact.of(0)) + coefficient
        if total == Exact.of(0):
            self.terms.pop(term, None)
        else:
            self.terms[term] = total

    def _factors(self, ref: int) -> tuple[Exact, _Term]:
        """(c, factors) of a product."""
        constant, found, stack = Exact.of(1), [], [ref]
        while stack:
            ref = stack.pop()
            op, a, b = self.graph.code[ref >> 1]
            constant = -constant if ref & 1 else constant
            if op == "const":
                constant = constant * self.graph.constants[a]
            elif op == "mul":
                stack += [a, b]
            else:
                found.append(ref >> 1)
        return constant, tuple(sorted(found))

    def _product(self, term: _Term) -> int:
        """The product of the factors, functions before symbols: those are shared by more terms."""
        code, result = self.graph.code, ONE
        for node in sorted(term, key=lambda node: code[node][0] == "symbol"):
            result = self.graph.multiply(result, 2 * node)
        return result
