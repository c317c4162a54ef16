from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import assume, given
from hypothesis import strategies as st

from nullbody.errors import InputError, SingularityError
from nullbody.expr import Graph, cos, sin
from nullbody.nullspace import echelon, null_space, orthogonal_basis
from nullbody.nullspace.call import symbolic_null_space
from nullbody.nullspace.given import read

Rows = list[list[Any]]


def _product(A: Sequence[Sequence[Any]], N: Sequence[Sequence[Any]]) -> list[Any]:
    return [sum(a * x for a, x in zip(row, column, strict=True)) for row in A for column in zip(*N, strict=True)]


@st.composite
def defective(draw: st.DrawFn) -> Rows:
    """Integer matrices with zero rows and columns, duplicates, combinations and huge entries."""
    n = draw(st.integers(1, 6))
    entry = st.one_of(st.integers(-3, 3), st.just(0), st.sampled_from((10**40, -(10**25) + 1)))
    rows = draw(st.lists(st.lists(entry, min_size=n, max_size=n), min_size=1, max_size=4))
    for _ in range(draw(st.integers(0, 2))):
        i, j = (draw(st.integers(0, len(rows) - 1)) for _ in range(2))
        factor = draw(st.integers(-2, 2))
        rows.insert(draw(st.integers(0, len(rows))), [a + factor * b for a, b in zip(rows[i], rows[j], strict=True)])
    empty = draw(st.integers(-1, n - 1))
    rows = [[0 if j == empty else e for j, e in enumerate(row)] for row in rows]
    if sympy.Matrix(rows).rank() == n:  # another column, so that there is a null space
        rows = [[*row, row[0] - 2 * row[-1]] for row in rows]
    return rows


@given(defective())
def test_same_subspace_as_sympy_exactly(A: Rows) -> None:
    space = null_space(A)
    n, d = len(A[0]), len(space.independent)
    assert n - d == len(space.rows) == sympy.Matrix(A).rank()
    assert not any(_product(A, space.basis))
    assert [list(space.basis[j]) for j in space.independent] == [[int(i == k) for k in range(d)] for i in range(d)]


@given(defective())
def test_scaled_is_delta_times_the_basis(A: Rows) -> None:
    space = null_space(A)
    kept = sympy.Matrix([[A[i][j] for j in space.dependent] for i in space.rows])
    assert space.delta == (kept.det() if space.rows else 1)
    assert [[space.delta * e for e in row] for row in space.basis] == [list(row) for row in space.scaled]


@given(defective())
def test_orthogonal_columns_span_the_null_space(A: Rows) -> None:
    basis = orthogonal_basis(A)
    columns = list(zip(*basis, strict=True))
    assert len(columns) == len(null_space(A).independent)
    assert not any(_product(A, basis))
    for k, u in enumerate(columns):
        assert any(u)
        assert not any(sum(a * b for a, b in zip(u, v, strict=True)) for v in columns[:k])


@given(defective(), st.lists(st.integers(-5, 5), min_size=6, max_size=6))
def test_offset_solves_a_gamma_plus_c(A: Rows, numbers: list[int]) -> None:
    space = null_space(A)
    c = [sum(a * x for a, x in zip(row, numbers[: len(row)], strict=True)) for row in A]  # consistent
    gamma = space.offset(c)
    residual = [sum(a * g for a, g in zip(row, gamma, strict=True)) + e for row, e in zip(A, c, strict=True)]
    assert not any(residual)
    assert not any(gamma[j] for j in space.independent)
    assert list(space.offset_scaled(c)) == [space.delta * g for g in gamma]


@given(defective(), st.lists(st.integers(-5, 5), min_size=8, max_size=8))
def test_multipliers_reproduce_a_force_that_does_no_work(A: Rows, numbers: list[int]) -> None:
    space = null_space(A)
    force = [sum(row[j] * x for row, x in zip(A, numbers, strict=False)) for j in range(len(A[0]))]
    found = space.multipliers(force)
    assert [sum(row[j] * x for row, x in zip(A, found, strict=True)) for j in range(len(A[0]))] == force
    assert not any(found[i] for i in space.redundant)


@given(defective(), st.randoms(use_true_random=False))
def test_a_singular_choice_names_columns_that_would_do(A: Rows, random: Any) -> None:
    free = len(null_space(A).independent)
    chosen = random.sample(range(len(A[0])), free)
    dependent = [j for j in range(len(A[0])) if j not in chosen]
    singular = sympy.Matrix(A)[:, dependent].rank() < len(dependent)
    if not singular:
        assert null_space(A, chosen).independent == tuple(chosen)
        return
    with pytest.raises(SingularityError, match="would do") as caught:
        null_space(A, chosen)
    named = [int(j) for j in str(caught.value).rpartition("[")[2].partition("]")[0].split(",")]
    assert null_space(A, named).delta != 0


@pytest.mark.parametrize("shape", [(1, 2), (2, 4), (4, 7), (5, 6), (9, 12)])
def test_floats(shape: tuple[int, int]) -> None:
    A = np.random.default_rng(shape[1]).normal(size=shape)
    space = null_space(A)
    N, scaled = np.array(space.basis), np.array(space.scaled)
    assert np.abs(A @ N).max() < 1e-11 * np.abs(N).max()
    np.testing.assert_allclose(space.delta, np.linalg.det(A[:, list(space.dependent)]), rtol=1e-11)
    np.testing.assert_allclose(scaled, space.delta * N, rtol=1e-9, atol=1e-12)
    reference = np.linalg.svd(A)[2][shape[0] :].T
    assert np.abs(N - reference @ (reference.T @ N)).max() < 1e-10 * np.abs(N).max()


@pytest.mark.parametrize("d", [1, 2, 3])
def test_orthogonal_basis_of_expressions(d: int) -> None:
    graph = Graph()
    symbols = [graph.symbol(f"a{k}") for k in range(2 * (2 + d))]
    A = [symbols[: 2 + d], symbols[2 + d :]]
    columns = list(zip(*orthogonal_basis(A), strict=True))
    assert all(sum((a * x for a, x in zip(row, u, strict=True)), graph.constant(0)) == 0 for row in A for u in columns)
    for k, u in enumerate(columns):
        assert all(sum((a * b for a, b in zip(u, v, strict=True)), graph.constant(0)) == 0 for v in columns[:k])
    graph.verify()


def test_scaled_orthogonal_basis_is_orthogonal_too() -> None:
    A = [[1, 2, 0, 1, 4], [5, 8, 1, 3, -1]]
    columns = list(zip(*orthogonal_basis(A, scaled=True), strict=True))
    assert not any(_product(A, list(zip(*columns, strict=True))))
    assert [sum(a * b for a, b in zip(columns[i], columns[j], strict=True)) for i, j in ((0, 1), (0, 2), (1, 2))] == [
        0
    ] * 3


def test_sympy_expressions() -> None:
    a, b, c = sympy.symbols("a b c")
    space = null_space([[a, b, c]], [1, 2])
    assert space.delta == a
    assert all(sympy.simplify(value) == 0 for value in _product([[a, b, c]], space.basis))


def test_graph_expressions_of_a_block_triangular_matrix() -> None:
    graph = Graph()
    x, y, z, w = (graph.symbol(name) for name in "xyzw")
    A = [[x, y, 0, 0, 1], [y, w, 0, 0, z], [x, 1, z, y, 2], [z, x, w, z, y]]
    space = null_space(A, [4])
    assert all(value == 0 for value in _product(A, space.basis) + _product(A, space.scaled))
    assert space.delta == (x * w - y * y) * (z * z - y * w)
    graph.verify()


def test_expressions_and_plain_numbers_mix() -> None:
    graph = Graph()
    x = graph.symbol("x")
    A = [[Fraction(1, 2), x, 1], [Fraction(1, 3), 1, x], [Fraction(5, 6), 1 + x, 1 + x]]
    space = null_space(A)
    assert space.redundant == (2,)
    assert all(value == 0 for value in _product(A, space.basis))


def test_rank_through_an_identity_of_trigonometry() -> None:
    graph = Graph()
    x = graph.symbol("x")
    A = [[sin(x), cos(x), 1], [cos(x), -sin(x), 0], [1, 0, sin(x)]]  # row 3 = sin row 1 + cos row 2
    assert null_space(A).redundant == (2,)
    assert echelon(A).rank == 2


def test_the_leading_minor_of_the_robot_vanishes_by_an_identity(three_prs_jacobian: Rows) -> None:
    """Elimination in the order of the columns meets a 6 x 6 minor that is zero only through sin^2 + cos^2 = 1."""
    A = three_prs_jacobian
    (minor,) = [null.rank for null in [echelon([row[:6] for row in A[:6]])]]
    assert minor == 5
    space = null_space(A, [9, 10, 11])
    assert all(value == 0 for value in _product(A, space.scaled))
    assert space.delta != 0


def test_an_identically_singular_chart_of_the_robot_names_a_good_one(three_prs_jacobian: Rows) -> None:
    with pytest.raises(SingularityError, match=r"identically zero; columns \[.*\] would do") as caught:
        null_space(three_prs_jacobian, [3, 4, 5])
    named = [int(j) for j in str(caught.value).rpartition("[")[2].partition("]")[0].split(",")]
    assert null_space(three_prs_jacobian, named).delta != 0


@given(defective())
def test_the_order_of_the_free_columns_is_the_callers(A: Rows) -> None:
    free = null_space(A).independent
    assume(len(free) > 1)
    turned = null_space(A, free[::-1])
    assert [row[::-1] for row in turned.basis] == [tuple(row) for row in null_space(A, free).basis]


def test_a_regular_square_matrix_leaves_nothing_free() -> None:
    for A in ([[2, 1], [1, 1]], [[2, 1], [1, 1], [0, 5]], [[2.0, 1.0], [1.0, 1.0]], sympy.eye(2), np.eye(3)):
        with pytest.raises(InputError, match=r"nothing but 0|only 0"):
            null_space(A)
    space = symbolic_null_space(read([[2, 1], [1, 1]]))  # a mechanism may have no freedom
    assert (space.basis, space.scaled, space.independent) == (((), ()), ((), ()), ())
    assert space.offset([3, 2]) == (-1, -1)


def test_a_zero_matrix_leaves_everything_free() -> None:
    space = null_space([[0, 0], [0, 0]])
    assert space.basis == ((1, 0), (0, 1))
    assert (space.delta, space.redundant, space.multipliers([0, 0])) == (1, (0, 1), (0, 0))
