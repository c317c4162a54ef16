"""The small grammar of expressions in model files: numbers, names, + - * / ^, sqrt, sin, cos, tan, pi.

    sum     = product (("+" | "-") product)*
    product = factor (("*" | "/") factor)*
    factor  = ("+" | "-") factor | power
    power   = atom (("^" | "**") factor)?        with a constant integer exponent
    atom    = number | name | function "(" sum ")" | "(" sum ")"

Text is never evaluated as Python: a token outside this list is an `ExpressionError`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any, NoReturn

from nullbody.errors import ExpressionError, UnknownName

__all__ = ["FLOAT_FUNCTIONS", "names_in", "parse"]

_TOKEN = re.compile(
    r"\s*(?:(\d+\.?\d*(?:[eE][+-]?\d+)?|\.\d+(?:[eE][+-]?\d+)?)|([A-Za-z_]\w*)|(\*\*|[-+*/^()]))", re.ASCII
)
_Token = tuple[str, str, int]
_LONGEST = 4000  # characters
_DEEPEST = 40  # nested parentheses and signs
_LARGEST = 1 << 15  # bits of a fraction: no double is near, and each sum of two such would double them
_LARGEST_EXPONENT = 64  # of nested powers together: exact numbers would grow without limit

#: The functions of the grammar on doubles.
FLOAT_FUNCTIONS: Mapping[str, Callable[[Any], Any]] = {
    "sqrt": math.sqrt,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
}


def parse(
    source: str | int | float | Fraction,
    name: Callable[[str], Any],
    constant: Callable[[Fraction], Any] = float,
    functions: Mapping[str, Callable[[Any], Any]] = FLOAT_FUNCTIONS,
) -> Any:
    """Read an expression in any number type.

    Args:
        source: the text, or a number.
        name: what a name stands for; raises for an unknown one.
        constant: turns a Fraction into the number type.
        functions: sqrt, sin, cos and tan of the number type.

    Raises:
        ExpressionError: the text is not in the grammar; the message marks the place.
    """
    if isinstance(source, bool) or not isinstance(source, str | int | float | Fraction):
        raise ExpressionError(f"expected a number or an expression, not {source!r}")
    if not isinstance(source, str):
        if isinstance(source, float) and not math.isfinite(source):
            raise ExpressionError(f"a number must be finite, not {source}")
        try:
            return constant(Fraction(repr(float(source))) if isinstance(source, float) else Fraction(source))
        except OverflowError:
            raise ExpressionError("a number must lie in the range of doubles, about 1e308") from None
    return _Parser(source, name, constant, functions).whole()


def names_in(source: str | int | float | Fraction) -> frozenset[str]:
    """The parameter names that an expression uses."""
    names: set[str] = set()

    def collect(name: str) -> _Unknown:
        names.add(name)
        return _Unknown()

    functions = {key: lambda _: _Unknown() for key in FLOAT_FUNCTIONS}
    if isinstance(source, str):
        _Parser(source, collect, lambda number: number, functions).whole()
    return frozenset(names)


class _Unknown:
    """A number that is not known yet: what is made of it is not known either."""

    def _combined(self, _: object) -> _Unknown:
        return self

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __rtruediv__ = _combined

    def __truediv__(self, other: object) -> _Unknown:
        if other == 0:
            raise ZeroDivisionError
        return self

    def __neg__(self) -> _Unknown:
        return self


class _Parser:
    """Recursive descent over the tokens of one text."""

    def __init__(
        self,
        source: str,
        name: Callable[[str], Any],
        constant: Callable[[Fraction], Any],
        functions: Mapping[str, Callable[[Any], Any]],
    ) -> None:
        if len(source) > _LONGEST:
            raise ExpressionError(f"an expression has at most {_LONGEST} characters, not {len(source)}")
        self.source, self.name, self.constant, self.functions = source, name, constant, functions
        self.tokens = self._tokens()
        self.next = 0
        self.depth = 0
        self.degree = 1  # the largest exponent of what was read last, nested powers multiplied

    def _tokens(self) -> list[_Token]:
        tokens: list[_Token] = []
        place = 0
        text = self.source.rstrip()
        while place < len(text):
            match = _TOKEN.match(text, place)
            if match is None:
                self._fail("unexpected character", len(text) - len(text[place:].lstrip()))
            number, word, sign = match.groups()
            kind = "number" if number else "name" if word else "sign"
            tokens.append((kind, number or word or sign, match.start(match.lastindex or 0)))
            place = match.end()
        return [*tokens, ("end", "", len(text))]

    def _fail(self, what: str, place: int) -> NoReturn:
        raise ExpressionError(
            f"{what} at character {place + 1} of {self.source[:80]!r}; "
            "allowed: numbers, parameters, + - * / ^, sqrt, sin, cos, tan, pi, ( )"
        )

    def _take(self, *signs: str) -> str | None:
        kind, word, _ = self.tokens[self.next]
        if kind == "sign" and word in signs:
            self.next += 1
            return word
        return None

    def whole(self) -> Any:
        value = self._sum()
        kind, word, place = self.tokens[self.next]
        if kind != "end":
            self._fail(f"unexpected {word!r}", place)
        if isinstance(value, float) and not math.isfinite(value):
            self._fail(f"the value is not finite ({value})", 0)
        return value

    def _sum(self) -> Any:
        value = self._product()
        while sign := self._take("+", "-"):
            other = self._product()
            value = self._bounded(value + other if sign == "+" else value - other)
        return value

    def _product(self) -> Any:
        value = self._factor()
        while sign := self._take("*", "/"):
            place = self.tokens[self.next][2]
            other = self._factor()
            try:
                value = self._bounded(value * other if sign == "*" else value / other)
            except ZeroDivisionError:
                self._fail("division by zero", place)
        return value

    def _bounded(self, value: Any) -> Any:
        """The value, unless it is a fraction that grows without limit."""
        if isinstance(value, Fraction) and (value.numerator | value.denominator).bit_length() > _LARGEST:
            self._fail("the numbers become too long", self.tokens[self.next][2])
        return value

    def _factor(self) -> Any:
        self.depth += 1
        if self.depth > _DEEPEST:
            self._fail("too deeply nested", self.tokens[self.next][2])
        sign = self._take("+", "-")
        value = self._power() if sign is None else self._factor() if sign == "+" else -self._factor()
        self.depth -= 1
        return value

    def _power(self) -> Any:
        outside, self.degree = self.degree, 1
        value = self._atom()
        if not self._take("^", "**"):
            self.degree = max(outside, self.degree)
            return value
        negative = self._take("-") is not None
        kind, word, place = self.tokens[self.next]
        exponent = int(word) if kind == "number" and word.isdigit() else _LARGEST_EXPONENT + 1
        self.degree *= max(exponent, 1)
        if self.degree > _LARGEST_EXPONENT:
            self._fail(
                f"an exponent, those of nested powers multiplied, is an integer of at most {_LARGEST_EXPONENT}", place
            )
        self.degree = max(outside, self.degree)
        self.next += 1
        result = self.constant(Fraction(1))
        for _ in range(exponent):
            result = self._bounded(result * value)
        try:
            return 1 / result if negative else result
        except ZeroDivisionError:
            return self._fail("division by zero", place)

    def _atom(self) -> Any:
        kind, word, place = self.tokens[self.next]
        self.next += 1
        if kind == "number":
            return self._number(word, place)
        if kind == "name" and word == "pi":
            return self.constant(Fraction(math.pi))
        if kind == "name" and word in self.functions:
            if not self._take("("):
                self._fail(f"{word} needs parentheses", place)
            return self._call(word, place)
        if kind == "name":
            try:
                return self.name(word)
            except KeyError:
                raise UnknownName("parameter", word, ()) from None
        if kind == "sign" and word == "(":
            return self._closed()
        return self._fail("the expression ends too early" if kind == "end" else f"unexpected {word!r}", place)

    def _number(self, word: str, place: int) -> Any:
        """A number in the range of doubles: 1e999999999 would take all memory as a fraction."""
        size = float(word)
        vanishes = not any(digit in "123456789" for digit in word.lower().partition("e")[0])
        if math.isinf(size) or (size == 0 and not vanishes):
            self._fail("a number outside the range of doubles", place)
        return self.constant(Fraction(0) if vanishes else Fraction(word))

    def _call(self, function: str, place: int) -> Any:
        argument = self._closed()
        try:
            return self.functions[function](argument)
        except ValueError as error:
            return self._fail(f"{function} has no real value here ({error})", place)

    def _closed(self) -> Any:
        value = self._sum()
        if not self._take(")"):
            self._fail("a closing parenthesis is missing", self.tokens[self.next][2])
        return value
