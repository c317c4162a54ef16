from __future__ import annotations

from fractions import Fraction

import pytest

from nullbody.expr import Expr, Graph, cos, sin
from nullbody.expr.bridge import SymPyBridge
from nullbody.expr.display import flat, latex_equation


@pytest.fixture
def shared() -> list[list[Expr]]:
    """A matrix whose entries share sin(x) y + x, and products with it."""
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    part = sin(x) * y + x
    return [[part, part * cos(y)], [part * cos(y) * x, x]]


def lines(shown: str) -> list[str]:
    begin, *middle, end = shown.splitlines()
    assert (begin, end) == (r"\begin{aligned}", r"\end{aligned}")
    assert all(line.endswith(r" \\") for line in middle[:-1])
    return [line.removesuffix(r" \\") for line in middle]


def test_shared_parts_come_first_or_last(shared: list[list[Expr]]) -> None:
    first = lines(latex_equation("N", shared))
    last = lines(latex_equation("N", shared, below=True))
    assert first[-1] == last[0] == r"N &= \begin{bmatrix} z_{1} & z_{2} \\ x \, z_{2} & x \end{bmatrix}"
    assert first[:-1] == last[1:]
    assert [line.partition(" &= ")[0] for line in last[1:]] == ["z_{1}", "z_{2}"]
    assert "z_{1}" in last[2].partition("&=")[2]


def test_names_of_symbols_are_given(shared: list[list[Expr]]) -> None:
    shown = latex_equation("", shared, {"x": r"\dot{q}", "y": "w", "unknown": "?"})
    assert r"\dot{q}" in shown
    assert not set("xy?") & set(shown.replace(r"\begin{bmatrix}", "").replace(r"\end{bmatrix}", ""))
    assert lines(shown)[-1].startswith(r"& \begin{bmatrix}")


def test_the_names_of_shared_parts_are_new() -> None:
    graph = Graph()
    part = sin(graph.symbol("z1")) * graph.symbol("y") + 1
    shown = lines(latex_equation("A", [[part, part * 2]]))
    assert shown[0] == r"z_{2} &= 1 + y \, \sin{z_{1}}"
    assert shown[-1] == r"A &= \begin{bmatrix} z_{2} & 2 \, z_{2} \end{bmatrix}"
    assert lines(latex_equation("A", [[part, part * 2]], {"y": "z_{2}"}))[0].startswith("z_{3} &= ")


def test_numbers_vectors_and_scalars() -> None:
    x = Graph().symbol("x")
    assert lines(latex_equation("I", [[1, 0], [0, Fraction(-1, 2)]])) == [
        r"I &= \begin{bmatrix} 1 & 0 \\ 0 & -\tfrac{1}{2} \end{bmatrix}"
    ]
    assert lines(latex_equation("v", [x, 2])) == [r"v &= \begin{bmatrix} x \\ 2 \end{bmatrix}"]
    assert lines(latex_equation("s", -x)) == ["s &= -x"]
    assert list(flat([[x, 1], [2]])) == [x, 1, 2]


def test_latex_of_sympy_names() -> None:
    sp = pytest.importorskip("sympy")
    bridge = SymPyBridge(Graph())
    t = sp.Symbol("t")
    entry = bridge.read(sp.Function("q")(t).diff(t) * sp.exp(sp.Symbol("alpha")))
    shown = latex_equation("A", [[entry]], bridge.latex_names())
    assert r"\frac{d}{d t} q{\left(t \right)}" in shown
    assert r"e^{\alpha}" in shown
