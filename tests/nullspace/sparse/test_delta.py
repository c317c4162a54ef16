"""|B|, its logarithm, and the scaled form."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from scipy import sparse

from nullbody.errors import InputError
from nullbody.nullspace.sparse import SparseNullSpace, sparse_null_space
from tests.nullspace.sparse.matrices import chain, dense, random_sparse, sparse_matrices, svd_basis


def square(A: Any, space: SparseNullSpace) -> Any:
    return A.toarray()[np.ix_(space.rows, space.dependent)]


@settings(max_examples=30)
@given(sparse_matrices())
def test_determinant_of_the_dependent_part(A: Any) -> None:
    if not svd_basis(A).shape[1]:
        return
    space = sparse_null_space(A)
    sign, logarithm = np.linalg.slogdet(square(A, space))
    assert space.log_delta[0] == pytest.approx(sign, abs=1e-9)
    assert space.log_delta[1] == pytest.approx(logarithm, abs=1e-9)
    assert space.delta == pytest.approx(sign * math.exp(logarithm), rel=1e-9)


def test_scaled_is_delta_times_the_basis() -> None:
    A = random_sparse(6, 9, 3)
    space = sparse_null_space(A, form="scaled")
    assert space.delta == pytest.approx(np.linalg.det(square(A, space)))
    assert np.allclose(space.basis.toarray(), space.delta * dense(space))


@pytest.mark.parametrize(("factor", "delta"), [(1e100, math.inf), (1e-100, 0.0)])
def test_delta_outside_the_range_of_doubles(factor: float, delta: float) -> None:
    A = chain(2) * factor
    space = sparse_null_space(A)
    assert abs(space.delta) == delta
    plain = sparse_null_space(chain(2), space.independent).log_delta
    assert space.log_delta == pytest.approx((plain[0], plain[1] + 16 * math.log(factor)))
    with pytest.raises(InputError, match=r"delta = .* exp\(.*outside the range of doubles"):
        sparse_null_space(A, form="scaled")
    assert np.isfinite(space.basis.data).all()


def test_sign_follows_the_order_of_rows_and_columns() -> None:
    A = sparse.csr_array(np.array([[0.0, 2.0, 0.0, 1.0], [3.0, 0.0, 0.0, 1.0], [0.0, 0.0, 5.0, 1.0]]))
    assert sparse_null_space(A, [3]).delta == pytest.approx(-30)
    assert sparse_null_space(A[[1, 0, 2]], [3]).delta == pytest.approx(30)
