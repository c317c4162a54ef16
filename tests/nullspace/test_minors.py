from __future__ import annotations

from itertools import permutations, product
from typing import Any

import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from nullbody.errors import InputError
from nullbody.expr import Graph, operations
from nullbody.nullspace import adjugate
from nullbody.nullspace.minors import LARGEST, parity
from nullbody.nullspace.structure import block_triangular, perfect_matching


def matrices(largest: int = 6) -> st.SearchStrategy[list[list[int]]]:
    entries = st.one_of(st.integers(-9, 9), st.just(0))
    return st.integers(0, largest).flatmap(
        lambda n: st.lists(st.lists(entries, min_size=n, max_size=n), min_size=n, max_size=n)
    )


def leibniz(matrix: list[list[Any]]) -> Any:
    """|B| = sum over the permutations."""
    total: Any = 0
    for order in permutations(range(len(matrix))):
        term: Any = parity(list(order))
        for i, j in enumerate(order):
            term = term * matrix[i][j]
        total = total + term
    return total


@given(matrices(5))
def test_determinant_equals_leibniz(matrix: list[list[int]]) -> None:
    assert adjugate(matrix)[1] == leibniz(matrix) * 1


@settings(max_examples=30)
@given(matrices())
def test_adjugate_equals_sympy(matrix: list[list[int]]) -> None:
    adj, delta = adjugate(matrix)
    theirs = sympy.Matrix(len(matrix), len(matrix), [e for row in matrix for e in row])
    assert delta == theirs.det()
    assert adj == theirs.adjugate().tolist()


@pytest.mark.parametrize("n", range(5))
def test_adjugate_of_symbols(n: int) -> None:
    graph = Graph()
    B = [[graph.symbol(f"b{i}{j}") for j in range(n)] for i in range(n)]
    adj, delta = adjugate(B)
    assert graph.constant(0) + delta == leibniz(B)
    for i, j in product(range(n), repeat=2):
        entry = sum((B[i][k] * adj[k][j] for k in range(n)), graph.constant(0))
        assert entry == (delta if i == j else 0)
    graph.verify()


def test_every_minor_is_made_once() -> None:
    """A dense n x n adjugate by prefix and suffix minors: 73 products for n = 4, against 192 by cofactors."""
    graph = Graph()
    adj, delta = adjugate([[graph.symbol(f"b{i}{j}") for j in range(4)] for i in range(4)])
    assert operations([delta, *(e for row in adj for e in row)]).mul <= 100


def test_a_matrix_too_large_is_refused() -> None:
    n = LARGEST + 1
    with pytest.raises(InputError, match=f"{n} x {n} matrix is too large"):
        adjugate([[1] * n] * n)


@given(st.permutations(range(6)))
def test_parity_is_the_sign_of_the_permutation_matrix(order: list[int]) -> None:
    assert parity(order) == sympy.Matrix(6, 6, lambda i, j: int(order[i] == j)).det()


def patterns() -> st.SearchStrategy[list[list[int]]]:
    return st.integers(1, 6).flatmap(
        lambda n: st.lists(st.lists(st.integers(0, n - 1), unique=True, max_size=n), min_size=n, max_size=n)
    )


@given(patterns())
def test_a_matching_exists_where_a_permutation_does(columns_of: list[list[int]]) -> None:
    n = len(columns_of)
    exists = any(all(j in columns_of[i] for i, j in enumerate(order)) for order in permutations(range(n)))
    row_of = perfect_matching(columns_of)
    assert (row_of is not None) == exists
    if row_of is not None:
        assert sorted(row_of) == list(range(n))
        assert all(column in columns_of[row] for column, row in enumerate(row_of))


@given(patterns())
def test_blocks_depend_on_later_blocks_only(columns_of: list[list[int]]) -> None:
    blocks = block_triangular(columns_of)
    if blocks is None:
        assert perfect_matching(columns_of) is None
        return
    assert sorted(j for _, columns in blocks for j in columns) == list(range(len(columns_of)))
    for k, (rows, columns) in enumerate(blocks):
        assert len(rows) == len(columns)
        allowed = {j for _, later in blocks[k:] for j in later}
        assert all(set(columns_of[i]) <= allowed for i in rows)


def test_a_triangular_matrix_has_blocks_of_one() -> None:
    assert block_triangular([[0, 1, 2], [1, 2], [2]]) == [([0], [0]), ([1], [1]), ([2], [2])]
    assert block_triangular([[0, 1], [0, 1], [2]]) in ([([2], [2]), ([0, 1], [0, 1])], [([0, 1], [0, 1]), ([2], [2])])
