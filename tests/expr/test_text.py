from __future__ import annotations

import re
from fractions import Fraction

import pytest
from hypothesis import given

from nullbody.expr import Graph, Tape, cos, latex, sin, sqrt, text
from nullbody.expr.parse import parse
from nullbody.expr.text import latex_symbol
from tests.expr.random_expression import NAMES, build, graph_algebra, points, programs


@given(programs(), points())
def test_text_reads_back_to_the_same_value(program: list, point: list[float]) -> None:
    expression = build(program, graph_algebra(Graph()))
    shown = text(expression)
    if len(shown) > 500:
        return
    found = parse(shown, dict(zip(NAMES, point, strict=True)).__getitem__)
    assert found == pytest.approx(Tape.of([expression], NAMES).run(point)[0], rel=1e-9, abs=1e-9)


@given(programs())
def test_latex_is_balanced(program: list) -> None:
    shown = latex(build(program, graph_algebra(Graph())))
    assert balanced(shown)
    assert "+ -" not in shown
    assert "- -" not in shown
    assert "*" not in shown


def balanced(shown: str) -> bool:
    depth = 0
    for sign in re.sub(r"\\[{}]", "", shown):
        depth += (sign == "{") - (sign == "}")
        if depth < 0:
            return False
    return depth == 0 and shown.count(r"\left") == shown.count(r"\right")


def test_balanced_sees_a_planted_brace() -> None:
    assert balanced(r"\frac{1}{\left(x\right)}")
    assert not balanced(r"\frac{1}{x")
    assert not balanced(r"}x{")
    assert not balanced(r"\left(x)")


def test_names_stand_for_nodes() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    inner = x * y
    assert "xy" in text(sin(inner) + 1, {inner.ref >> 1: "xy"})
    assert latex(inner - x, {inner.ref >> 1: "z_{1}"}).count("z_{1}") == 1


def test_small_expressions_are_short() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    assert text(-x) == "-x"
    assert text(x - y) == "x - y"
    assert text(graph.constant(Fraction(-1, 2))) == "-1/2"
    assert text(sin(x)) == "sin(x)"
    assert text(cos(x) * sin(y)) in ("cos(x)*sin(y)", "sin(y)*cos(x)")
    assert text(sqrt(x)) == "sqrt(x)"
    assert repr(x + y) == text(x + y)


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("x", "x"),
        ("alpha1", r"\alpha_{1}"),
        ("Ixx", "I_{xx}"),
        ("s1_dot", r"\dot{s_{1}}"),
        ("psi", r"\psi"),
        ("psi_dot", r"\dot{\psi}"),
    ],
)
def test_names_in_latex(name: str, shown: str) -> None:
    assert latex_symbol(name) == shown


def test_what_does_not_fit_a_screen_is_described() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    assert repr(x + y) == "x + y"
    for _ in range(400):
        x = x * x + y
    assert repr(x) == "<Expr of 800 (400 +, 400 *) operations, 1e+18 symbols when written out: see text()>"
