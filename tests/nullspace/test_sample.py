from __future__ import annotations

from fractions import Fraction
from math import cos, inf, sqrt
from typing import Any

import numpy as np
import pytest
import sympy

from nullbody.errors import InputError, UnknownName
from nullbody.expr import Exact, Graph
from nullbody.expr import cos as cosine
from nullbody.nullspace import null_space
from nullbody.nullspace.sample import double, generic_point, largest_singular_value, sampled

HUGE = Fraction(10**400)


def test_generic_numbers_depend_on_the_name_alone() -> None:
    names = [f"x{k}" for k in range(200)]
    point = generic_point(names)
    assert generic_point(["x7"])["x7"] == point["x7"]
    assert 0.5 <= min(point.values()) < 0.52
    assert 1.48 < max(point.values()) <= 1.5


def test_entries_of_all_kinds_at_several_points() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    rows = [[0, 1, Fraction(1, 4)], [Exact.square_root(2), cosine(x) * y, x / y]]
    values = sampled(rows, [{"x": 1.0, "y": 2.0}, {"x": 0.0, "y": -1.0}])
    assert values.shape == (2, 2, 3)
    assert values[0] == pytest.approx(np.array([[0, 1, 0.25], [sqrt(2), 2 * cos(1), 0.5]]), rel=1e-15)
    assert values[1, 1] == pytest.approx([sqrt(2), -1, 0])


def test_symbols_that_are_left_out_are_generic() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    ((row,),) = sampled([[x, y]], [{"y": 3.0}])
    assert row.tolist() == [generic_point(["x"])["x"], 3.0]


def test_largest_singular_value_is_the_norm_of_the_basis() -> None:
    assert largest_singular_value([[3, 0], [0, 4], [0, 0]], {}) == pytest.approx(4)
    space = null_space([[1, 2, 2]], [1, 2])
    assert space.condition == pytest.approx(3, rel=1e-15)  # N = [-2 -2; 1 0; 0 1]: N^T N = I + 4 [1 1; 1 1]
    assert largest_singular_value([], {}) == 0


def test_infinite_where_the_determinant_vanishes() -> None:
    graph = Graph()
    x = graph.symbol("x")
    space = null_space([[x, 1 + x]], [1])
    assert space.condition_at({"x": 1e-3}) == pytest.approx(1001, rel=1e-5)
    assert space.condition_at({"x": 0.0}) == inf


@pytest.mark.parametrize("number", [HUGE, int(HUGE), Exact.of(HUGE)])
def test_numbers_of_any_size(number: Any) -> None:
    assert double(number) == inf
    assert double(-number) == -inf
    assert double(1 / HUGE) == 0
    assert largest_singular_value([[number], [1]], {}) == inf


def test_constants_of_a_graph_of_any_size() -> None:
    graph = Graph()
    assert largest_singular_value([[graph.symbol("x") * HUGE]], {}) == inf


def test_stand_ins_are_symbols() -> None:
    x = sympy.Symbol("x")
    condition = null_space(sympy.Matrix([[sympy.exp(x), x, sympy.pi]]), [1, 2]).condition
    assert 1 < condition < 10


def test_bad_points_are_refused() -> None:
    graph = Graph()
    rows = [[graph.symbol("alpha")]]
    with pytest.raises(UnknownName, match="the point: there is no symbol 'alfa'; did you mean 'alpha'"):
        sampled(rows, [{"alfa": 1.0}])
    with pytest.raises(UnknownName, match="known: none"):
        sampled([[1]], [{"x": 1.0}])
    for value in (float("nan"), inf, "1", None, True, 1j, 10**400):
        with pytest.raises(InputError, match="alpha must be a finite number"):
            sampled(rows, [{"alpha": value}])  # type: ignore[dict-item]
