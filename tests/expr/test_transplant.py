from __future__ import annotations

from nullbody.expr import Graph, Tape, cos, sin, sqrt
from nullbody.expr.transplant import transplant


def test_the_same_functions_in_another_graph() -> None:
    source, target = Graph(), Graph(seed=5)
    target.symbol("y")
    x, y = source.symbol("x"), source.symbol("y")
    functions = [-(x + y), sin(x) * y - 3, 1 / (x - y), sqrt(x * x + 1) / 3 - cos(y), x, -y, source.constant(0)]
    moved = transplant(functions, target)
    assert all(f.graph is target for f in moved)
    values = [Tape.of(group, ("x", "y")).run([0.3, 0.8]) for group in (functions, moved)]
    assert values[0] == values[1]
    assert moved[-1] == 0
    assert target.verify() >= 0


def test_it_keeps_only_what_is_needed() -> None:
    source, target = Graph(), Graph()
    x = source.symbol("x")
    source.symbol("unused")
    assert sin(x) != cos(x)
    transplant([x * x], target)
    assert target.symbols == ["x"]
    assert transplant([], target) == []


def test_an_identity_holds_at_the_other_point_too() -> None:
    source = Graph()
    x = source.symbol("x")
    one = sin(x) * sin(x) + cos(x) * cos(x)
    assert transplant([one], Graph(seed=9)) == [1]
