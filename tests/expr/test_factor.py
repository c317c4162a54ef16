"""Factoring: the same functions in no more operations, and the exact counts of small examples."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings

from nullbody.errors import InputError
from nullbody.expr import Exact, Expr, Graph, Tape, cos, factored, operations, sin, sqrt
from nullbody.expr.transplant import transplant
from tests.expr.random_expression import NAMES, SMOOTH, build, graph_algebra, points, programs

ROOTLESS = tuple(operation for operation in SMOOTH if operation != "sqrt")  # roots are merged by structure only
Step = tuple[str, int, int]


def symbols(names: str) -> list[Expr]:
    graph = Graph()
    return [graph.symbol(name) for name in names.split()]


def count(*expressions: Expr) -> int:
    return operations(expressions).arithmetic


def test_a_common_factor_leaves_the_sum() -> None:
    x, y, z, w = symbols("x y z w")
    (found,) = factored([x * y - z * x + x * w])
    assert operations([found]).mul == 1
    assert operations([found]).add == 2
    assert Tape.of([found], ("x", "y", "z", "w")).run([2.0, 3.0, 5.0, 7.0]) == [10.0]


def test_the_factor_that_most_terms_share_goes_first() -> None:
    a, x, y, z, w = symbols("a x y z w")
    assert count(a * x + a * y + a * z + x * w) == 7
    assert count(*factored([a * x + a * y + a * z + x * w])) == 5  # a (x + y + z) + x w


def test_constants_are_factors() -> None:
    x, y, z = symbols("x y z")
    third = Fraction(1, 3)
    assert count(*factored([third * x - third * y * z])) == 3
    root = Exact.square_root(3)
    assert count(*factored([x * root + y * root, x * root - z * root])) == 4


def test_reciprocals_are_factors() -> None:
    x, y, d = symbols("x y d")
    found = operations(factored([x / d + y / d]))
    assert (found.add, found.mul, found.div) == (1, 1, 1)


def test_a_common_pair_of_factors_is_made_once() -> None:
    a, b, c, d = symbols("a b c d")
    products = [a * (b * c), (a * d) * b, sin(a) * b * a]
    assert count(*products) == 6
    assert count(*factored(products)) == 4


def test_a_common_pair_of_terms_is_made_once_whatever_its_sign() -> None:
    a, b, c, d = symbols("a b c d")
    sums = [(a + c) - b, d - (a - b), (c * b + d) - c * a]
    assert count(*sums) == 8
    assert count(*factored(sums)) == 5  # e = a - b; e + c, d - e, d - c e


def test_a_shared_product_is_taken_apart_where_all_its_sums_can_be_factored() -> None:
    x, y, z, w = symbols("x y z w")
    product = x * y
    assert count(product + x * z, product + x * w) == 5
    assert count(*factored([product + x * z, product + x * w])) == 4


def test_powers_that_are_shared_stay_shared() -> None:
    (x,) = symbols("x")
    power = x**1000
    assert count(*factored([power, power * x + power])) <= count(power, power * x + power)


def test_nothing_to_gain_leaves_everything_as_it_was() -> None:
    x, y = symbols("x y")
    expressions = [x * y + 1, sqrt(x) / y, -cos(x - y), x, -y, x.graph.constant(7), x.graph.constant(0), x]
    found = factored(expressions)
    assert operations(found) == operations(expressions)
    assert [repr(f) for f in found] == [repr(f) for f in expressions]


def test_no_expressions_and_constants_alone() -> None:
    assert factored([]) == []
    graph = Graph()
    assert factored([graph.constant(0), graph.constant(Fraction(-2, 3))]) == [0, Fraction(-2, 3)]


def test_expressions_of_two_graphs_are_refused() -> None:
    with pytest.raises(InputError, match="different graphs"):
        factored([*symbols("x"), *symbols("y")])


def test_it_is_a_new_graph_with_the_symbols_that_are_needed() -> None:
    x, y, _ = symbols("x y unused")
    expression = x * sin(y) + x
    before = len(x.graph)
    (found,) = factored([expression])
    assert len(x.graph) == before
    assert found.graph is not x.graph
    assert sorted(found.graph.symbols) == ["x", "y"]


def test_the_same_input_gives_the_same_program_and_factoring_again_gains_nothing() -> None:
    a, b, c, d = symbols("a b c d")
    sums = [a * b * c + a * b * d - c * d, (a + b) * c * d - a * b * c, b * c * d + c * c * a]
    once, twice = factored(sums), factored(sums)
    assert once[0].graph.code == twice[0].graph.code
    assert [f.ref for f in once] == [f.ref for f in twice]
    assert count(*factored(once)) == count(*once) < count(*sums)


def test_sums_of_many_terms_and_deep_ones() -> None:
    graph = Graph()
    x = graph.symbol("x")
    total, nested = graph.constant(0), x
    for k in range(1500):
        total = total + (x * graph.symbol(f"y{k}") if k < 200 else graph.symbol(f"y{k}"))
        nested = nested * graph.symbol(f"y{k}") + 1
    assert count(total) == 1699
    assert count(*factored([total])) == 1500  # one factor for the first 200
    assert count(*factored([nested])) == 3000


@given(programs(ROOTLESS, longest=20), programs(ROOTLESS, longest=20))
@settings(max_examples=60)
def test_random_programs_are_the_same_modulo_a_prime(one: list[Step], two: list[Step]) -> None:
    algebra = graph_algebra(Graph())
    before = [build(one, algebra), build(two, algebra), build([*one, *two], algebra)]
    after = factored(before)
    assert count(*after) <= count(*before)
    other = Graph(seed=11)
    assert transplant(before, other) == transplant(after, other)
    assert after[0].graph.verify() >= 0


@given(programs(longest=20), points())
def test_random_programs_keep_their_values(program: list[Step], point: list[float]) -> None:
    before = [build(program, graph_algebra(Graph()))]
    values = [Tape.of(group, NAMES).run(point)[0] for group in (before, factored(before))]
    assert values[0] == pytest.approx(values[1], rel=1e-7, abs=1e-7)
