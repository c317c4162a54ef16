from __future__ import annotations

from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy

from nullbody.errors import InputError, SingularityError, UnknownName
from nullbody.expr import Exact, Graph, Tape, sin
from nullbody.kernels.reference import FUNCTIONS
from nullbody.nullspace import null_space
from nullbody.nullspace.function import NullSpaceFunction, function_of
from nullbody.nullspace.numeric import subspace_angle
from nullbody.nullspace.result import FORMS, Form
from nullbody.tolerances import EPS

DRIVEN = (9, 10, 11)  # s1, s2, s3


def small() -> list[list[Any]]:
    """One row: N = [-(1 + y)/x -sin(y)/x; 1 0; 0 1], |B| = x."""
    graph = Graph()
    graph.symbol("unused")
    x, y = graph.symbol("x"), graph.symbol("y")
    return [[x, 1 + y, sin(y)]]


@pytest.fixture(scope="module")
def robot(three_prs_jacobian: list[list[Any]]) -> NullSpaceFunction:
    return function_of(null_space(three_prs_jacobian, DRIVEN))


def points(f: NullSpaceFunction, count: int) -> Any:
    return np.random.default_rng(7).uniform(0.5, 1.5, (count, len(f.symbols)))


@pytest.mark.parametrize("form", FORMS)
def test_the_robot_against_the_interpreter_and_40_digits(three_prs_jacobian: list[list[Any]], form: Form) -> None:
    space = null_space(three_prs_jacobian, DRIVEN, form=form)
    f, graph = function_of(space), three_prs_jacobian[0][0].graph
    assert f.symbols == ("psi", "theta", "phi", "alpha1", "alpha2", "alpha3", "l", "b")
    X = points(f, 20)
    entries = [entry if hasattr(entry, "ref") else graph.constant(entry) for row in space.basis for entry in row]
    tape = Tape.of(entries, f.symbols)
    interpreted = np.array(tape.run(list(X.T), FUNCTIONS)[0])
    assert f(X)[:, 0, 0] == pytest.approx(interpreted, rel=1e-9)
    with mpmath.workdps(40):
        functions = {"sin": mpmath.sin, "cos": mpmath.cos, "sqrt": mpmath.sqrt}
        exact = [tape.run([mpmath.mpf(float(value)) for value in x], functions) for x in X]
    expected = np.array(exact, dtype=float).reshape(20, 12, 3)
    error = f.subspace_error(X)
    assert (subspace_angle(f(X), expected) < 30 * error * np.maximum(1, error / EPS)).all()


def test_a_batch_is_its_points(robot: NullSpaceFunction) -> None:
    X = points(robot, 21)
    N = robot(X)
    assert N.shape == (21, 12, 3)
    assert np.array_equal(N, [robot(x) for x in X])
    assert (N[:, list(DRIVEN)] == np.eye(3)).all()
    assert robot.delta(X).tolist() == [robot.delta(x) for x in X]
    assert robot.subspace_error(X) == pytest.approx([EPS * np.linalg.norm(one, 2) for one in N], rel=1e-12)
    assert isinstance(robot.delta(X[0]), float)
    assert isinstance(robot.subspace_error(X[0]), float)


def test_an_empty_batch(robot: NullSpaceFunction) -> None:
    empty = np.zeros((0, len(robot.symbols)))
    assert robot(empty).shape == (0, 12, 3)
    assert robot.delta(empty).shape == robot.subspace_error(empty).shape == (0,)


def test_arguments_by_name() -> None:
    f = function_of(null_space(small(), (1, 2)))
    assert f.symbols == f.delta_symbols == ("x", "y")
    expected = f([2.0, 0.0])
    assert expected.tolist() == [[-0.5, 0], [1, 0], [0, 1]]
    for N in (f(x=2, y=0), f({"y": 0.0, "x": 2.0}), f({"x": 2}, y=0), f((2, 0))):
        assert np.array_equal(N, expected)
    many = f(x=np.array([2.0, 4.0]), y=0.0)
    assert many.shape == (2, 3, 2)
    assert (many == f([[2.0, 0.0], [4.0, 0.0]])).all()
    assert f.delta(x=3.0, y=1.0) == 3
    assert repr(f) == "<NullSpaceFunction (x, y) -> reduced 3 x 2>"


@pytest.mark.parametrize(
    ("arguments", "names", "error", "message"),
    [
        ((), {"x": 1.0, "z": 2.0}, UnknownName, "there is no symbol 'z'"),
        ((), {"x": 1.0}, InputError, "values for y"),
        ((), {}, InputError, "values for x, y"),
        (([1.0, 2.0, 3.0],), {}, InputError, r"shape \(3,\), not \(2,\) or \(N, 2\): its symbols are x, y"),
        ((1.0,), {}, InputError, r"shape \(\)"),
        (([1.0, 2.0],), {"y": 2.0}, InputError, "not both"),
        (([1.0, np.nan],), {}, InputError, "y must be finite, not nan"),
        (([[1.0, 1.0], [np.inf, 1.0]],), {}, InputError, "x must be finite, not inf at point 1"),
        (([1.0, 1j],), {}, InputError, "real numbers"),
        (([[1.0, 2.0], [1.0]],), {}, InputError, "no array of numbers"),
        ((), {"x": [1.0, 2.0], "y": [1.0, 2.0, 3.0]}, InputError, "numbers of points differ: x 2, y 3"),
        ((), {"x": "1", "y": 2.0}, InputError, "x must be real numbers"),
    ],
)
def test_bad_arguments(arguments: Any, names: Any, error: type[Exception], message: str) -> None:
    f = function_of(null_space(small(), (1, 2)))
    for call in (f, f.delta, f.subspace_error):
        with pytest.raises(error, match=message):
            call(*arguments, **names)


@pytest.mark.parametrize("form", FORMS)
def test_singular_points_are_refused(form: Form) -> None:
    f = function_of(null_space(small(), (1, 2), form=form))
    with pytest.raises(
        SingularityError, match=r"x = 0, y = 1: \|B\| = 0 .* columns \[1, 2\] cannot .* \[0, 2\] would do"
    ):
        f([0.0, 1.0])
    with pytest.raises(SingularityError, match=r"point 1 \(2 of 3 points are singular\): null space at x = 1e-20"):
        f([[1.0, 1.0], [1e-20, 1.0], [0.0, 2.0]])
    unchecked = f([[1.0, 1.0], [0.0, 1.0]], check=False)
    assert (unchecked[0] == f([1.0, 1.0])).all()
    assert f.subspace_error([[1.0, 1.0], [0.0, 1.0]])[1] == np.inf
    if form == "reduced":
        assert not np.isfinite(unchecked[1]).all()


def test_where_the_matrix_itself_loses_rank() -> None:
    graph = Graph()
    f = function_of(null_space([[graph.symbol("x"), graph.symbol("y")]], [1]))
    with pytest.raises(SingularityError, match="A loses rank"):
        f([0.0, 0.0])


def test_a_pivot_that_vanishes_where_the_determinant_does_not() -> None:
    points = np.ones((4, 5)) - np.eye(4, 5)  # |B| = a d - b c = +-1, and one entry of B is zero
    functions = []
    for method in ("minors", "elimination"):
        graph = Graph()
        a, b, c, d, e = (graph.symbol(name) for name in "abcde")
        functions.append(function_of(null_space([[a, b, e], [c, d, 1]], [2], method=method)))
    assert np.isfinite(functions[0](points)).all()
    with pytest.raises(SingularityError, match=r"a pivot .* vanishes, though \|B\| does not; use method='minors'"):
        functions[1](points)


def test_delta_may_need_more_symbols() -> None:
    graph = Graph()
    x, y, z = graph.symbol("x"), graph.symbol("y"), graph.symbol("z")
    f = function_of(null_space([[x, y, 0], [0, 0, z]], [1]))
    assert (f.symbols, f.delta_symbols) == (("x", "y"), ("x", "y", "z"))
    assert f([1.0, 2.0]).T.tolist() == [[-2, 1, 0]]
    assert f.delta(x=2.0, y=1.0, z=3.0) == 6
    with pytest.raises(InputError, match="values for z"):
        f.delta(x=2.0, y=1.0)


def test_numbers_give_a_constant() -> None:
    f = function_of(null_space([[1, 2, 0, 1], [5, 8, 1, 3]], (2, 3)))
    assert f.symbols == ()
    assert f().tolist() == [[-1, 1], [0.5, -1], [1, 0], [0, 1]]
    assert f(np.zeros((5, 0))).shape == (5, 4, 2)
    assert f.delta() == -2
    assert f.subspace_error([]) == pytest.approx(EPS * np.linalg.norm(f(), 2))
    f()[0, 0] = 7.0
    assert f()[0, 0] == -1
    with pytest.raises(InputError, match="it has no symbols"):
        f([1.0])
    surds = function_of(null_space([[Exact.square_root(2), 1]], [1]))
    assert surds()[0, 0] == pytest.approx(-np.sqrt(0.5), rel=1e-15)


def test_numbers_beyond_the_doubles() -> None:
    graph = Graph()
    with pytest.raises(InputError, match="beyond the range of doubles"):
        function_of(null_space([[graph.symbol("x"), Fraction(10**400)]], [1]))


def test_sympy_stand_ins_are_arguments_and_pi_is_not() -> None:
    x, t = sympy.symbols("x t")
    q = sympy.Function("q")(t)
    f = function_of(null_space(sympy.Matrix([[q, sympy.pi * x, sympy.exp(x)]]), [1, 2]))
    assert set(f.symbols) == {"q", "x", "exp"}
    named = f({"q(t)": 2.0, "x": 3.0, "exp(x)": 5.0})
    assert (f(q=2.0, x=3.0, exp=5.0) == named).all()
    assert (f({q: 2.0, x: 3.0, sympy.exp(x): 5.0}) == named).all()
    assert named[0] == pytest.approx([-1.5 * np.pi, -2.5], rel=1e-15)


def test_symbols_that_are_no_arguments_are_explained() -> None:
    a, b, x = sympy.symbols("a b x")
    f = null_space(sympy.Matrix([[a, a * b, 2 * a]])).to_function()
    with pytest.raises(UnknownName, match="'a' cancels out of this basis"):
        f(a=1, b=2)
    with pytest.raises(UnknownName, match="'a' cancels out of this basis"):
        null_space(sympy.Matrix([[a, 2 * a]])).to_function()(a=1)
    f = null_space(sympy.Matrix([[1, sympy.exp(x), a]])).to_function()
    with pytest.raises(UnknownName, match=r"exp\(x\) is an argument of its own: give its value"):
        f(x=1, a=2)
    assert f({"exp(x)": 3, "a": 2})[0].tolist() == [-3, -2]
