"""Input that once broke something: wrong kinds of input, identities that hide a rank, surds that are zero."""

from __future__ import annotations

import copy
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import scipy.sparse
import sympy as sp

from nullbody.errors import InputError, UnknownName
from nullbody.expr import Exact, Graph
from nullbody.nullspace import (
    adjugate,
    better_chart,
    charts,
    division_free,
    echelon,
    null_space,
    orthogonal_basis,
    paper_scaled,
    subspace_angle,
)
from nullbody.nullspace.derivative import basis_rate, orthogonal_rate

x, y = sp.symbols("x y")
NESTED = np.empty((1, 2), object)
NESTED[0] = [np.array([1, 2]), 1]


@pytest.mark.parametrize(
    ("A", "message"),
    [
        (np.ma.array([[1.0, 2.0]], mask=[[True, False]]), "masked"),
        ({(1, 2): 3}, "not a dict"),
        ({(1, 2), (2, 4)}, "not a set"),
        ([{1: 2, 3: 4}], "mappings are no rows"),
        ([b"12", b"34"], "text"),
        (bytearray(b"12"), "bytearray"),
        (np.ndarray, "not a type"),
        (NESTED, r"A\[0, 0\] must be a number .* array of shape \(2,\)"),
        ([np.matrix([1, 2])], r"A\[0, 0\] must be a number"),
        ([[1.5, 10**400]], r"A\[0, 1\] is beyond the range of doubles"),
        (scipy.sparse.coo_array(np.array([1.0, 2.0])), r"shape \(2,\)"),
        (sp.Matrix(3, 0, []), "no columns"),
        (sp.Matrix([[1, x], [sp.I, 1]]), r"A\[1, 0\]: .* complex"),
    ],
)
def test_no_matrices(A: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        null_space(A)


class Table:
    """What a data frame offers."""

    def to_numpy(self) -> Any:
        return np.array([[1.0, 2.0]])


@pytest.mark.parametrize("A", [Table(), [[np.longdouble(1), np.longdouble(2)]], (row for row in [[1, 2]])])
def test_unusual_matrices(A: Any) -> None:
    assert np.array(null_space(A, [1]).basis, float).tolist() == [[-2], [1]]


KINDS: list[Any] = [
    [[1, 2, 3, 4], [0, 1, 1, 2]],
    np.array([[1.0, 2, 3, 4], [0, 1, 1, 2]]),
    scipy.sparse.csr_array(np.array([[1.0, 2, 3, 4], [0, 1, 1, 2]])),
    sp.Matrix([[x, y, 1, 2], [0, 1, x, y]]),
]


@pytest.mark.parametrize("A", KINDS, ids=["exact", "array", "sparse", "sympy"])
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"independent": np.array([[0, 1]])}, "distinct"),
        ({"independent": {0: 1, 1: 2}}, "not a dict"),
        ({"independent": [0, 1], "prefer": [0]}, "not both"),
        ({"prefer": np.array([[0, 1]])}, "distinct"),
        ({"method": ["auto"]}, "no method"),
        ({"search": True}, "search"),
        ({"search": -1}, "search"),
        ({"tolerance": float("nan")}, "tolerance"),
        ({"tolerance": "1e-3"}, "tolerance"),
        ({"tolerance": [1e-3]}, "tolerance"),
        ({"tolerance": 1j}, "tolerance"),
        ({"tolerance": 1}, "tolerance"),
    ],
)
def test_no_arguments(A: Any, arguments: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        null_space(A, **arguments)


def test_only_expressions_are_searched() -> None:
    exact, array, matrix, symbols = KINDS
    for A in (array, matrix):
        with pytest.raises(InputError, match="search is for expressions"):
            null_space(A, search=5)
    assert null_space(exact, search=5).basis == null_space(exact).basis
    assert null_space(symbols, search=1).rank == 2


def test_a_form_that_is_none_is_not_taken_for_orthonormal() -> None:
    for A in (KINDS[0], KINDS[1], KINDS[3]):
        with pytest.raises(UnknownName, match="did you mean 'orthonormal'"):
            null_space(A).in_form("orthonorml")  # type: ignore[arg-type]
        with pytest.raises(UnknownName):
            null_space(A).in_form(["reduced"])  # type: ignore[arg-type]


def test_spaces_are_hashable_and_copies_keep_working() -> None:
    for A in KINDS:
        space = null_space(A)
        assert len({space, null_space(A)}) == 2
        assert list(copy.deepcopy(space).offset([1, 2])) == list(space.offset([1, 2]))


TWICE = [[1, 2, 3], [2, 4, 6]]


@pytest.mark.parametrize(
    ("A", "c", "message"),
    [
        (TWICE, [1, 1], "no solution"),
        (sp.Matrix([[x, y, 1], [2 * x, 2 * y, 2]]), [1, 1], "no solution"),
        ([[Exact.square_root(2), 1], [2, Exact.square_root(2)]], [1, 1], "no solution"),
        (TWICE, ["1", "2"], "is not a number"),
        (TWICE, [sp.sqrt(2), 2 * sp.sqrt(2)], "not rational"),
        (TWICE, None, "list of 2 scalars"),
        (TWICE, {0: 1, 1: 2}, "list of 2 scalars"),
        (np.array(TWICE, float), [10**400, 0], "no array of numbers"),
    ],
)
def test_wrong_offsets(A: Any, c: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        null_space(A).offset(c)


@pytest.mark.parametrize("c", [[sp.Rational(1, 3), sp.Rational(2, 3)], [np.int64(2**62 + 1), np.int64(2**62 + 1)]])
def test_exact_numbers_of_other_libraries_stay_exact(c: Any) -> None:
    assert null_space([[1, 0, 0], [0, 1, 0]]).offset(c)[0] == -Fraction(int(c[0].numerator), int(c[0].denominator))


def test_fractions_are_welcome_beside_an_array() -> None:
    assert null_space(np.array([[2.0, 1.0]]), [1]).offset([Fraction(1, 2)]).tolist() == [-0.25, 0]


def test_surds_that_are_zero() -> None:
    root, one = Exact.square_root(2), Exact.of(1)
    space = null_space([[root, one, one], [one - one, one, root], [root, one + one, one + root]])
    assert space.redundant == (2,)
    assert space.basis[0][0] == (one - root * Exact.of(Fraction(1, 2)))


IDENTITIES = [
    (sp.sin(x), 2 * sp.sin(x / 2) * sp.cos(x / 2)),
    (sp.cos(x), (1 - sp.tan(x / 2) ** 2) / (1 + sp.tan(x / 2) ** 2)),
    (sp.sin(x), 3 * sp.sin(x / 3) - 4 * sp.sin(x / 3) ** 3),
    (sp.sin(x) + sp.sin(y), 2 * sp.sin((x + y) / 2) * sp.cos((x - y) / 2)),
    (sp.sin(x * y), 2 * sp.sin(x * y / 2) * sp.cos(x * y / 2)),
    (sp.sin(2 * x / 7), 2 * sp.sin(x / 7) * sp.cos(x / 7)),
    (sp.sin(x - 2), sp.sin(x) * (1 - 2 * sp.sin(1) ** 2) - 2 * sp.cos(x) * sp.sin(1) * sp.cos(1)),
    (sp.exp(x), 1 / sp.exp(-x)),
    (sp.exp(x - 2 * y), sp.exp(x) / sp.exp(y) ** 2),
    (sp.exp(2), sp.E**2),
    (sp.cosh(x) ** 2, 1 + sp.sinh(x) ** 2),
    (sp.tanh(x), sp.sinh(x) / sp.cosh(x)),
]


@pytest.mark.parametrize(("left", "right"), IDENTITIES)
def test_a_rank_that_only_an_identity_shows(left: Any, right: Any) -> None:
    space = null_space(sp.Matrix([[left, y, 1], [right, y, 1], [left + y * right, y + y**2, 1 + y]]))
    assert space.redundant == (1, 2)
    assert (space.repeats[1], space.repeats[2]) == ({0: 1}, {0: 1 + y})


def test_a_redundant_row_with_expressions_for_coefficients() -> None:
    rows = sp.Matrix([[sp.sin(x), sp.cos(x), 1, y], [sp.cos(x), -sp.sin(x), 0, x]])
    third = sp.sin(x) ** 2 * rows[0, :] + sp.cos(x) ** 2 * rows[1, :]
    space = null_space(sp.Matrix.vstack(rows[0, :], third, rows[1, :]))
    point = {x: sp.Rational(7, 10), y: sp.Rational(13, 10)}
    ((redundant, factors),) = space.repeats.items()
    A = sp.Matrix.vstack(rows[0, :], third, rows[1, :])
    off = A[redundant, :] - sum((f * A[k, :] for k, f in factors.items()), sp.zeros(1, 4))
    assert max(abs(e) for e in off.subs(point).evalf(30)) < 1e-25
    assert max(abs(e) for e in (A * space.to_sympy()).subs(point).evalf(30)) < 1e-25


graph = Graph()
PAIR = [[graph.symbol("x"), Graph().symbol("x")]]


@pytest.mark.parametrize(
    "call",
    [
        lambda: echelon(None),  # type: ignore[arg-type]
        lambda: echelon([[1, 2], [3]]),
        lambda: echelon([[1, 2]], [0, 9]),
        lambda: echelon(PAIR),
        lambda: adjugate([[1, 2, 3], [4, 5, 6]]),
        lambda: adjugate([[[1], [2]], [[3], [4]]]),
        lambda: division_free("ab"),  # type: ignore[arg-type]
        lambda: division_free([[None, 1]]),
        lambda: paper_scaled([[1, 0], [0, 1]], 1, [7, 8]),
        lambda: paper_scaled([[1, 0], [0, 1]], None, [0, 1]),
        lambda: orthogonal_rate([[1], [2]], None),  # type: ignore[arg-type]
        lambda: basis_rate(3, 4),  # type: ignore[arg-type]
        lambda: subspace_angle(np.zeros((3, 1)), np.eye(3)[:, :1]),
        lambda: subspace_angle(np.ones((3, 2)), np.eye(3)[:, :2]),
        lambda: better_chart([[1.0, 2.0]], [0], float("nan")),
        lambda: charts([[1, 2, 3]], limit=float("nan")),  # type: ignore[arg-type]
        lambda: charts([[1, 2, 3]], at=3),  # type: ignore[arg-type]
        lambda: charts([[1, 2, 3]], method=["auto"]),  # type: ignore[arg-type]
        lambda: charts([[1, 2, 3]])[None],  # type: ignore[index]
        lambda: charts([[1, 2, 3]]).table(-1),
        lambda: null_space([[graph.symbol("x"), 1]]).condition_at([1]),
    ],
)
def test_named_errors(call: Callable[[], Any]) -> None:
    with pytest.raises(InputError):
        call()


def test_symbols_of_sympy_are_names_of_a_point() -> None:
    space = null_space(sp.Matrix([[x, y]]), [1])
    assert space.condition_at({x: 1.0, y: 2.0}) == space.condition_at({"x": 1.0, "y": 2.0}) == pytest.approx(5**0.5)


def test_an_orthogonal_basis_without_rows() -> None:
    assert orthogonal_basis(np.zeros((0, 2))) == orthogonal_basis(sp.Matrix(0, 2, [])) == ((1, 0), (0, 1))


def test_an_orthonormal_basis_comes_back_from_sympy() -> None:
    """SymPy's rules for powers of large sums would take minutes."""
    x, y, z = sp.symbols("x y z")
    A = sp.Matrix(3, 6, lambda i, j: sp.sin(x * (i + 1) + j) * y + sp.cos(z - j) ** (i + 1) + i * j)
    space = null_space(A, form="orthonormal")
    bridge, made = space._given.bridge, space.inward("orthonormal")
    assert [[bridge.read(space.basis[i, j]) for j in range(3)] for i in range(6)] == [list(row) for row in made]
