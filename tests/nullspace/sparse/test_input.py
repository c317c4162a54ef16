"""What is accepted as a sparse matrix, and what is refused by name."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import sparse

from nullbody.errors import InputError, UnknownName
from nullbody.nullspace.sparse import sparse_null_space
from tests.nullspace.sparse.matrices import chain, dense, incidence, random_sparse


@pytest.mark.parametrize("kind", ["bsr", "coo", "csc", "csr", "dia", "dok", "lil"])
@pytest.mark.parametrize("family", ["array", "matrix"])
def test_every_format_gives_the_same(kind: str, family: str) -> None:
    A = chain(2)
    given = getattr(sparse, f"{kind}_{family}")(A.toarray())
    assert np.array_equal(dense(sparse_null_space(given)), dense(sparse_null_space(A)))


@pytest.mark.parametrize("dtype", [np.int8, np.int64, np.float32, bool])
def test_other_numbers_become_doubles(dtype: Any) -> None:
    A = abs(incidence(4)).astype(dtype)
    space = sparse_null_space(A)
    assert space.basis.dtype == np.float64
    assert abs(A.astype(float) @ space.basis).max() < 1e-14


def test_the_matrix_is_not_changed() -> None:
    A = sparse.coo_array(([1.0, 2.0, 3.0], ([0, 0, 0], [1, 1, 0])), shape=(1, 3)).tocsr()
    A = sparse.csr_array(([1.0, 2.0, 3.0], [1, 1, 0], [0, 3]), shape=(1, 3))
    space = sparse_null_space(A, [0, 2])
    assert A.nnz == 3 and A.data.tolist() == [1.0, 2.0, 3.0]
    assert space.basis.toarray()[1].tolist() == [-1.0, 0.0]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_entries_must_be_finite(bad: float) -> None:
    A = chain(1).tolil()
    A[2, 3] = bad
    with pytest.raises(InputError, match=r"A\[2, 3\] must be finite"):
        sparse_null_space(A.tocsr())


def test_integers_must_be_doubles() -> None:
    with pytest.raises(InputError, match="above 2\\^53"):
        sparse_null_space(sparse.csr_array(np.array([[2**60, 1]])))


@pytest.mark.parametrize("A", [np.eye(2, 3), [[1, 2]], None, sparse.csr_array((3, 0))])
def test_other_things_are_refused(A: Any) -> None:
    with pytest.raises(InputError, match=r"^A "):
        sparse_null_space(A)


def test_full_column_rank_is_refused() -> None:
    tall = random_sparse(60, 30, 8)
    for options in ({}, {"prefer": [1]}, {"independent": [1]}):
        with pytest.raises(InputError, match="only 0 is in the null space: A has rank 30"):
            sparse_null_space(tall, **options)


@pytest.mark.parametrize("option", [{"form": "reducd"}, {"method": "svd"}])
def test_unknown_options(option: Any) -> None:
    with pytest.raises(UnknownName, match="there is no"):
        sparse_null_space(chain(1), **option)


@pytest.mark.parametrize("tolerance", [0, 1, -1e-9, np.nan])
def test_tolerance_is_relative(tolerance: float) -> None:
    with pytest.raises(InputError, match="tolerance is relative"):
        sparse_null_space(chain(1), tolerance=tolerance)


def test_dense_forms_are_refused_where_they_are_too_large() -> None:
    A = sparse.eye_array(3000, 9000, format="csr")
    with pytest.raises(InputError, match=r'9000 x 6000 .*take the form "reduced"'):
        sparse_null_space(A, form="orthonormal")
    with pytest.raises(UnknownName):
        sparse_null_space(A).in_form("dense")


def test_only_small_bases_can_be_read() -> None:
    small = sparse_null_space(sparse.csr_array(np.array([[1.0, 2e-9, -4.0]])))
    assert small.to_sympy().shape == (3, 2)
    assert "2 \\cdot 10^{-9}" in small.latex() or "\\\\" in small.latex()
    for read in (sparse_null_space(chain(10)).to_sympy, sparse_null_space(chain(10)).latex):
        with pytest.raises(InputError, match="90 x 10 is too large"):
            read()
