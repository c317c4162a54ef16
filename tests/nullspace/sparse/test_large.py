"""Ten thousand columns, by way of samples: a full comparison would take a dense SVD of that size."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import sparse

from nullbody.nullspace.sparse import sparse_null_space
from tests.nullspace.sparse.matrices import chain, incidence, random_sparse


@pytest.mark.parametrize(
    ("A", "rank"), [(chain(1111), 8888), (random_sparse(7000, 10000, 3), None), (incidence(71), 71 * 71 - 1)]
)
def test_moves_satisfy_the_constraints(A: Any, rank: int | None) -> None:
    space = sparse_null_space(A)
    v = np.random.default_rng(0).standard_normal((space.shape[1], 3))
    moves = space.move(v)
    assert np.array_equal(moves[list(space.independent)], v)
    assert abs(A @ moves).max() < 1e-14 * space.shape[1] ** 0.5 * abs(moves).max()
    assert rank is None or space.rank == rank


def test_large_basis_is_sparse_and_exact() -> None:
    A = chain(300)
    space = sparse_null_space(sparse.vstack([A, A[::7] + A[1::7][: len(range(0, 2400, 7))]], format="csr"))
    assert space.rank == 2400 and len(space.redundant) == 343
    N = space.basis
    residual = abs(A @ N).max(axis=0).toarray() / abs(N).max(axis=0).toarray()
    assert residual.max() < 1e-14
    assert N.nnz < 0.5 * N.shape[0] * N.shape[1]
