"""Scalars of any origin become numbers and texts of the grammar, digit by digit."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from nullbody.errors import ExpressionError, MechanismError
from nullbody.expr.parse import parse
from nullbody.mechanism.builder.text import scalar, triple

VALUES = {"x": 0.7, "y": -1.3, "x_dot": 0.2, "q": 0.4, "q_dot": -0.6, "lambda_": 2.5}


@pytest.mark.parametrize(
    ("given", "kept"),
    [(1, 1), (0.1, 0.1), (Fraction(1, 3), Fraction(1, 3)), ("r/2", "r/2"), (np.float32(0.5), 0.5), (np.int64(3), 3)],
)
def test_numbers_and_texts(given: Any, kept: Any) -> None:
    found = scalar(given, "here")
    assert (found, type(found)) == (kept, type(kept))


@pytest.mark.parametrize(
    "given", [True, None, math.nan, math.inf, 1j, [1], {"x": 1}, object(), "__import__('os')", "x[0]"]
)
def test_anything_else_is_refused_with_its_place(given: Any) -> None:
    with pytest.raises(ExpressionError, match=r"^the place: "):
        scalar(given, "the place")


@pytest.mark.parametrize("given", ["xyz", 3, (1, 2), (1, 2, 3, 4), None])
def test_three_components(given: Any) -> None:
    with pytest.raises(MechanismError, match="three components"):
        triple(given, "the place")


def expressions(library: Any) -> list[Any]:
    """Expressions of SymPy or SymEngine that the grammar has."""
    x, y, t = library.symbols("x y t")
    q = library.Function("q")(t)
    half = library.Rational(1, 2)
    return [
        x - y,
        -x * (x - y) ** 2 / 3,
        x**-2 * y,
        2 / (3 * x * (y - 1)),
        library.sqrt(x + 2) ** 3,
        (x + 2) ** (-half),
        library.sin(x) * library.cos(y - x) - library.tan(x / 2),
        library.cot(x) + library.sec(y) * library.csc(x),
        library.pi * x / 2 - library.Rational(-2, 7),
        x**2**2,
        (-x) ** 3,
        library.Rational(-2, 3) ** 2 * x,
        (x**2) ** half - -y,
        -(x + y),
        x * -0.1,
        library.Integer(-4) * x,
        q.diff(t) ** 2 / 2 - q * x,
        library.Symbol("x_dot") * library.cos(x) - library.Symbol("lambda_"),
        -x / y,
        library.sin(-x) / -y,
    ]


@pytest.mark.parametrize("name", ["sympy", "symengine"])
def test_expressions_keep_their_value(name: str) -> None:
    library = pytest.importorskip(name)
    for expression in expressions(library):
        text = scalar(expression, "here")
        t, q = library.Symbol("t"), library.Function("q")(library.Symbol("t"))
        plain = expression.subs({q.diff(t): library.Symbol("q_dot")}).subs({q: library.Symbol("q")})
        wanted = float(plain.subs({library.Symbol(key): value for key, value in VALUES.items()}))
        assert parse(text, VALUES.__getitem__) == pytest.approx(wanted, rel=1e-14), (expression, text)


@pytest.mark.parametrize("name", ["sympy", "symengine"])
def test_every_digit_of_a_number_stays(name: str) -> None:
    library = pytest.importorskip(name)
    number = 0.1 + 0.2
    assert parse(scalar(library.Symbol("x") * number, "here"), lambda _: 1.0) == number


@pytest.mark.parametrize("name", ["sympy", "symengine"])
def test_what_the_grammar_has_no_word_for_is_named(name: str) -> None:
    library = pytest.importorskip(name)
    x, t = library.symbols("x t")
    f = library.Function("f")(t)
    for given in (
        library.exp(x),
        x ** library.Rational(1, 3),
        x**x,
        library.I * x,
        library.atan2(x, t),
        f.diff(t).diff(t),
        library.Function("g")(x),
        library.log(t),
        library.Symbol("x y"),
    ):
        with pytest.raises(ExpressionError, match=r"^the place: "):
            scalar(given, "the place")


def test_matrices_and_relations_are_no_scalars() -> None:
    sympy = pytest.importorskip("sympy")
    x = sympy.Symbol("x")
    for given in (sympy.Matrix([x]), sympy.Eq(x, 1), x < 1, sympy.oo, sympy.nan, sympy.Float("1e400") * x):
        with pytest.raises(ExpressionError):
            scalar(given, "here")


def test_an_expression_that_grows_without_limit_is_refused() -> None:
    sympy = pytest.importorskip("sympy")
    x = sympy.Symbol("x")
    for _ in range(13):
        x = sympy.Add(sympy.sin(x, evaluate=False), sympy.cos(x, evaluate=False), evaluate=False)
    with pytest.raises(ExpressionError, match="too large"):
        scalar(x, "here")
