"""The paper's procedure [14-18], and the cheap way to the same columns."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array

from nullbody.errors import InputError, SingularityError
from nullbody.expr import Graph
from nullbody.nullspace import null_space, orthogonal_basis
from nullbody.nullspace.gram import division_free, orthogonal, paper_scaled

Rows = Sequence[Sequence[Any]]


def as_lists(rows: Rows) -> list[list[Any]]:
    return [list(row) for row in rows]


@st.composite
def constrained(draw: st.DrawFn) -> tuple[list[list[int]], list[int]]:
    """An integer matrix, perhaps with rows that repeat others, and a regular choice of 2, 3 or 4 columns."""
    d, m = draw(st.integers(2, 4)), draw(st.integers(1, 3))
    row = st.lists(st.integers(-4, 4), min_size=d + m, max_size=d + m)
    A = draw(st.lists(row, min_size=m, max_size=m))
    if draw(st.booleans()):
        A.insert(draw(st.integers(0, m)), [draw(st.integers(-2, 2)) * a + b for a, b in zip(A[0], A[-1], strict=True)])
    columns = draw(st.permutations(range(d + m)))[:d]
    try:
        null_space(A, columns)
    except (InputError, SingularityError):
        assume(False)
    return A, columns


@given(constrained())
def test_the_gram_matrix_gives_the_same_columns(given_: tuple[list[list[int]], list[int]]) -> None:
    A, columns = given_
    assert as_lists(orthogonal_basis(A, columns)) == as_lists(orthogonal(null_space(A, columns).reduced))


@given(constrained())
def test_the_papers_scaling_by_its_law(given_: tuple[list[list[int]], list[int]]) -> None:
    A, columns = given_
    space = null_space(A, columns)
    literal = as_lists(orthogonal_basis(A, columns, scaled=True))
    assert literal == as_lists(paper_scaled(space.reduced, space.delta, columns))


@given(constrained())
def test_the_papers_scaling_in_terms_of_division_free_columns(given_: tuple[list[list[int]], list[int]]) -> None:
    """f_1 = 1, f_k = f_(k-1)^2 |G_(k-2)| / delta: v_2 / delta, g_11 v_3 / delta^3, g_11^2 |G_2| v_4 / delta^7."""
    A, columns = given_
    space = null_space(A, columns)
    literal = list(zip(*orthogonal_basis(A, columns, scaled=True), strict=True))
    free = list(zip(*division_free(space.scaled), strict=True))
    g, minors = sympy.Matrix(space.scaled).T * sympy.Matrix(space.scaled), [Fraction(1)]
    minors += [Fraction(str(g[:k, :k].det())) for k in range(1, len(columns))]
    factor = Fraction(1)
    for k, (theirs, ours) in enumerate(zip(literal, free, strict=True)):
        factor = factor * factor * minors[k - 1] / space.delta if k else factor
        scaled = [factor * entry for entry in ours]
        assert list(theirs) in (scaled, [-entry for entry in scaled])


def test_the_sign_is_that_of_the_places() -> None:
    A = [[1, 2, 0, 1], [5, 8, 1, 3]]
    for columns in ([2, 3], [3, 2], [0, 1], [0, 3], [2, 1]):
        space = null_space(A, columns)
        assert as_lists(orthogonal_basis(A, columns, scaled=True)) == as_lists(
            paper_scaled(space.reduced, space.delta, columns)
        )


def test_the_papers_appendix() -> None:
    third = Fraction(1, 3)
    expected = [[-1, third], [Fraction(1, 2), -2 * third], [1, 2 * third], [0, 1]]
    A = [[1, 2, 0, 1], [5, 8, 1, 3]]
    assert as_lists(orthogonal_basis(A)) == as_lists(null_space(A, form="orthogonal").basis) == expected
    columns = list(zip(*expected, strict=True))
    assert [sum(a * a for a in column) for column in columns] == [Fraction(9, 4), 2]


@settings(max_examples=20)
@given(constrained())
def test_arrays_take_the_same_way(given_: tuple[list[list[int]], list[int]]) -> None:
    A, columns = given_
    for scaled in (False, True):
        exact = np.array(orthogonal_basis(A, columns, scaled=scaled), float)
        found = np.array(orthogonal_basis(np.array(A, float), columns, scaled=scaled))
        if scaled:  # where rows repeat others |B| belongs to the rows that are kept, and arrays may keep other ones
            largest = np.abs(exact).argmax(axis=0), np.arange(len(columns))
            exact, found = exact / exact[largest], found / found[largest]
        np.testing.assert_allclose(found, exact, rtol=1e-7, atol=1e-9 * np.abs(exact).max())


def test_sympy_matrices_and_expressions() -> None:
    A = sympy.Matrix([[1, 2, 0, 1], [5, 8, 1, 3]])
    assert sympy.Matrix(orthogonal_basis(A)) == sympy.Matrix(orthogonal_basis(A.tolist()))
    a, b, c = sympy.symbols("a b c")
    u, v = zip(*orthogonal_basis(sympy.Matrix([[a, b, c]])), strict=True)
    assert sympy.simplify(sum(x * y for x, y in zip(u, v, strict=True))) == 0
    assert sympy.simplify(sum(x * y for x, y in zip((a, b, c), v, strict=True))) == 0


def test_expressions_in_the_papers_scaling_need_no_division() -> None:
    graph = Graph()
    A = [[graph.symbol(f"{name}{k}") for k in range(4)] for name in "ab"]
    basis = orthogonal_basis(A, [2, 3], scaled=True)
    code = graph.reachable(entry.ref for row in basis for entry in row if entry != 0)
    assert not any(graph.code[node][0] == "inv" for node in code)
    space = null_space(A, [2, 3])
    cheap = paper_scaled(space.reduced, space.delta, [2, 3])
    assert all(a == b for left, right in zip(basis, cheap, strict=True) for a, b in zip(left, right, strict=True))
    graph.verify()


@pytest.mark.parametrize("A", [np.ones((2, 1, 3)), csr_array(np.eye(2, 3)), 5, [1, 2]])
def test_what_it_does_not_take(A: Any) -> None:
    with pytest.raises(InputError, match=r"one dense matrix|must be a matrix"):
        orthogonal_basis(A)
