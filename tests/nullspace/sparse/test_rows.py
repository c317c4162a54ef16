"""Redundant rows, their combinations, and rows of very different size."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from scipy import sparse

from nullbody.nullspace.numeric.angle import subspace_angle
from nullbody.nullspace.sparse import sparse_null_space
from tests.nullspace.sparse.matrices import (
    chain,
    dense,
    incidence,
    random_sparse,
    regular_rows,
    sparse_matrices,
    svd_basis,
)


@settings(max_examples=30)
@given(sparse_matrices())
def test_combinations_give_the_redundant_rows(A: Any) -> None:
    if not svd_basis(A).shape[1]:
        return
    space, full = sparse_null_space(A), A.toarray()
    assert tuple(space.repeats) == space.redundant
    for i, combination in space.repeats.items():
        assert set(combination) <= set(space.rows)
        again = sum((value * full[k] for k, value in combination.items()), np.zeros(A.shape[1]))
        assert np.allclose(again, full[i], atol=1e-11)


def test_planted_combinations_are_found() -> None:
    A = regular_rows(40, 70, 4).toarray()
    rows = np.vstack([A, 2 * A[3] - 0.5 * A[7], A[11], np.zeros(70)])
    space = sparse_null_space(sparse.csr_array(rows))
    assert space.rank == 40 and len(space.redundant) == 3 and 42 in space.redundant
    found = [{i, *combination} for i, combination in space.repeats.items() if combination]
    assert sorted(found, key=len) == [{11, 41}, {3, 7, 40}]
    assert space.repeats[42] == {}


def test_a_row_of_a_grid_repeats_all_others() -> None:
    space = sparse_null_space(incidence(12))
    assert len(space.redundant) == 1
    assert space.repeats[space.redundant[0]] == dict.fromkeys(space.rows, -1.0)


def test_rows_of_any_size() -> None:
    A = chain(8)
    exponents = np.random.default_rng(0).integers(-100, 101, A.shape[0])
    scaled = sparse.dia_array((10.0 ** exponents[None], [0]), shape=(A.shape[0],) * 2) @ A
    space, plain = sparse_null_space(scaled), sparse_null_space(A)
    assert space.rows == plain.rows
    assert subspace_angle(dense(space), dense(plain)) < 1e-13


def test_combinations_of_rows_of_any_size() -> None:
    A = regular_rows(30, 50, 4).toarray()
    A[5] *= 1e100
    A[9] *= 1e-100
    rows = np.vstack([A, A[5] * 1e-100 + A[9] * 1e100])
    ((i, combination),) = sparse_null_space(sparse.csr_array(rows)).repeats.items()
    whole = {i: -1.0, **combination}
    assert set(whole) == {5, 9, 30}
    assert whole[5] / whole[30] == pytest.approx(-1e-100) and whole[9] / whole[30] == pytest.approx(-1e100)


@pytest.mark.parametrize(("distance", "rank"), [(1e-9, 31), (1e-11, 31), (1e-15, 30)])
def test_nearly_dependent_rows(distance: float, rank: int) -> None:
    A = regular_rows(30, 60, 4)
    near = A[[4]] + A[[8]] + distance * random_sparse(1, 60, 20, seed=1)
    assert sparse_null_space(sparse.vstack([A, near])).rank == rank


def test_tolerance_decides_what_is_dependent() -> None:
    A = regular_rows(30, 60, 4)
    near = sparse.vstack([A, A[[4]] + A[[8]] + 1e-9 * random_sparse(1, 60, 20, seed=1)])
    assert sparse_null_space(near, tolerance=1e-6).rank == 30


def test_structurally_singular_columns() -> None:
    """Forty rows that use five columns only: 35 of them repeat others, whatever their entries are."""
    narrow = np.zeros((40, 60))
    narrow[:, [3, 17, 21, 30, 44]] = np.random.default_rng(0).standard_normal((40, 5))
    A = sparse.vstack([sparse.csr_array(narrow), random_sparse(30, 60, 3)], format="csr")
    space = sparse_null_space(A)
    assert space.rank == np.linalg.matrix_rank(A.toarray())
    assert subspace_angle(dense(space), svd_basis(A)) < 1e-12


def test_zero_matrix_repeats_nothing() -> None:
    space = sparse_null_space(sparse.csr_array((3, 4)))
    assert space.rank == 0 and space.repeats == {0: {}, 1: {}, 2: {}}
    assert np.array_equal(dense(space), np.eye(4))
