from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nullbody.errors import ExpressionError, UnknownName
from nullbody.expr import Graph, cos, sin, sqrt
from nullbody.expr.parse import names_in, parse

VALUES = {"a": 2.0, "b": 3.0, "l_1": 0.5}


def _number(source: object) -> float:
    return parse(source, VALUES.__getitem__)


@pytest.mark.parametrize(
    ("source", "value"),
    [
        ("1", 1.0),
        (" 1.5e-3 ", 1.5e-3),
        (".5", 0.5),
        ("2.", 2.0),
        ("a + b*l_1", 3.5),
        ("a - b - 1", -2.0),
        ("a/b/2", 1 / 3),
        ("-a^2", -4.0),
        ("(-a)^2", 4.0),
        ("2^-1", 0.5),
        ("a**3", 8.0),
        ("a^0", 1.0),
        ("--a", 2.0),
        ("+-+a", -2.0),
        ("2*-3", -6.0),
        ("sqrt(a*b + 3)", 3.0),
        ("sin(pi/2) + cos(0)", 2.0),
        ("((((a))))", 2.0),
        ("0e999999999", 0.0),
        (7, 7.0),
        (0.25, 0.25),
        (Fraction(1, 4), 0.25),
    ],
)
def test_valid_expressions(source: object, value: float) -> None:
    assert _number(source) == pytest.approx(value, rel=1e-15)


MALICIOUS = [
    "__import__('os')",
    "a.real",
    "a[0]",
    "lambda: 1",
    "a if a else b",
    "a; b",
    "a\nb",
    "a = 1",
    "f'{a}'",
    "'a'",
    "a, b",
    "print(a)",
    "exp(a)",
    "sin a",
    "sin",
    "1 2",
    "a b",
    "2a",
    "",
    "   ",
    "+",
    "(",
    "a)",
    "(a",
    "a +",
    "* a",
    "2**10**9",
    "2^65",
    "2^a",
    "2^1.5",
    "2^(1)",
    "((2^8)^8)^8",
    "1e999999999",
    "1e-999999999",
    "1e309",
    "0x10",
    "1_000",
    "1j",
    "nan",
    "inf",
    "∞",
    "α",
    "a·b",
    "٣",
    "２",
    "a²",
    "a\x00",
    "1/0",
    "1/(2 - 2)",
    "0^-1",
    "sqrt(-1)",
    "sqrt(0 - a)",
    "9e300*9e300",
    "1" + "+1" * 4000,
    "(" * 100 + "1" + ")" * 100,
    "-" * 100 + "1",
]


@pytest.mark.parametrize("source", MALICIOUS)
def test_everything_else_is_an_error_of_its_own_kind(source: str) -> None:
    with pytest.raises((ExpressionError, UnknownName)):
        _number(source)


@given(st.text(alphabet="ab01.e+-*/^() sqrtincopi_'\"[]{}", max_size=25))
def test_no_text_ends_in_another_error(source: str) -> None:
    graph = Graph()
    try:
        _number(source)
        parse(source, graph.symbol, graph.constant, {"sin": sin, "cos": cos, "sqrt": sqrt})
    except (ExpressionError, UnknownName) as error:
        assert str(error)


@pytest.mark.parametrize("source", [True, None, [1], b"1", 1j, float("nan"), float("-inf"), 10**400])
def test_other_types_and_numbers_that_are_not_finite(source: object) -> None:
    with pytest.raises(ExpressionError, match=r"finite|expected a number|range of doubles"):
        _number(source)


def test_the_message_marks_the_place() -> None:
    with pytest.raises(ExpressionError, match=r"at character 5 of 'a \+ \?b'; allowed: numbers, parameters"):
        _number("a + ?b")


def test_in_a_graph_constants_are_exact() -> None:
    graph = Graph()
    functions = {"sin": sin, "cos": cos, "sqrt": sqrt}
    b = graph.symbol("b")
    assert parse("sqrt(3)/2*b - 0.1", graph.symbol, graph.constant, functions) == sqrt(
        graph.constant(3)
    ) * b / 2 - Fraction(1, 10)
    assert parse("sqrt(b)*sqrt(b)", graph.symbol, graph.constant, functions) == b
    with pytest.raises(ExpressionError, match="division by zero"):
        parse("1/(b - b)", graph.symbol, graph.constant, functions)


@pytest.mark.parametrize("source", ["sqrt(1000000007*1000000009)", "sqrt(pi)", "sqrt(0.12345678912345678)"])
def test_roots_of_large_numbers_are_read_at_once(source: str) -> None:
    graph = Graph()
    value = parse(source, graph.symbol, graph.constant, {"sqrt": sqrt})
    assert value * value == parse(source.replace("sqrt", ""), graph.symbol, graph.constant)
    assert _number(source) > 0


@pytest.mark.parametrize(
    ("source", "names"),
    [
        ("m*l^2/12", {"m", "l"}),
        ("sin(x) + pi", {"x"}),
        ("1/(a - b)", {"a", "b"}),
        ("sqrt(0 - a)", {"a"}),
        ("2", set()),
        (2.5, set()),
    ],
)
def test_names_in_an_expression_whatever_their_values(source: object, names: set[str]) -> None:
    assert names_in(source) == names


def test_names_in_still_checks_the_grammar() -> None:
    for source in ("a +", "1/(3 - 3)", "a^b", "__import__('os')"):
        with pytest.raises(ExpressionError):
            names_in(source)


def test_pi_is_the_double() -> None:
    assert _number("pi") == math.pi
