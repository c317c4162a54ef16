from __future__ import annotations

import math
import random
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings

from nullbody.errors import InputError
from nullbody.expr import Exact, Expr, Graph, Tape, cos, derivative, sin, sqrt
from nullbody.expr.bridge import SymPyBridge
from tests.expr.random_expression import NAMES, Algebra, build, graph_algebra, points, programs

sp = pytest.importorskip("sympy")
x, y, z, t = sp.symbols("x y z t")
f, g = sp.Function("f"), sp.Function("g")


@pytest.fixture
def bridge() -> SymPyBridge:
    return SymPyBridge(Graph())


def sympy_algebra() -> Algebra:
    functions = {"sin": sp.sin, "cos": sp.cos, "sqrt": sp.sqrt}
    return Algebra([x, y, z], lambda c: sp.Rational(c.numerator, c.denominator), functions)


def numbers(expression: Any, point: list[float]) -> float:
    return float(expression.subs(dict(zip((x, y, z), point, strict=True))).evalf(30))


def run(expression: Expr, point: list[float]) -> float:
    return Tape.of([expression], NAMES).run(point)[0]


# -- both directions ------------------------------------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(programs(longest=8), points())
def test_reading_keeps_the_value(program: list, point: list[float]) -> None:
    bridge = SymPyBridge(Graph())
    source = build(program, sympy_algebra())
    assert run(bridge.read(source), point) == pytest.approx(numbers(source, point), rel=1e-9, abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(programs(longest=8), points())
def test_writing_keeps_the_value(program: list, point: list[float]) -> None:
    graph = Graph()
    source = build(program, graph_algebra(graph))
    written = SymPyBridge(graph).write(source)
    assert numbers(written, point) == pytest.approx(run(source, point), rel=1e-9, abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(programs(longest=8))
def test_a_round_trip_is_exact_in_the_prime_field(program: list) -> None:
    graph = Graph()
    bridge = SymPyBridge(graph)
    source = bridge.read(build(program, sympy_algebra()))
    again = bridge.read(bridge.write(source))
    assert graph.value(again.ref) == graph.value(source.ref)
    graph.verify()


@settings(max_examples=60, deadline=None)
@given(programs(operations=("add", "sub", "mul", "neg"), longest=8))
def test_sympy_reads_the_polynomials_that_the_graph_builds(program: list) -> None:
    graph = Graph()
    bridge = SymPyBridge(graph)
    assert bridge.read(build(program, sympy_algebra())) == build(program, graph_algebra(graph))


@pytest.mark.parametrize(
    "source",
    [
        x * sp.sin(y) / z,
        sp.sqrt(x**2 + y**2) - 3 * sp.sqrt(2) * x / 7,
        sp.exp(x) * f(t) + sp.Derivative(f(t), t) - sp.pi,
        (x + y) ** sp.Rational(-5, 2),
        sp.Integral(f(t), (t, 0, sp.oo)) + x,
    ],
)
def test_what_was_read_is_written_as_it_was(source: Any, bridge: SymPyBridge) -> None:
    assert bridge.write(bridge.read(source)) == source


def test_a_matrix_and_its_numbers(bridge: SymPyBridge) -> None:
    source = sp.Matrix([[x, 0, sp.sin(y)], [sp.Rational(1, 3), x * y, -x]])
    rows = bridge.read_matrix(source)
    assert bridge.write_matrix(rows) == source
    assert bridge.write_matrix([[1, Fraction(1, 2), rows[0][0]]]) == sp.Matrix([[1, sp.Rational(1, 2), x]])
    assert bridge.read_matrix([[x, 2], (0.5, y)])[1][0] == Fraction(1, 2)


def test_sub_expressions_are_shared_by_reference(bridge: SymPyBridge) -> None:
    inner = sin(bridge.graph.symbol("x") * bridge.graph.symbol("y"))
    first, second = bridge.write(inner + 1), bridge.write(inner * 2)
    shared = [e for e in first.args if e.is_Function]
    assert any(e is shared[0] for e in second.args)


# -- numbers --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("source", "value"),
    [
        (sp.Integer(-7), -7),
        (sp.Rational(2, 3), Fraction(2, 3)),
        (sp.Float(0.1), Fraction(1, 10)),
        (sp.Float("0.1", 40), Fraction(1, 10)),
        (sp.Float("0.12345678901234567890123", 23), Fraction(12345678901234567890123, 10**23)),
        (sp.Float(1e22), 10**22),
        (sp.Mul(sp.sqrt(2), sp.sqrt(3), evaluate=False), Exact.square_root(6)),
        (sp.cos(sp.pi / 12), Exact.square_root(Fraction(6, 16)) + Exact.square_root(Fraction(2, 16))),
        (1 / (1 + sp.sqrt(2)), Exact.square_root(2) - Exact.of(1)),
        (sp.Pow(8, sp.Rational(2, 3), evaluate=False), 4),
        (0.1, Fraction(1, 10)),
        (Fraction(1, 7), Fraction(1, 7)),
    ],
)
def test_constants_are_exact(source: Any, value: Any, bridge: SymPyBridge) -> None:
    assert bridge.read(source) == value


def test_a_float_means_its_shortest_decimal(bridge: SymPyBridge) -> None:
    for number in (0.1 + 0.2, math.pi, 1 / 3, 1e-300):
        assert bridge.read(sp.Float(number)) == Exact.of(number)


def test_exact_constants_are_written_as_roots(bridge: SymPyBridge) -> None:
    number = Exact.square_root(Fraction(3, 4)) - Exact.of(Fraction(1, 2))
    assert bridge.write(bridge.graph.constant(number)) == sp.sqrt(3) / 2 - sp.Rational(1, 2)
    assert bridge.write(-3) == sp.Integer(-3)


def test_a_float_exponent_is_read_as_its_decimal(bridge: SymPyBridge) -> None:
    assert bridge.read(sp.Pow(x, 0.5)) == sqrt(bridge.read(x))
    assert bridge.read(sp.Pow(x, -2.0)) == 1 / bridge.read(x) ** 2


# -- identities -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "source",
    [
        sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1,
        sp.sin(x + y) - sp.sin(x) * sp.cos(y) - sp.cos(x) * sp.sin(y),
        sp.cos(3 * x) - 4 * sp.cos(x) ** 3 + 3 * sp.cos(x),
        sp.tan(x) * sp.cot(x) - 1,
        sp.sec(x) ** 2 - sp.tan(x) ** 2 - 1,
        sp.csc(x) * sp.sin(x) - 1,
        sp.sin(x) + sp.sin(x + 2 * sp.pi / 3) + sp.sin(x - 2 * sp.pi / 3),
        sp.tan(x + sp.pi / 4) * (1 - sp.tan(x)) - 1 - sp.tan(x),
        sp.sin(x + sp.pi / 7) - sp.sin(x) * sp.cos(sp.pi / 7) - sp.cos(x) * sp.sin(sp.pi / 7),
        sp.sqrt(x + y) ** 3 / sp.sqrt(x + y) - x - y,
        (x + y) ** sp.Rational(1, 3) * (x + y) ** sp.Rational(2, 3) - x - y,
        sp.sin(sp.pi / 3, evaluate=False) - sp.sqrt(3) / 2,
        sp.sin(f(t)) ** 2 + sp.cos(f(t)) ** 2 - 1,
    ],
)
def test_an_identity_reads_as_zero(source: Any, bridge: SymPyBridge) -> None:
    assert bridge.read(source) == 0


@pytest.mark.parametrize(
    "source",
    [
        sp.sin(x) ** 2 - sp.cos(x) ** 2,
        sp.sqrt(x**2) - x,
        sp.sin(x + sp.pi / 4) - sp.sin(x),
        sp.exp(x) - sp.exp(y),
        f(x) - g(x),
        f(x) - f(y),
        sp.tan(x) - sp.cot(x),
        sp.sec(x) - sp.csc(x),
        x ** sp.Rational(1, 3) - x ** sp.Rational(2, 3),
    ],
)
def test_what_is_not_zero_does_not_read_as_zero(source: Any, bridge: SymPyBridge) -> None:
    assert bridge.read(source) != 0


def test_circular_functions_at_random_points(bridge: SymPyBridge) -> None:
    place = random.Random(3)
    for function in (sp.sin, sp.cos, sp.tan, sp.cot, sp.sec, sp.csc):
        for turn in (sp.pi / 3, -sp.pi / 12, 5 * sp.pi / 6, 0):
            source, point = function(x + y + turn), [place.uniform(0.1, 0.6) for _ in range(3)]
            assert run(bridge.read(source), point) == pytest.approx(numbers(source, point), rel=1e-12)
    assert bridge.opaque == {}


def test_factors_below_are_divided_by_once(bridge: SymPyBridge) -> None:
    tape = Tape.of([bridge.read(x / (y * z * sp.sqrt(x + 1)))], NAMES)
    assert tape.operations.div == 1


# -- stand-ins ------------------------------------------------------------------------------------------------


def test_equal_stand_ins_share_one_symbol(bridge: SymPyBridge) -> None:
    first = bridge.read(sp.exp(x) + y)
    second = bridge.read(y + sp.Function("f")(t) + sp.exp(sp.Symbol("x")))
    assert second - first == bridge.read(f(t))
    assert bridge.opaque == {"exp": sp.exp(x), "f": f(t)}
    assert bridge.symbols == (y,)


def test_stand_ins_have_names_of_their_own(bridge: SymPyBridge) -> None:
    bridge.graph.symbol("exp")
    q, exp = sp.Function("q")(t), sp.Symbol("q")
    for source in (q, q.diff(t), q.diff(t, 2), q.diff(x), sp.exp(x), sp.exp(y), sp.pi, exp, sp.Function("q")(0)):
        bridge.read(source)
    assert list(bridge.table) == [
        *("q", "q_dot", "q_dot_dot", "exp__2", "exp__3", "pi", "q__2", "q__3"),
    ]
    assert bridge.read(q.diff(x)) == 0
    assert bridge.table["q__2"] == sp.Symbol("q")


def test_a_derivative_is_a_variable_of_its_own(bridge: SymPyBridge) -> None:
    q = sp.Function("q")(t)
    expression = bridge.read(sp.sin(q) * q.diff(t))
    rate = derivative(expression, bridge.read(q.diff(t)))
    assert bridge.write(rate) == sp.sin(q)
    assert bridge.write(derivative(expression, bridge.read(q))) == sp.cos(q) * q.diff(t)


def test_other_derivatives_are_stand_ins_too(bridge: SymPyBridge) -> None:
    mixed = f(x, y).diff(x, y) + sp.Derivative(sp.exp(x), x) + sp.Subs(f(z).diff(z), z, 2)
    assert bridge.write(bridge.read(mixed)) == mixed
    assert len(bridge.opaque) == 3


# -- symbols --------------------------------------------------------------------------------------------------


def test_one_name_with_other_assumptions_is_another_symbol(bridge: SymPyBridge) -> None:
    plain, positive, dummy = sp.Symbol("x"), sp.Symbol("x", positive=True), sp.Dummy("x")
    source = plain + 2 * positive + 3 * dummy
    assert bridge.read(plain) != bridge.read(positive)
    assert bridge.write(bridge.read(source)) == source
    assert list(bridge.table) == ["x", "x__2", "x__3"]
    assert bridge.symbols == (plain, positive, dummy)


def test_symbols_meet_those_of_the_graph(bridge: SymPyBridge) -> None:
    own = bridge.graph.symbol("x")
    real = sp.Symbol("x", real=True)
    assert bridge.read(real) == own
    assert bridge.write(own) is real
    assert bridge.read(bridge.write(bridge.graph.symbol("w"))) == bridge.graph.symbol("w")
    assert bridge.table["w"] == sp.Symbol("w")


def test_symbols_come_in_order_of_creation(bridge: SymPyBridge) -> None:
    bridge.read(z)
    bridge.read(sp.exp(y) + t)
    bridge.read(x)
    assert set(bridge.symbols) == {z, t, x}
    assert bridge.symbols[0] is z
    assert bridge.symbols[-1] is x
    assert list(bridge.table) == bridge.graph.symbols


def test_operands_are_read_from_left_to_right(bridge: SymPyBridge) -> None:
    source = sp.Add(*sp.symbols("d b a c"), evaluate=False)
    bridge.read(source)
    assert bridge.symbols == source.args


# -- depth ----------------------------------------------------------------------------------------------------


def test_deep_expressions_are_read_and_written(bridge: SymPyBridge) -> None:
    source = x
    for _ in range(5000):
        source = sp.sin(source * y, evaluate=False) + z
    assert isinstance(hash(source), int)
    found = bridge.read(source)
    again = bridge.read(bridge.write(found))
    assert again == found
    assert Tape.of([found], NAMES).operations.trig == 5000


def test_deep_expressions_of_the_graph_are_written(bridge: SymPyBridge) -> None:
    x1, y1 = bridge.graph.symbol("x"), bridge.graph.symbol("y")
    expression = x1
    for _ in range(2000):
        expression = sqrt(1 / (cos(-expression) - y1 * expression) + 1) - expression
    assert bridge.read(bridge.write(expression)) == expression


def test_a_deep_angle_follows_the_addition_theorems() -> None:
    graph = Graph()
    angles = [graph.symbol(f"a{k}") for k in range(3000)]
    total = angles[0]
    for angle in angles[1:]:
        total = total + angle
    assert sin(total - angles[-1]) * cos(angles[-1]) + cos(total - angles[-1]) * sin(angles[-1]) == sin(total)


def test_a_long_sum_is_written_as_one(bridge: SymPyBridge) -> None:
    source = sp.Add(*[sp.Symbol(f"a{k}") * x for k in range(2000)])
    assert bridge.write(bridge.read(source)) == source


def test_shared_sums_are_not_unrolled(bridge: SymPyBridge) -> None:
    last, following = bridge.graph.symbol("x"), bridge.graph.symbol("y")
    for _ in range(60):
        last, following = following, last + following
    assert bridge.write(following) == sp.fibonacci(60) * x + sp.fibonacci(61) * y


# -- what is refused ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (sp.I * x + 1, "complex"),
        (sp.exp(sp.I * x), "complex"),
        (sp.Symbol("w", imaginary=True), "complex"),
        (sp.Pow(-2, sp.Rational(1, 2), evaluate=False), "not real"),
        (sp.nan, "finite"),
        (sp.zoo, "finite"),
        (sp.oo, "finite"),
        (-sp.oo, "finite"),
        (x + sp.oo, "finite"),
        (1 / (sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1), "finite"),
        (sp.tan(x) / (sp.cos(2 * x) - 2 * sp.cos(x) ** 2 + 1), "finite"),
        (sp.Float("1e400"), "range of doubles"),
        (sp.Float("1e-400"), "range of doubles"),
        (float("nan"), "finite"),
        ((1 + sp.sqrt(2)) ** (10**9), "not kept exactly"),
        (sp.Symbol("A", commutative=False), "commutative"),
        (sp.MatrixSymbol("A", 2, 2), "scalar"),
        (sp.ImmutableMatrix([[x]]), "scalar"),
        (sp.Eq(x, y), "scalar"),
        (sp.true, "scalar"),
        (sp.Matrix([[x]]), "expected a SymPy expression"),
        ("x + 1", "not str"),
        (True, "not bool"),
        (1j, "not complex"),
        (None, "not NoneType"),
        (Graph().symbol("x"), "another graph"),
    ],
)
def test_what_has_no_real_value_is_refused(source: Any, message: str, bridge: SymPyBridge) -> None:
    with pytest.raises(InputError, match=message):
        bridge.read(source)


def test_a_refused_expression_leaves_no_name_behind(bridge: SymPyBridge) -> None:
    with pytest.raises(InputError):
        bridge.read(sp.exp(sp.I * x))
    assert bridge.table == {}
    assert bridge.graph.symbols == []


def test_other_graphs_and_shapes_are_refused(bridge: SymPyBridge) -> None:
    with pytest.raises(InputError, match="another graph"):
        bridge.write(Graph().symbol("x"))
    for matrix in ([x, y], "xy", [["x"]]):
        with pytest.raises(InputError):
            bridge.read_matrix(matrix)


# -- SymEngine ------------------------------------------------------------------------------------------------


def test_symengine_is_read(bridge: SymPyBridge) -> None:
    se = pytest.importorskip("symengine", reason="SymEngine is not installed: pip install symengine")
    a, b = se.symbols("x y")
    source = se.sin(a) ** 2 + se.cos(a) ** 2 + se.sqrt(3) * b / 2 + se.Function("f")(a).diff(a)
    expected = 1 + sp.sqrt(3) * y / 2 + f(x).diff(x)
    assert bridge.read(source) == bridge.read(expected)
    assert bridge.read_matrix(se.Matrix([[a, 1], [0, b]])) == bridge.read_matrix(sp.Matrix([[x, 1], [0, y]]))


def test_what_only_looks_like_symengine_is_converted(bridge: SymPyBridge) -> None:
    class Foreign:
        def _sympy_(self) -> Any:
            return x + 1

    assert bridge.read(Foreign()) == bridge.read(x + 1)
