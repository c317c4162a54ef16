from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nullbody.errors import InputError
from nullbody.expr import Exact, Graph, cos, derivative, sin, sqrt
from nullbody.expr.field import PRIMES, Field
from tests.expr.random_expression import SMOOTH, build, graph_algebra, programs

ROOTLESS = tuple(operation for operation in SMOOTH if operation != "sqrt")  # only equal roots are multiplied


@pytest.fixture
def graph() -> Graph:
    return Graph()


def test_sin2_plus_cos2_is_1(graph: Graph) -> None:
    x, y = graph.symbol("x"), graph.symbol("y")
    assert sin(x) ** 2 + cos(x) ** 2 == 1
    assert sin(x * y) ** 2 == 1 - cos(x * y) ** 2


def test_addition_theorems(graph: Graph) -> None:
    x, y = graph.symbol("x"), graph.symbol("y")
    assert sin(x + y) == sin(x) * cos(y) + cos(x) * sin(y)
    assert cos(x - y) == cos(x) * cos(y) + sin(x) * sin(y)
    assert sin(3 * x) == 3 * sin(x) - 4 * sin(x) ** 3
    assert cos(-2 * x) == 1 - 2 * sin(x) ** 2


def test_sine_is_odd_and_cosine_even(graph: Graph) -> None:
    x, y = graph.symbol("x"), graph.symbol("y")
    assert sin(y - x) == -sin(x - y)
    assert cos(y - x) == cos(x - y)
    assert (sin(x - x), cos(x - x)) == (0, 1)


def test_square_roots_multiply(graph: Graph) -> None:
    x, root = graph.symbol("x"), graph.constant(Exact.square_root(3))
    assert root * root == 3
    assert (root * x) * (root * x) == 3 * x * x
    assert sqrt(graph.constant(Fraction(3, 4))) == root / 2
    assert sqrt(x * x + 1) * sqrt(1 + x * x) == 1 + x * x


def test_the_square_root_of_a_square_is_not_its_argument(graph: Graph) -> None:
    x = graph.symbol("x")
    assert sqrt(x * x) != x
    assert sqrt(x * x) != -x


def test_minus_nothing_is_nothing(graph: Graph) -> None:
    x, y, z = (graph.symbol(name) for name in "xyz")
    assert -(x * (y - z)) + (x * y - x * z) == 0
    assert (-x * y - z) + (z + y * x) == 0
    assert -graph.constant(0) == 0


@given(programs(ROOTLESS), programs(ROOTLESS))
def test_sums_and_products_that_are_equal_are_one_node(one: list, two: list) -> None:
    graph = Graph()
    a, b = build(one, graph_algebra(graph)), build(two, graph_algebra(graph))
    assert a - a == 0
    assert (a + b) * (a - b) == a * a - b * b
    assert (a + b) ** 2 == a**2 + 2 * a * b + b**2
    graph.verify()


def test_of_two_opposite_expressions_there_is_one_node(graph: Graph) -> None:
    x, y = graph.symbol("x"), graph.symbol("y")
    difference = x - y
    size = len(graph)
    opposite = y - x
    assert (opposite, -opposite) == (-difference, difference)
    assert -x * y == x * -y == -(x * y)
    assert (-x) * (-y) == x * y
    assert len(graph) == size + 1  # x y


def test_constants_are_gathered_in_front(graph: Graph) -> None:
    x = graph.symbol("x")
    assert 2 * (x * Fraction(1, 2)) == x
    assert (0.1 * x) * 30 == 3 * x
    assert x / 4 * 4 == x
    assert 1 / (1 / x) == x
    assert 1 / -(1 / x) == -x


def test_a_product_with_its_reciprocal_is_1(graph: Graph) -> None:
    x, y = graph.symbol("x"), graph.symbol("y")
    assert x / x == 1
    assert (x * x - y * y) / (x + y) == x - y


@pytest.mark.parametrize("zero", [lambda x: x - x, lambda x: sin(x) ** 2 + cos(x) ** 2 - 1, lambda x: 0 * x])
def test_dividing_by_what_vanishes_everywhere_is_an_error(graph: Graph, zero) -> None:
    with pytest.raises(ZeroDivisionError, match="zero"):
        1 / zero(graph.symbol("x"))


def test_a_merge_never_brings_in_a_foreign_symbol(graph: Graph) -> None:
    x, y, z = (graph.symbol(name) for name in "xyz")
    first = (x + z) - z  # structurally with z; equal to x
    assert first == x
    odd = y * (z / z) * x
    assert graph.depends[odd.ref >> 1] == graph.depends[x.ref >> 1] | graph.depends[y.ref >> 1]


def test_verify_counts_the_merges(graph: Graph) -> None:
    x = graph.symbol("x")
    before = graph.verify()
    assert sin(x) ** 2 + cos(x) ** 2 == 1
    assert graph.verify() == before + 1


def test_a_planted_false_merge_is_found(graph: Graph) -> None:
    x, y = graph.symbol("x"), graph.symbol("y")
    graph._merges.append((("add", x.ref, y.ref), (x * y).ref))
    with pytest.raises(ArithmeticError, match="one prime only"):
        graph.verify()


@pytest.mark.parametrize("radicand", [2, 3, 30, 37, 41, 43, 47, 59, 67, 997])
def test_merges_with_any_square_root_hold_at_the_second_prime(radicand: int) -> None:
    graph = Graph()
    x, root = graph.symbol("x"), graph.constant(Exact.square_root(radicand))
    assert (root * x) * root == radicand * x
    assert ((root * x) * (root * x) == radicand * x * x) in (True, False)  # seen for small primes
    graph.verify()


def test_a_root_too_large_to_factor_stays_a_node_and_keeps_its_meaning(graph: Graph) -> None:
    number = graph.constant(1_000_000_007 * 1_000_000_009)
    root = sqrt(number)
    assert root.constant is None
    assert root * root == number


@pytest.mark.parametrize("prime", PRIMES)
@given(tag=st.text(max_size=5))
def test_field_points_lie_on_the_circle_and_roots_square(prime: int, tag: str) -> None:
    field = Field(prime)
    c, s = field.circle(tag)
    assert (c * c + s * s) % prime == 1
    assert all(field.square_root(k) ** 2 % prime == k for k in (2, 3, 6, 31, 30))
    assert field.square_root(6) == field.square_root(2) * field.square_root(3) % prime


def test_another_seed_is_another_point() -> None:
    assert Field(PRIMES[0], 1).random("x") != Field(PRIMES[0], 2).random("x")
    values = [graph.value(graph.symbol("x").ref) for graph in (Graph(1), Graph(2), Graph(1))]
    assert values[0] == values[2] != values[1]


def test_expressions_of_different_graphs_do_not_mix(graph: Graph) -> None:
    with pytest.raises(InputError, match="different graphs"):
        graph.symbol("x") + Graph().symbol("x")


def test_only_integer_powers(graph: Graph) -> None:
    x = graph.symbol("x")
    assert x**-2 == 1 / (x * x)
    assert x**0 == 1
    with pytest.raises(InputError, match="integer power"):
        x**0.5


def test_other_operands_are_left_to_python(graph: Graph) -> None:
    x = graph.symbol("x")
    for operation in (
        lambda: x + "1",
        lambda: "1" - x,
        lambda: x * None,
        lambda: x / [],
        lambda: {} / x,
        lambda: x - (),
    ):
        with pytest.raises(TypeError):
            operation()
    assert x != "x"


def test_a_float_means_its_decimal(graph: Graph) -> None:
    x = graph.symbol("x")
    assert x * 0.1 == x / 10
    assert graph.constant(0.1) + graph.constant(0.2) == graph.constant(0.3)


def test_names_and_constants_of_expressions(graph: Graph) -> None:
    x = graph.symbol("x")
    assert (x.name, (-x).name, (x * x).name) == ("x", None, None)
    assert graph.symbol("x") == x
    assert hash(graph.symbol("x")) == hash(x)
    assert (derivative(5 * x, x).constant, x.constant) == (Exact.of(5), None)
