"""The parts: independent pivots, the dense end, solving with factors."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import sparse

from nullbody.nullspace.sparse.core import dense_pivots
from nullbody.nullspace.sparse.elimination import eliminated
from nullbody.nullspace.sparse.greedy import greedy_pivots
from nullbody.nullspace.sparse.pivot import independent_pivots
from tests.nullspace.sparse.matrices import chain, random_sparse


def _pivots(A: Any, allowed: Any = None) -> Any:
    columns = np.ones(A.shape[1], bool) if allowed is None else allowed
    return independent_pivots(A, abs(A).max(axis=1).toarray(), columns, np.random.default_rng(0))


@pytest.mark.parametrize("A", [chain(20), random_sparse(200, 300, 3), random_sparse(50, 50, 6)])
def test_pivots_do_not_disturb_each_other(A: Any) -> None:
    places = _pivots(A)
    i, j = A.tocoo().row[places], A.indices[places]
    block = A.toarray()[np.ix_(i, j)]
    assert len(places) > 1 and np.array_equal(block, np.diag(np.diagonal(block)))
    full = abs(A.toarray())
    assert (full[i, j] >= 0.5 * full[i].max(axis=1)).all() and (full[i, j] >= 0.1 * full[:, j].max(axis=0)).all()


def test_pivots_stay_in_the_allowed_columns() -> None:
    A = random_sparse(60, 90, 4)
    allowed = np.arange(90) % 3 == 0
    assert (A.indices[_pivots(A, allowed)] % 3 == 0).all()
    assert not len(_pivots(A, np.zeros(90, bool)))


def test_a_triangular_chain_takes_few_steps() -> None:
    """One pivot after the other would take 4000 steps."""
    n = 4000
    A = sparse.diags_array([np.ones(n), -np.ones(n)], offsets=[0, 1], shape=(n, n + 1), format="csr")
    assert len(eliminated(A, 1e-10).factors.steps) < 60


@pytest.mark.parametrize("A", [chain(20), random_sparse(150, 200, 4)])
def test_factors_solve_with_the_matrix_and_its_transpose(A: Any) -> None:
    factors = eliminated(A, 1e-12).factors
    assert factors.steps and len(factors.core.rows)
    rng = np.random.default_rng(0)
    b, f, v = (rng.standard_normal((k, 2)) for k in (*A.shape, len(factors.independent)))
    x = factors.solve(b)
    assert np.allclose((A @ x)[factors.rows], b[factors.rows]) and not x[factors.independent].any()
    y, image = factors.transposed(f)
    assert np.allclose((A.T @ y)[factors.dependent], f[factors.dependent])
    assert np.allclose(v.T @ image, factors.move(v).T @ f)


@pytest.mark.parametrize("shape", [(30, 50), (50, 30), (40, 40)])
@pytest.mark.parametrize("rank", [0, 1, 17, 30])
def test_dense_end_shows_the_rank(shape: tuple[int, int], rank: int) -> None:
    rng = np.random.default_rng(rank)
    A = rng.standard_normal((shape[0], rank)) @ rng.standard_normal((rank, shape[1]))
    rows, columns, complete = dense_pivots(A, np.ones(shape[0]), np.ones(shape[1], bool), 1e-10)
    assert complete and len(rows) == len(columns) == rank
    assert rank == 0 or np.linalg.cond(A[np.ix_(rows, columns)]) < 1e5


@pytest.mark.parametrize("wide", [False, True])
def test_dense_end_does_not_magnify_rounding(wide: bool) -> None:
    """Of a, a + 1e-6 z and z the first and the last make a good part; seen from the first two, z would be new."""
    a, z = np.random.default_rng(0).uniform(0.5, 1, (2, 40))
    A = np.stack([a, a + 1e-6 * z, z], axis=1)
    A = A.T if wide else A
    rows, columns, complete = dense_pivots(A, np.ones(A.shape[0]), np.ones(A.shape[1], bool), 1e-12)
    assert complete and sorted(rows if wide else columns) in ([0, 2], [1, 2])


def test_dense_end_says_where_allowed_columns_are_too_few() -> None:
    A = np.random.default_rng(0).standard_normal((5, 8))
    allowed = np.arange(8) < 3
    rows, columns, complete = dense_pivots(A, np.ones(5), allowed, 1e-12)
    assert not complete and len(rows) == 3 and sorted(columns) == [0, 1, 2]


@pytest.mark.parametrize("p", [3, 48, 130])
def test_greedy_pivots_keep_the_first_rows(p: int) -> None:
    rng = np.random.default_rng(0)
    A = rng.standard_normal((p, 200))
    twice = np.repeat(A, 2, axis=0)
    rows, columns = greedy_pivots(twice, 1e-8)
    assert rows.tolist() == list(range(0, 2 * p, 2))
    assert len(set(columns.tolist())) == p and np.linalg.cond(twice[np.ix_(rows, columns)]) < 1e6
