from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from nullbody.catalog import three_prs
from nullbody.equations.closure import closures
from nullbody.equations.motion import MotionExpressions
from nullbody.errors import InputError
from nullbody.expr import Exact, Expr, Graph, Tape, operations
from nullbody.nullspace import null_space
from nullbody.nullspace.gram import division_free, orthogonal, orthonormal, paper_scaled

Rows = Sequence[Sequence[Any]]


def gram(basis: Rows) -> list[list[Any]]:
    columns = list(zip(*basis, strict=True))
    return [[sum(a * b for a, b in zip(u, v, strict=True)) for v in columns] for u in columns]


def is_diagonal(matrix: Rows) -> bool:
    return all(entry == 0 for i, row in enumerate(matrix) for j, entry in enumerate(row) if i != j)


def product(A: Rows, N: Rows) -> list[Any]:
    return [sum(a * x for a, x in zip(row, column, strict=True)) for row in A for column in zip(*N, strict=True)]


def count(basis: Rows) -> int:
    return operations([entry for row in basis for entry in row if isinstance(entry, Expr)]).arithmetic


def robot() -> list[list[Any]]:
    """A of the 3-PRS in a graph that holds nothing else, so that operations are counted as they are made here."""
    mechanism, graph = three_prs(), Graph()
    return [list(row) for row in closures(mechanism, MotionExpressions.of(mechanism, graph)).A]


@st.composite
def bases(draw: st.DrawFn) -> list[list[Fraction]]:
    """Reduced bases N = [X; I] with zeros, and rows in any order."""
    d = draw(st.integers(1, 4))
    entry = st.one_of(st.just(Fraction(0)), st.fractions(-4, 4, max_denominator=5))
    rows = draw(st.lists(st.lists(entry, min_size=d, max_size=d), max_size=4))
    rows += [[Fraction(i == j) for j in range(d)] for i in range(d)]
    return draw(st.permutations(rows))


@given(bases())
def test_orthogonal_is_the_basis_times_a_unit_upper_triangle(N: Rows) -> None:
    basis = orthogonal(N)
    assert is_diagonal(gram(basis))
    places = [N.index([Fraction(i == j) for j in range(len(N[0]))]) for i in range(len(N[0]))]
    T = [basis[i] for i in places]
    assert all(T[i][j] == int(i == j) for i in range(len(T)) for j in range(i + 1))
    assert [list(row) for row in basis] == [[*product([row], T)] for row in N]


@given(bases())
def test_division_free_columns_are_minors_times_the_orthogonal_ones(N: Rows) -> None:
    columns, expected = (list(zip(*rows, strict=True)) for rows in (division_free(N), orthogonal(N)))
    minor = Fraction(1)
    for v, u in zip(columns, expected, strict=True):
        assert list(v) == [minor * entry for entry in u]
        minor *= sum(entry * entry for entry in u)


def test_division_free_keeps_integers_and_says_where_columns_depend() -> None:
    basis = division_free([[1, 2, 3], [0, 1, 4], [5, 0, 2], [2, 2, 2]])
    assert all(type(entry) is int for row in basis for entry in row)
    assert is_diagonal(gram(basis))
    assert [row[1] for row in division_free([[1, 2], [2, 4]])] == [0, 0]


@given(bases())
def test_orthonormal_numbers_are_exact_square_roots(N: Rows) -> None:
    try:
        basis = orthonormal(N)
    except InputError as error:
        assert "take the form 'orthogonal', or floats" in str(error)
        assume(False)
    columns = list(zip(*basis, strict=True))
    for u, v in combinations(range(len(columns)), 2):
        assert sum((a * b for a, b in zip(columns[u], columns[v], strict=True)), Exact.of(0)) == Exact.of(0)
    assert all(sum((a * a for a in column), Exact.of(0)) == Exact.of(1) for column in columns)


def test_orthonormal_numbers_that_cannot_be_kept_say_what_to_take() -> None:
    with pytest.raises(InputError, match=r"prime factor is above 1000; take the form 'orthogonal', or floats"):
        orthonormal([[Fraction(1_000_003)], [1], [0]])  # 1 + 1000003^2 = 2 * 5 * 100000600001 and no square


@pytest.mark.parametrize("form", [orthogonal, orthonormal])
def test_floats(form: Callable[[Rows], Rows]) -> None:
    N = np.random.default_rng(3).normal(size=(9, 4))
    found = np.array(form(N.tolist()))
    G = found.T @ found
    np.testing.assert_allclose(G - np.diag(np.diag(G)), 0, atol=1e-13)
    assert np.linalg.matrix_rank(np.hstack([N, found])) == 4
    np.testing.assert_allclose(found / np.linalg.norm(found, axis=0), orthonormal(N.tolist()), atol=1e-13)


def test_rounding_grows_with_the_condition_not_with_its_square() -> None:
    """Columns that become parallel, as they do near |B| = 0: the square would be 1e-5 at 1e6."""
    rng = np.random.default_rng(1)
    for near in (1e-2, 1e-4, 1e-6):
        parallel = np.outer(rng.normal(size=9), rng.normal(size=3)) / near
        N = np.vstack([parallel + rng.normal(size=(9, 3)), np.eye(3)])
        Z = np.array(orthonormal(N.tolist()))
        assert np.abs(Z.T @ Z - np.eye(3)).max() < 10 * 2.2e-16 * np.linalg.cond(N)


@pytest.mark.parametrize("N", [[[1, 2], [2, 4]], [[1.0, 1 / 3], [3.0, 1.0]], [[0], [0]]])
def test_dependent_columns_are_named(N: Rows) -> None:
    for form in (orthogonal, orthonormal):
        with pytest.raises(InputError, match=f"column {len(N[0]) - 1} of the basis is a combination"):
            form(N)


@pytest.mark.parametrize("N", [[], [[]], [[1, 2], [3]]])
def test_what_is_no_basis_is_refused(N: Rows) -> None:
    for form in (orthogonal, orthonormal, division_free):
        with pytest.raises(InputError, match="non-empty list of rows of equal length"):
            form(N)


def test_too_many_columns_for_minors_and_for_the_places() -> None:
    with pytest.raises(InputError, match="15 columns are too many for minors"):
        division_free(np.eye(15, dtype=int).tolist())
    with pytest.raises(InputError, match="a basis of 2 columns has as many independent places"):
        paper_scaled([[1, 0], [0, 1]], 1, [1])


def test_a_row_that_is_a_multiple_of_another_is_not_transformed_again() -> None:
    """k times a row: k^2 + 1 and two products for its weight, one product for each entry, nothing else."""
    counts = []
    for multiple in (False, True):
        graph = Graph()
        row = [graph.symbol(f"a{j}") for j in range(3)]
        k = graph.symbol("k")
        N = [row, [graph.symbol(f"b{j}") for j in range(3)], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        N += [[k * entry for entry in row]] if multiple else []
        basis = orthogonal(N)
        assert is_diagonal(gram(basis))
        graph.verify()
        counts.append(count(basis))
    assert counts[1] - counts[0] == 2 + 2 + 3


def test_rows_of_opposite_sign_and_of_one_entry_are_multiples_too() -> None:
    graph = Graph()
    a, b, c = (graph.symbol(name) for name in "abc")
    N = [[a, b], [-a, -b], [2 * a, 2 * b], [c, 0], [0, 0], [1, 0], [0, 1]]
    basis = orthogonal(N)
    assert is_diagonal(gram(basis))
    assert all(x == -y for x, y in zip(basis[0], basis[1], strict=True))
    assert all(y == 2 * x for x, y in zip(basis[0], basis[2], strict=True))
    assert basis[3][1] == c * basis[5][1]


def test_a_row_and_its_opposite_count_twice() -> None:
    graph = Graph()
    a, b = graph.symbol("a"), graph.symbol("b")
    assert count(orthogonal([[a, b], [-a, -b], [1, 0], [0, 1]])) == 8  # l = 2 a b / (2 a^2 + 1), b - l a


def test_operations_on_the_robot() -> None:
    """On top of N at most 140 operations, 192 with unit columns: x' is a multiple of theta', which saves 12 and 16."""
    for form, limit in ((orthogonal, 140), (orthonormal, 192)):
        N = null_space(robot(), [9, 10, 11], method="elimination").reduced
        before = count(N)
        assert count(form(N)) - before <= limit


def test_the_robots_bases_are_orthogonal_null_spaces_identically() -> None:
    A = robot()
    space = null_space(A, [9, 10, 11], method="elimination")
    for basis in (orthogonal(space.reduced), division_free(space.scaled)):
        assert is_diagonal(gram(basis))
        assert all(value == 0 for value in product(A, basis))
    A[0][0].graph.verify()


def test_the_robots_orthonormal_basis_at_a_point() -> None:
    A = robot()
    flat = [e for row in orthonormal(null_space(A, [9, 10, 11]).reduced) for e in row]
    names = A[0][0].graph.symbols
    values = np.random.default_rng(5).uniform(0.5, 1.5, len(names))
    expressions = [e for e in flat if isinstance(e, Expr)]
    numbers = dict(zip(map(id, expressions), Tape.of(expressions, names).run(values.tolist()), strict=True))
    Z = np.array([numbers[id(e)] if isinstance(e, Expr) else float(e) for e in flat]).reshape(12, 3)
    np.testing.assert_allclose(Z.T @ Z, np.eye(3), atol=1e-13)


def test_the_papers_scaling_costs_half_of_the_papers_procedure() -> None:
    A = robot()
    space = null_space(A, [9, 10, 11], method="elimination")
    basis = paper_scaled(space.reduced, space.delta, space.independent)
    assert is_diagonal(gram(basis))
    assert count(basis) <= 420
