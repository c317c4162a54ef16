"""The null space is that of dense SVD, whatever the shape, the rank and the structure."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from nullbody.errors import InputError
from nullbody.nullspace.numeric.angle import subspace_angle
from nullbody.nullspace.sparse import sparse_null_space
from nullbody.nullspace.sparse.basis import reduced_basis
from nullbody.nullspace.sparse.elimination import eliminated
from nullbody.nullspace.sparse.read import Scaled
from nullbody.tolerances import EPS
from tests.nullspace.sparse.matrices import (
    chain,
    dense,
    incidence,
    random_sparse,
    regular_rows,
    sparse_matrices,
    svd_basis,
)


@settings(max_examples=60)
@given(sparse_matrices())
def test_same_subspace_as_dense_svd(A: Any) -> None:
    Z = svd_basis(A)
    if not Z.shape[1]:
        with pytest.raises(InputError, match="only 0"):
            sparse_null_space(A)
        return
    space = sparse_null_space(A)
    assert space.shape == Z.shape
    assert subspace_angle(dense(space), Z) <= max(1e-13, 10 * space.subspace_error)
    assert space.subspace_error < 1e-9


@settings(max_examples=60)
@given(sparse_matrices())
def test_result_is_consistent(A: Any) -> None:
    m, n = A.shape
    if not svd_basis(A).shape[1]:
        return
    space = sparse_null_space(A)
    assert sorted((*space.independent, *space.dependent)) == list(range(n))
    assert sorted((*space.rows, *space.redundant)) == list(range(m))
    assert len(space.rows) == len(space.dependent) == space.rank
    assert np.array_equal(dense(space)[list(space.independent)], np.eye(space.shape[1]))
    assert space.condition == pytest.approx(np.linalg.norm(dense(space), 2), rel=0.1)


@pytest.mark.parametrize(
    "A", [chain(1), chain(12), incidence(9), random_sparse(200, 240, 4), random_sparse(90, 300, 3)]
)
def test_residual_is_rounding(A: Any) -> None:
    space = sparse_null_space(A)
    N = dense(space)
    residual = abs(A @ N).max(axis=0) / (abs(A).sum(axis=1).max() * abs(N).max(axis=0))
    assert residual.max() < 1e-15
    assert subspace_angle(N, svd_basis(A)) < 1e-13


def test_chain_of_four_bars_has_a_freedom_for_each_loop() -> None:
    space = sparse_null_space(chain(50))
    assert space.shape == (450, 50)
    assert not space.redundant
    assert space.condition < 1e3


def test_loops_of_a_grid_are_found_exactly() -> None:
    A = incidence(30)
    space = sparse_null_space(A)
    assert space.redundant and space.shape[1] == 29 * 29
    assert set(np.unique(space.basis.data)) <= {-1.0, 1.0}
    assert not (A @ space.basis).count_nonzero()


@settings(max_examples=60)
@given(sparse_matrices(), st.sampled_from(["orthogonal", "orthonormal"]))
def test_columns_at_right_angles(A: Any, form: Any) -> None:
    if not svd_basis(A).shape[1]:
        return
    space = sparse_null_space(A, form=form)
    gram = space.basis.conj().T @ space.basis
    lengths = np.diagonal(gram)
    assert np.allclose(
        gram, np.diag(np.ones(len(gram)) if form == "orthonormal" else lengths), atol=1e-13 * lengths.max()
    )
    assert subspace_angle(space.basis, dense(space)) < 1e-13 + 10 * space.subspace_error


def test_orthogonal_columns_keep_their_multiple_of_the_reduced_ones() -> None:
    space = sparse_null_space(chain(4), form="orthogonal")
    T = np.linalg.lstsq(dense(space), space.basis)[0]
    assert np.allclose(T, np.triu(T)) and np.allclose(np.diagonal(T), 1)


@pytest.mark.parametrize("near", [1e-3, 1e-7])
def test_error_is_told_near_a_singular_chart(near: float) -> None:
    A = sparse.csr_array(np.array([[1.0, 1.0, 0.3, 0.2], [1.0, 1.0 + near, 0.7, 0.1]]))
    bad, good = sparse_null_space(A, (2, 3)), sparse_null_space(A)
    assert bad.condition > 0.1 / near > 10 > good.condition
    angle = subspace_angle(dense(bad), svd_basis(A))
    assert angle <= bad.subspace_error < 100 * EPS / near


def test_rows_that_nearly_repeat_others_show_in_the_error() -> None:
    A = regular_rows(20, 30, 4).tolil()
    A[[1]] = A[[0]] + 1e-8 * A[[1]]
    space = sparse_null_space(A.tocsr())
    assert space.rank == 20 and space.condition < 100
    assert 1e-9 < space.subspace_error < 1e-5


def test_no_rows_leave_everything_free() -> None:
    space = sparse_null_space(sparse.csr_array((0, 5)))
    assert np.array_equal(dense(space), np.eye(5)) and space.delta == 1 and space.condition == pytest.approx(1)
    assert not space.offset(np.zeros(0)).any()


def test_refinement_makes_up_for_factors_that_are_a_little_wrong() -> None:
    A = Scaled.of(chain(6)).matrix
    wrong = A.copy()
    wrong.data = A.data * (1 + 1e-9 * np.random.default_rng(0).standard_normal(A.nnz))
    factors = eliminated(wrong, 1e-6).factors
    N = reduced_basis(A, factors)
    assert abs(A @ factors.null_columns(np.arange(6))).max() > 1e-10
    assert abs(A @ N).max() < 1e-15 * abs(N).max()


@pytest.mark.parametrize("small", [1e-7, 1e-12, 1e-14])
def test_small_entries_that_rows_notice_are_kept(small: float) -> None:
    A = sparse.csr_array(np.array([[1.0, 0.0, -1.0], [0.0, 1.0, -small]]))
    assert dense(sparse_null_space(A, [2]))[:, 0].tolist() == [1.0, small, 1.0]


def test_differences_that_rows_notice_are_kept() -> None:
    A = sparse.csr_array(np.array([[1.0, 0.0, -1.0], [1.0, 1.0, -1.0 - 1e-10]]))
    assert dense(sparse_null_space(A, [2]))[1, 0] == pytest.approx(1e-10, rel=1e-5)


def test_repr_fits_a_line() -> None:
    text = repr(sparse_null_space(chain(30)))
    assert text.startswith("<NullSpace reduced 270 x 30, rank 240, independent columns [") and len(text) < 200
    assert "by sparse elimination, subspace error" in text
