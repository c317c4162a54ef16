from __future__ import annotations

import cmath
import math
from fractions import Fraction

import pytest
import sympy
from hypothesis import given

from nullbody.errors import InputError
from nullbody.expr import (
    Expr,
    Graph,
    Tape,
    calculus,
    cos,
    derivative,
    directional,
    gradient,
    jacobian,
    operations,
    sin,
    sqrt,
    substitute,
)
from tests.expr.random_expression import FLOATS, NAMES, Algebra, build, graph_algebra, points, programs

COMPLEX = {"sin": cmath.sin, "cos": cmath.cos, "sqrt": cmath.sqrt}


def _value(expression: Expr, point: list[float]) -> float:
    return Tape.of([expression], NAMES).run(point)[0]


@pytest.fixture
def graph() -> Graph:
    return Graph()


def test_table_of_derivatives(graph: Graph) -> None:
    x, y = graph.symbol("x"), graph.symbol("y")
    assert derivative(x**3, x) == 3 * x * x
    assert derivative(x * y, x) == y
    assert derivative(sin(2 * x), x) == 2 * cos(2 * x)
    assert derivative(cos(x), x) == -sin(x)
    assert derivative(1 / x, x) == -1 / (x * x)
    assert derivative(sqrt(x), x) == 1 / (2 * sqrt(x))
    assert derivative(y, x) == 0 == derivative(graph.constant(7), x)


@given(programs(), points())
def test_derivative_equals_the_complex_step(program: list, point: list[float]) -> None:
    graph = Graph()
    function = build(program, graph_algebra(graph))
    tape = Tape.of([function], NAMES)
    for k, name in enumerate(NAMES):
        shifted = [complex(x, 1e-30 * (j == k)) for j, x in enumerate(point)]
        expected = complex(tape.run(shifted, COMPLEX)[0]).imag / 1e-30
        assert _value(derivative(function, graph.symbol(name)), point) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@given(programs(longest=6), points())
def test_derivative_equals_sympy(program: list, point: list[float]) -> None:
    graph = Graph()
    symbols = sympy.symbols(NAMES)
    constant = lambda number: sympy.Rational(number.numerator, number.denominator)  # noqa: E731
    functions = {"sin": sympy.sin, "cos": sympy.cos, "sqrt": sympy.sqrt}
    theirs = sympy.sympify(0) + build(program, Algebra(symbols, constant, functions))
    ours = build(program, graph_algebra(graph))
    at = dict(zip(symbols, (sympy.Rational(str(x)) for x in point), strict=True))
    expected = float(theirs.diff(symbols[0]).subs(at).evalf(20))
    assert _value(derivative(ours, graph.symbol("x")), point) == pytest.approx(expected, rel=1e-10, abs=1e-10)


@given(programs())
def test_mixed_derivatives_commute(program: list) -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    function = build([step for step in program if step[0] != "sqrt"] or [("add", 0, 1)], graph_algebra(graph))
    assert derivative(derivative(function, x), y) == derivative(derivative(function, y), x)


@given(programs())
def test_directional_is_the_jacobian_times_the_direction(program: list) -> None:
    graph = Graph()
    function = build([step for step in program if step[0] != "sqrt"] or [("add", 0, 1)], graph_algebra(graph))
    q = [graph.symbol(name) for name in NAMES]
    v = [graph.symbol(f"v{name}") for name in NAMES]
    (row,) = jacobian([function], q)
    expected = row[0] * v[0] + row[1] * v[1] + row[2] * v[2]
    assert directional([function], dict(zip(q, v, strict=True)))[0] == expected


def test_directional_of_a_shared_and_a_negated_function(graph: Graph) -> None:
    x, y, v = graph.symbol("x"), graph.symbol("y"), graph.symbol("v")
    product = x * y
    assert directional([-product, product, y, -x], {x: v}) == [-v * y, v * y, graph.constant(0), -v]
    assert directional([], {x: v}) == []
    assert directional([product], {}) == [0]


def test_jacobian_has_a_row_for_each_function(graph: Graph) -> None:
    x, y = graph.symbol("x"), graph.symbol("y")
    assert jacobian([x * y, x - y, graph.constant(1)], [x, y]) == [[y, x], [1, -1], [0, 0]]


def test_jacobian_of_nothing_has_no_rows_and_refuses_what_is_no_symbol(graph: Graph) -> None:
    x = graph.symbol("x")
    assert jacobian([], [x]) == []
    assert jacobian([x, -x], []) == [[], []]
    for wrong in (x * x, -x):
        with pytest.raises(InputError, match="expected a symbol"):
            jacobian([x], [wrong])
    with pytest.raises(InputError, match="different graphs"):
        jacobian([x], [Graph().symbol("x")])


@given(programs())
def test_gradient_is_the_row_of_the_jacobian(program: list) -> None:
    """Exactly: both become the same nodes, since their values in the prime field are equal."""
    graph = Graph()
    function = build(program, graph_algebra(graph))
    symbols = [graph.symbol(name) for name in NAMES]
    (row,) = jacobian([function], symbols)
    assert [graph.value(slope.ref) for slope in gradient(function, symbols)] == [graph.value(x.ref) for x in row]


def test_gradient_of_signs_shared_parts_and_constants(graph: Graph) -> None:
    x, y = graph.symbol("x"), graph.symbol("y")
    assert gradient(-(x * y), [x, y]) == [-y, -x]
    assert gradient(-x, [x, y]) == [-1, 0]
    assert gradient(graph.constant(2), [x]) == [0]
    assert gradient(x - (y - x) ** 2, [x, y]) == [1 + 2 * (y - x), -2 * (y - x)]
    assert gradient(sqrt(x) / cos(y), [x, y]) == jacobian([sqrt(x) / cos(y)], [x, y])[0]
    with pytest.raises(InputError, match="expected a symbol"):
        gradient(x, [x * y])


def test_gradient_takes_at_most_four_times_the_operations_whatever_the_number_of_symbols(graph: Graph) -> None:
    symbols = [graph.symbol(f"x{k}") for k in range(40)]
    product = symbols[0]
    for k, x in enumerate(symbols[1:]):
        product = sin(product * x) if k % 3 else product * x + x
    count = operations([product]).arithmetic
    forward = operations(jacobian([product], symbols)[0]).arithmetic
    backward = Graph()
    again = [backward.symbol(f"x{k}") for k in range(40)]
    product = again[0]
    for k, x in enumerate(again[1:]):
        product = sin(product * x) if k % 3 else product * x + x
    reverse = operations(gradient(product, again)).arithmetic
    assert reverse <= 4 * count < forward


@pytest.mark.parametrize("operation", ["add", "sub", "mul", "sin", "cos", "inv", "sqrt"])
def test_a_planted_sign_error_is_caught(operation: str, monkeypatch: pytest.MonkeyPatch) -> None:
    right = calculus._tangent

    def wrong(graph: Graph, node: int, tangent: dict[int, int]) -> int:
        ref = right(graph, node, tangent)
        return graph.negate(ref) if graph.code[node][0] == operation else ref

    def error() -> float:
        graph = Graph()
        x, y, _ = (graph.symbol(name) for name in NAMES)
        function = x * sin(x + y) - y * cos(x) + 1 / (2 + x) + sqrt(3 + x * y) + x
        point = [0.3, 0.7, 0.1]
        shifted = [complex(value, 1e-30 * (name == "x")) for name, value in zip(NAMES, point, strict=True)]
        expected = complex(Tape.of([function], NAMES).run(shifted, COMPLEX)[0]).imag / 1e-30
        return abs(_value(derivative(function, x), point) - expected)

    assert error() < 1e-14
    monkeypatch.setattr(calculus, "_tangent", wrong)
    assert error() > 1e-3


@given(programs(), points())
def test_substitute_equals_evaluation_at_the_image(program: list, point: list[float]) -> None:
    graph = Graph()
    function = build(program, graph_algebra(graph))
    x, y, z = (graph.symbol(name) for name in NAMES)
    (changed,) = substitute([function], {x: y - 2 * z, y: x * z})
    image = [point[1] - 2 * point[2], point[0] * point[2], point[2]]
    assert _value(changed, point) == pytest.approx(_value(function, image), rel=1e-9, abs=1e-9)


def test_substitute_is_simultaneous_and_keeps_signs(graph: Graph) -> None:
    x, y = graph.symbol("x"), graph.symbol("y")
    assert substitute([x - 2 * y, -x], {x: y, y: x}) == [y - 2 * x, -y]
    assert substitute([x * x], {x: x + 1}) == [(x + 1) ** 2]
    assert substitute([sin(x) + cos(y)], {x: -x}) == [cos(y) - sin(x)]
    assert substitute([], {x: y}) == []


def test_substitute_gets_rid_of_the_symbol_for_good(graph: Graph) -> None:
    """Although the value of the older node, written with z, does not depend on z."""
    x, y, z = (graph.symbol(name) for name in NAMES)
    with_z = sin(z * x) * sin(z * x) * y + cos(z * x) * cos(z * x) * y + sin(y * x)
    without = y + sin(y * x)
    (changed,) = substitute([with_z], {z: graph.constant(3)})
    assert changed == substitute([without], {z: graph.constant(3)})[0] == without
    for expression in (changed, without):
        assert "z" not in {
            graph.symbols[graph.code[n][1]] for n in graph.reachable([expression.ref]) if graph.code[n][0] == "symbol"
        }


def test_substitute_a_constant_folds(graph: Graph) -> None:
    x, y = graph.symbol("x"), graph.symbol("y")
    assert substitute([x * y + sin(y), 1 / (1 + x)], {y: graph.constant(0), x: graph.constant(3)}) == [
        0,
        Fraction(1, 4),
    ]


def test_substituting_a_zero_below_a_fraction_is_an_error(graph: Graph) -> None:
    x = graph.symbol("x")
    with pytest.raises(ZeroDivisionError):
        substitute([1 / x], {x: graph.constant(0)})


@pytest.mark.parametrize("key", [lambda x: -x, lambda x: x * x, lambda x: x.graph.constant(2)])
def test_only_symbols_are_varied(graph: Graph, key) -> None:
    x = graph.symbol("x")
    for operation in (directional, substitute):
        with pytest.raises(InputError, match="expected a symbol"):
            operation([x * x], {key(x): x})


def test_symbols_of_another_graph_are_refused(graph: Graph) -> None:
    x, other = graph.symbol("x"), Graph().symbol("x")
    for operation in (directional, substitute):
        for pair in ({other: x}, {x: other}):
            with pytest.raises(InputError, match="different graphs"):
                operation([x * x], pair)


def test_taylor_series_by_repeated_derivatives(graph: Graph) -> None:
    x, function = graph.symbol("x"), sin(graph.symbol("x")) / (1 + graph.symbol("x"))
    total, term = 0.0, function
    for k in range(8):
        total += Tape.of([term], ["x"]).run([0.0], FLOATS)[0] * 0.05**k / math.factorial(k)
        term = derivative(term, x)
    assert total == pytest.approx(math.sin(0.05) / 1.05, abs=0.05**8)
