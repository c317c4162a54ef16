"""SymPy's expressions read into a graph: a walk over their structure, operands first, without recursion."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

from nullbody.errors import InputError
from nullbody.expr.exact import Exact
from nullbody.expr.expression import Expr
from nullbody.expr.graph import ONE, ZERO, Graph

__all__ = ["SymPyReader", "shown"]

_LARGEST_POWER = 10_000  # of a constant: exact numbers would grow without limit
_HYPERBOLIC = ("sinh", "cosh", "tanh", "coth", "sech", "csch")
_CIRCULAR = ("sin", "cos", "tan", "cot", "sec", "csc")

_Plan = tuple[Sequence[Any], Callable[[Sequence[int]], int]]  # what must be read before; how it is put together


class SymPyReader:
    """Reads SymPy expressions into a graph.

    Args:
        graph: where they go.
        variable: the reference that stands for a SymPy symbol, or for a sub-expression that the graph has no
            operation for.
    """

    def __init__(self, graph: Graph, variable: Callable[[Any], int]) -> None:
        import sympy

        self.graph = graph
        self._variable = variable
        self._sympy: Any = sympy
        self._known: dict[int, tuple[Any, int]] = {}  # id -> (SymPy object, kept alive by this; reference)
        self._rules: dict[type, Callable[[Any], _Plan]] = {
            sympy.Add: lambda e: (e.args, self._sum),
            sympy.Mul: self._mul,
            sympy.Pow: self._pow,
            sympy.exp: self._exp,
            **{getattr(sympy, name): self._hyperbolic for name in _HYPERBOLIC},
            **{getattr(sympy, name): partial(self._function, name) for name in _CIRCULAR},
        }

    def reference(self, root: Any) -> int:
        """The reference of a SymPy expression: every object once, operands first."""
        known = self._known
        if id(root) in known:
            return known[id(root)][1]
        stack: list[tuple[Any, _Plan | None]] = [(root, None)]
        while stack:
            current, plan = stack.pop()
            if id(current) in known:
                continue
            if plan is None:
                plan = self._rules.get(type(current), self._leaf)(current)
                missing = [part for part in plan[0] if id(part) not in known]
                if missing:
                    stack.append((current, plan))
                    stack += [(part, None) for part in reversed(missing)]
                    continue
            parts, build = plan
            try:
                known[id(current)] = current, build([known[id(part)][1] for part in parts])
            except ZeroDivisionError:
                raise InputError(f"not finite: a divisor is identically zero in {shown(current)}") from None
        return known[id(root)][1]

    def _mul(self, product: Any) -> _Plan:
        """The factors; those with negative powers are multiplied first and divided by once."""
        parts: list[Any] = []
        powers: list[int] = []
        for factor in product.args:
            twice = self._twice(factor.exp) if type(factor) is self._sympy.Pow else None
            below = twice is not None and twice < 0
            parts.append(factor.base if below else factor)
            powers.append(twice if below and twice is not None else 0)
        return parts, partial(self._product, powers)

    def _pow(self, power: Any) -> _Plan:
        twice = self._twice(power.exp)
        if twice is not None:
            return (power.base,), partial(self._raised, twice)
        if power.exp.is_Rational and power.exp.p != 1:  # x^(2/3) is the square of x^(1/3)
            root = self._sympy.Pow(power.base, self._sympy.Rational(1, power.exp.q))
            return (root,), partial(self._raised, 2 * int(power.exp.p))
        return self._leaf(power)

    def _exp(self, function: Any) -> _Plan:
        """exp of a sum is a product, exp(k t) a power of exp(t): what is left are stand-ins that do not depend."""
        exponent = function.args[0]
        terms = exponent.args if type(exponent) is self._sympy.Add else (exponent,)
        factors = [term.as_coeff_Mul(rational=True) for term in terms]
        powers = [2 * int(number.p) for number, _ in factors]
        bases = [self._sympy.exp(rest / number.q) for number, rest in factors]
        if bases == [function]:
            return self._leaf(function)
        return bases, lambda refs: self._product([0] * len(refs), list(map(self._power, powers, refs)))

    def _power(self, twice: int, base: int) -> int:
        return self._raised(twice, (base,))

    def _hyperbolic(self, function: Any) -> _Plan:
        return (function.rewrite(self._sympy.exp),), lambda refs: refs[0]

    def _twice(self, exponent: Any) -> int | None:
        """2 n for an exponent n that is whole or a half, or None."""
        if exponent.is_Integer:
            return 2 * int(exponent.p)
        if exponent.is_Rational:
            return int(exponent.p) if exponent.q == 2 else None
        doubled = 2 * _decimal(exponent) if exponent.is_Float else Fraction(1, 2)
        return doubled.numerator if doubled.denominator == 1 else None

    def _sum(self, terms: Iterable[int]) -> int:
        total = ZERO
        for ref in terms:
            total = self.graph.add(total, ref)
        return total

    def _product(self, powers: Sequence[int], factors: Sequence[int]) -> int:
        graph = self.graph
        constant, above, below = ONE, ONE, ONE
        for ref, power in zip(factors, powers, strict=True):
            if power:
                below = graph.multiply(below, self._raised(-power, (ref,)))
            elif graph.constant_of(ref) is not None:
                constant = graph.multiply(constant, ref)
            else:
                above = graph.multiply(above, ref)
        result = graph.multiply(constant, above)
        return result if below == ONE else graph.multiply(result, graph.invert(below))

    def _raised(self, twice: int, base: Sequence[int]) -> int:
        """base^(twice/2)"""
        (ref,) = base
        graph = self.graph
        if graph.constant_of(ref) is not None and abs(twice) > 2 * _LARGEST_POWER:
            raise InputError(f"a constant to a power beyond {_LARGEST_POWER} is not kept exactly")
        root, power = (graph.square_root(ref), twice) if twice % 2 else (ref, twice // 2)
        return (Expr(graph, root) ** power if power >= 0 else 1 / Expr(graph, root) ** -power).ref

    def _function(self, name: str, function: Any) -> _Plan:
        """sin, cos, ... of an angle; a multiple of pi/12 in it is an exact rotation."""
        (angle,) = function.args
        terms = angle.args if type(angle) is self._sympy.Add else (angle,)
        turns = [term for term in terms if self._is_turn(term)]
        if len(turns) != 1:
            return (angle,), lambda refs: self._circular(name, refs, ONE, ZERO)
        rest = [term for term in terms if term is not turns[0]]
        exact = [self._sympy.cos(turns[0]), self._sympy.sin(turns[0])]
        return [*rest, *exact], lambda refs: self._circular(name, refs[:-2], refs[-2], refs[-1])

    def _is_turn(self, term: Any) -> bool:
        """Whether a term of an angle is a multiple of pi/12, whose sine and cosine are exact constants."""
        pi = self._sympy.pi
        if term is pi:
            return True
        if type(term) is not self._sympy.Mul or len(term.args) != 2 or term.args[1] is not pi:
            return False
        factor = term.args[0]
        return bool(factor.is_Rational and 12 % factor.q == 0)

    def _circular(self, name: str, terms: Sequence[int], c: int, s: int) -> int:
        """A circular function of (sum of the terms) + (the angle with this cosine and sine)."""
        graph = self.graph
        angle = self._sum(terms)

        def sine() -> int:
            first = graph.multiply(graph.sine(angle), c) if c != ZERO else ZERO
            return graph.add(first, graph.multiply(graph.cosine(angle), s)) if s != ZERO else first

        def cosine() -> int:
            first = graph.multiply(graph.cosine(angle), c) if c != ZERO else ZERO
            return graph.add(first, graph.negate(graph.multiply(graph.sine(angle), s))) if s != ZERO else first

        if name in ("tan", "cot"):
            above, below = (sine(), cosine()) if name == "tan" else (cosine(), sine())
            return graph.multiply(above, graph.invert(below))
        result = sine() if name in ("sin", "csc") else cosine()
        return result if name in ("sin", "cos") else graph.invert(result)

    def _leaf(self, leaf: Any) -> _Plan:
        """What has no parts that are read."""
        if leaf.is_Rational:
            ref = self.graph.constant_ref(Exact.of(Fraction(int(leaf.p), int(leaf.q))))
        elif leaf.is_Float:
            ref = self.graph.constant_ref(Exact.of(_decimal(leaf)))
        elif not isinstance(leaf, self._sympy.Expr):
            raise InputError(f"expected a scalar SymPy expression, not {type(leaf).__name__}")
        else:
            ref = self._variable(leaf)
        return (), lambda _: ref


def _decimal(number: Any) -> Fraction:
    """A SymPy Float as the decimal that it means: the shortest one of a double, all digits of any other.

    Raises:
        InputError: it lies outside the range of doubles.
    """
    size = float(number)
    if not math.isfinite(size) or (size == 0 and number != 0):
        raise InputError(f"a number must be finite and in the range of doubles, not {number}")
    return Fraction(repr(size)) if number._prec == 53 else Fraction(str(number))


def shown(expression: Any) -> str:
    """An expression in an error message."""
    try:
        written = str(expression)
    except RecursionError:
        return f"an expression {type(expression).__name__}(...)"
    return written if len(written) <= 80 else written[:77] + "..."
