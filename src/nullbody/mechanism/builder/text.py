"""Scalars of any origin as the mechanism keeps them: plain numbers, or texts in the small grammar.

SymPy and SymEngine expressions are walked, never printed and read again: every digit of a number stays.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from numbers import Integral, Rational, Real
from typing import Any

from nullbody.errors import ExpressionError, MechanismError
from nullbody.expr.parse import names_in
from nullbody.mechanism.body import Placement, Rotation
from nullbody.typing import Scalar, Triple

__all__ = ["grouped", "place", "scalar", "triple"]

_SYMBOLIC = ("sympy", "symengine")
_FUNCTIONS = ("sin", "cos", "tan")
_RECIPROCAL = {"cot": "1/tan({})", "sec": "1/cos({})", "csc": "1/sin({})"}
_MOST_NODES = 20_000  # a text of the grammar is far shorter; an expression that repeats itself may grow exponentially
_SUM, _PRODUCT, _POWER, _ATOM = range(4)  # how tightly the outermost operation binds

_Text = tuple[str, int]


_LEAST = 1e-100  # products of a few such numbers are still floating-point numbers


def scalar(value: object, place: str) -> Scalar:
    """A number, a text of the grammar, or a SymPy or SymEngine expression as a number or a text.

    Args:
        value: what was given. f(t) stands for the coordinate f, its derivative by t for f_dot.
        place: for messages.

    Raises:
        ExpressionError: it is none of these, or holds what the grammar has no word for; the message says what.
    """
    if isinstance(value, str):
        text = value
    elif any(str(kind.__module__).partition(".")[0] in _SYMBOLIC for kind in type(value).__mro__):
        text = _symbolic(value, place)
    else:
        return _number(value, place)
    try:
        names_in(text)
    except ExpressionError as error:
        raise ExpressionError(f"{place}: {error}") from None
    return text


def triple(values: object, place: str) -> Triple:
    """Three scalars.

    Raises:
        MechanismError: they are not three.
        ExpressionError: as `scalar`.
    """
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        raise MechanismError(f"{place} needs three components along x, y, z, not {values!r}")
    parts = list(values)
    if len(parts) != 3:
        raise MechanismError(f"{place} needs three components along x, y, z, not {len(parts)}: {values!r}")
    x, y, z = (scalar(part, place) for part in parts)
    return x, y, z


def place(given: object, where: str) -> Placement:
    """A placement, or a point as the placement there without a rotation.

    Raises:
        MechanismError, ExpressionError: it is neither, or its components are wrong.
    """
    if not isinstance(given, Placement):
        return Placement(triple(given, where))
    turns = tuple(
        turn if turn.radians is None else Rotation(turn.axis, turn.degrees, scalar(turn.radians, where))
        for turn in given.rotations
    )
    return Placement(triple(given.position, where), turns)


def grouped(value: Scalar) -> str:
    """A scalar as a factor of a text: in parentheses unless it is a name or a plain number."""
    text = str(value)
    return text if text.replace("_", "a").isalnum() or text.replace(".", "0", 1).isdigit() else f"({text})"


def _number(value: object, place: str) -> Scalar:
    """int, float or Fraction from any real number type, NumPy's too."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise ExpressionError(f"{place}: expected a number or an expression, not {value!r}")
    if isinstance(value, Integral):
        return int(value)
    if isinstance(value, Rational):
        return Fraction(int(value.numerator), int(value.denominator))
    number = float(value)
    if not math.isfinite(number):
        raise ExpressionError(f"{place}: a number must be finite, not {number}")
    if number and not _LEAST <= abs(number) <= 1 / _LEAST:
        raise ExpressionError(f"{place}: {number} is no size of anything: zero, or between {_LEAST} and {1 / _LEAST}")
    return number


def _symbolic(expression: object, place: str) -> str:
    try:
        return _Writer(place).text(expression)[0]
    except RecursionError:
        raise ExpressionError(f"{place}: the expression is too deeply nested for a text of the grammar") from None


class _Writer:
    """Walks one expression of SymPy or SymEngine: only `args`, the class and the numbers' own attributes are used."""

    def __init__(self, place: str) -> None:
        self.place = place
        self.nodes = 0

    def text(self, node: Any) -> _Text:
        self.nodes += 1
        if self.nodes > _MOST_NODES:
            raise ExpressionError(f"{self.place}: the expression is too large for a text of the grammar")
        kind = type(node).__name__
        if not hasattr(node, "args"):
            raise self._outside(f"{kind} is no scalar expression")
        if getattr(node, "is_Symbol", False):
            return str(node.name), _ATOM
        if getattr(node, "is_Integer", False) or getattr(node, "is_Rational", False):
            return self._rational(node)
        if getattr(node, "is_Float", False):
            return self._float(node)
        if kind == "Pi":
            return "pi", _ATOM
        if kind == "Add":
            return self._sum(node.args)
        if kind == "Mul":
            return self._product(node.args)
        if kind == "Pow":
            return self._power(node.args[0], node.args[1])
        if kind in _FUNCTIONS:
            return f"{kind}({self.text(node.args[0])[0]})", _ATOM
        if kind in _RECIPROCAL:
            return _RECIPROCAL[kind].format(self.text(node.args[0])[0]), _PRODUCT
        return self._in_time(node), _ATOM

    def _rational(self, node: Any) -> _Text:
        above, _, below = str(node).partition("/")
        return str(node), _SUM if above.startswith("-") else _PRODUCT if below else _ATOM

    def _float(self, node: Any) -> _Text:
        number = float(node)
        if not math.isfinite(number) or (number == 0 and node != 0):
            raise self._outside(f"the number {node} is not in the range of doubles")
        return repr(number), _SUM if number < 0 else _ATOM

    def _sum(self, terms: Sequence[Any]) -> _Text:
        parts = [self.text(term)[0] for term in terms]
        joined = "".join(f" - {part[1:]}" if part.startswith("-") else f" + {part}" for part in parts)
        return joined.removeprefix(" + ") if not parts[0].startswith("-") else f"-{joined[3:]}", _SUM

    def _product(self, factors: Sequence[Any]) -> _Text:
        """Factors above the line, then each one below it after a slash; a sign in front."""
        sign, above, below = "", [], []
        for factor in factors:
            exponent = factor.args[1] if type(factor).__name__ == "Pow" else None
            if exponent is not None and str(exponent).startswith("-"):
                below.append(self._closed(self._power(factor.args[0], -exponent), _POWER))
                continue
            text, tie = self.text(factor)
            if getattr(factor, "is_Rational", False) or getattr(factor, "is_Float", False):
                if text.startswith("-"):
                    sign, text = "-" if not sign else "", text[1:]
                number, _, divisor = text.partition("/")
                below += [divisor] if divisor else []
                above += [number] if number != "1" else []
            else:
                above.append(self._closed((text, tie), _POWER))
        text = "*".join(above) or "1"
        return sign + text + "".join(f"/{part}" for part in below), _SUM if sign else _PRODUCT

    def _power(self, base: Any, exponent: Any) -> _Text:
        """Whole and half exponents; a negative one below the line."""
        twice = _twice(exponent)
        if twice is None:
            raise self._outside(f"the power {base}**({exponent}): exponents are whole or halves")
        size = abs(twice)
        text, tie = self.text(base)
        whole = size // 2
        if size % 2:
            root = f"sqrt({text})"
            made = (root if size == 1 else f"{root}^{size}", _POWER)
        else:
            made = (f"{self._closed((text, tie), _ATOM)}^{whole}", _POWER) if whole != 1 else (text, tie)
        return made if twice > 0 else (f"1/{self._closed(made, _POWER)}", _PRODUCT)

    def _in_time(self, node: Any) -> str:
        """f(t) is the coordinate f, Derivative(f(t), t) its rate."""
        kind, parts = type(node).__name__, [str(part) for part in node.args]
        if kind == "Derivative" and _undefined(node.args[0]):
            if parts[1:] in (["t"], ["(t, 1)"]):
                return f"{self._in_time(node.args[0])}_dot"
            raise self._outside(f"{node}: of derivatives there are only first ones by t, as rates")
        if _undefined(node) and parts == ["t"]:
            return str(node).partition("(")[0]
        raise self._outside(f"{kind} in {str(node)[:60]}")

    def _closed(self, made: _Text, least: int) -> str:
        text, tie = made
        return text if tie >= least else f"({text})"

    def _outside(self, what: str) -> ExpressionError:
        return ExpressionError(
            f"{self.place}: {what} is outside the grammar; allowed: numbers, names, + - * / ^, sqrt, sin, cos, "
            "tan, pi, and f(t) with its first derivative for a coordinate and its rate"
        )


def _twice(exponent: Any) -> int | None:
    """2 n for an exponent n that is whole or a half, or None."""
    try:
        doubled = 2 * Fraction(str(exponent))
    except (ValueError, ZeroDivisionError):
        return None
    return doubled.numerator if doubled.denominator == 1 and doubled else None


def _undefined(node: Any) -> bool:
    """Whether it is a function without a meaning, such as q(t)."""
    return any(kind.__name__ in ("AppliedUndef", "FunctionSymbol") for kind in type(node).__mro__)
