from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import pytest
from hypothesis import given

from nullbody.errors import InputError, UnknownName
from nullbody.expr import Exact, Graph, Operations, Tape, cos, operations, sin, sqrt
from tests.expr.random_expression import FLOATS, NAMES, RATIONAL, Algebra, build, graph_algebra, points, programs


@given(programs(), points())
def test_tape_equals_direct_evaluation(program: list, point: list[float]) -> None:
    expression = build(program, graph_algebra(Graph()))
    expected = build(program, Algebra(point, float, FLOATS))
    assert Tape.of([expression], NAMES).run(point)[0] == pytest.approx(expected, rel=1e-11, abs=1e-11)


@given(programs(RATIONAL), points())
def test_tape_runs_on_fractions(program: list, point: list[float]) -> None:
    exact = [Fraction(str(x)) for x in point]
    expected = build(program, Algebra(exact, Fraction, {}))
    expression = build(program, graph_algebra(Graph()))
    assert float(Tape.of([expression], NAMES).run(exact)[0]) == pytest.approx(float(expected), rel=1e-13, abs=1e-13)


@given(programs(), points())
def test_tape_runs_in_high_precision(program: list, point: list[float]) -> None:
    functions = {"sin": mpmath.sin, "cos": mpmath.cos, "sqrt": mpmath.sqrt}
    constant = lambda number: mpmath.mpf(number.numerator) / number.denominator  # noqa: E731
    with mpmath.workdps(40):
        inputs = [mpmath.mpf(x) for x in point]
        expected = build(program, Algebra(inputs, constant, functions))
        (found,) = Tape.of([build(program, graph_algebra(Graph()))], NAMES).run(inputs, functions)
        assert abs(found - expected) <= mpmath.mpf(10) ** -28 * (1 + abs(expected))


def test_operands_precede_their_operation() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    tape = Tape.of([sin(x * y) - 1 / (x + y), -x], ["y", "x"])
    for slot, (operation, a, b) in enumerate(tape.code):
        if operation not in ("symbol", "const"):
            assert max(a, b) >> 1 < slot
    assert tape.run([2.0, 3.0])[0] == pytest.approx(math.sin(6) - 1 / 5)
    assert tape.outputs[1] & 1  # the sign of -x


def test_exact_operation_counts() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    assert operations([]) == Operations()
    assert operations([-x, graph.constant(3)]) == Operations()
    assert operations([x * y + 1]) == Operations(add=1, mul=1)
    assert operations([-x - y, x + y]) == Operations(add=1)
    assert operations([sin(x) * sin(x), sin(-x)]) == Operations(mul=1, trig=1)
    assert operations([x / y, 2 / y]) == Operations(mul=2, div=1)
    assert operations([sqrt(x * x + y * y)]) == Operations(add=1, mul=2, sqrt=1)
    assert operations([(x + y) * cos(x), (x + y) * sin(x)]) == Operations(add=1, mul=2, trig=2)


@given(programs())
def test_the_tape_counts_what_the_graph_counts(program: list) -> None:
    expression = build(program, graph_algebra(Graph()))
    assert Tape.of([expression], NAMES).operations == operations([expression])


def test_counts_in_words() -> None:
    counts = Operations(add=2, mul=3, div=1, sqrt=1, trig=4)
    assert counts.arithmetic == 7
    assert str(counts) == "7 (2 +, 3 *, 1 /, 1 sqrt, 4 trig)"


def test_constants_are_the_nearest_doubles() -> None:
    graph = Graph()
    third = graph.symbol("x") * Fraction(1, 3) + graph.constant(Exact.square_root(3))
    assert sorted(Tape.of([third], ["x"]).constants) == [1 / 3, math.sqrt(3)]


def test_an_empty_program() -> None:
    assert Tape.of([], ["x"]).run([1.0]) == []


def test_expressions_of_different_graphs_are_refused() -> None:
    mixed = [Graph().symbol("x"), Graph().symbol("x")]
    for operation in (operations, lambda outputs: Tape.of(outputs, ["x"])):
        with pytest.raises(InputError, match="different graphs"):
            operation(mixed)


def test_a_missing_input_is_named_and_a_wrong_number_refused() -> None:
    expression = Graph().symbol("length")
    with pytest.raises(UnknownName, match=r"no input 'length'; did you mean 'lengths'"):
        Tape.of([expression], ["lengths"])
    with pytest.raises(InputError, match="1 inputs, not 2"):
        Tape.of([expression], ["length"]).run([1.0, 2.0])
