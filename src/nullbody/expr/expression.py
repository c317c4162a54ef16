"""Expr: a reference into a graph with the operators of arithmetic."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from nullbody.errors import InputError
from nullbody.expr.exact import Exact
from nullbody.expr.graph import ONE, ZERO

if TYPE_CHECKING:
    from nullbody.expr.graph import Graph

__all__ = ["Expr", "cos", "sin", "sqrt"]


_SMALL = {0: ZERO, 1: ONE, -1: ONE ^ 1}  # references of the commonest constants, the same in every graph


class Expr:
    """An expression: a node of a `Graph` and a sign. Arithmetic makes new nodes in the same graph.

    Equality is equality of functions as far as the graph sees it (same node, same sign).
    """

    __slots__ = ("graph", "ref")

    def __init__(self, graph: Graph, ref: int) -> None:
        self.graph = graph
        self.ref = ref

    def _operand(self, other: Any) -> int:
        if isinstance(other, Expr):
            if other.graph is not self.graph:
                raise InputError("two expressions of different graphs cannot be combined")
            return other.ref
        if isinstance(other, int) and -1 <= other <= 1:
            return _SMALL[other]
        if isinstance(other, int | float | Fraction | Exact):
            return self.graph.constant_ref(Exact.of(other))
        return -1

    def __add__(self, other: Any) -> Expr:
        operand = self._operand(other)
        return NotImplemented if operand < 0 else Expr(self.graph, self.graph.add(self.ref, operand))

    def __sub__(self, other: Any) -> Expr:
        operand = self._operand(other)
        if operand < 0:
            return NotImplemented
        return Expr(self.graph, self.graph.add(self.ref, self.graph.negate(operand)))

    def __rsub__(self, other: Any) -> Expr:
        return (-self).__add__(other)

    def __mul__(self, other: Any) -> Expr:
        operand = self._operand(other)
        return NotImplemented if operand < 0 else Expr(self.graph, self.graph.multiply(self.ref, operand))

    def __truediv__(self, other: Any) -> Expr:
        operand = self._operand(other)
        if operand < 0:
            return NotImplemented
        return Expr(self.graph, self.graph.multiply(self.ref, self.graph.invert(operand)))

    def __rtruediv__(self, other: Any) -> Expr:
        operand = self._operand(other)
        if operand < 0:
            return NotImplemented
        return Expr(self.graph, self.graph.multiply(operand, self.graph.invert(self.ref)))

    def __neg__(self) -> Expr:
        return Expr(self.graph, self.graph.negate(self.ref))

    def __pos__(self) -> Expr:
        return self

    def __pow__(self, exponent: int) -> Expr:
        if not isinstance(exponent, int):
            raise InputError(f"an expression can be raised to an integer power, not to {exponent!r}")
        base = self if exponent >= 0 else 1 / self
        result = Expr(self.graph, self.graph.constant_ref(Exact.of(1)))
        power = abs(exponent)
        while power:  # by repeated squaring
            if power & 1:
                result = result * base
            power >>= 1
            base = base * base if power else base
        return result

    __radd__ = __add__
    __rmul__ = __mul__

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Expr):
            return self.graph is other.graph and self.ref == other.ref
        if isinstance(other, int) and -1 <= other <= 1:
            return self.ref == _SMALL[other]
        if isinstance(other, int | float | Fraction | Exact):
            return self.constant == Exact.of(other)
        return NotImplemented

    def __hash__(self) -> int:
        return hash((id(self.graph), self.ref))

    @property
    def constant(self) -> Exact | None:
        """The exact constant that this expression is, or None."""
        return self.graph.constant_of(self.ref)

    @property
    def name(self) -> str | None:
        """The name, where the expression is a symbol."""
        op, left, _ = self.graph.code[self.ref >> 1]
        return self.graph.symbols[left] if op == "symbol" and not self.ref & 1 else None

    def __repr__(self) -> str:
        from nullbody.expr.text import shown

        return shown(self)


def sin(x: Expr) -> Expr:
    """Sine of an expression [rad]."""
    return Expr(x.graph, x.graph.sine(x.ref))


def cos(x: Expr) -> Expr:
    """Cosine of an expression [rad]."""
    return Expr(x.graph, x.graph.cosine(x.ref))


def sqrt(x: Expr) -> Expr:
    """Square root of an expression."""
    return Expr(x.graph, x.graph.square_root(x.ref))
