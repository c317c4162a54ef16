"""Solutions of A gamma + c = 0."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from scipy import sparse

from nullbody.errors import InputError
from nullbody.nullspace.sparse import sparse_null_space
from tests.nullspace.sparse.matrices import chain, sparse_matrices, svd_basis


@settings(max_examples=30)
@given(sparse_matrices())
def test_offset_solves_all_rows(A: Any) -> None:
    if not svd_basis(A).shape[1]:
        return
    space = sparse_null_space(A)
    c = A @ np.random.default_rng(0).standard_normal(A.shape[1])
    gamma = space.offset(c)
    assert not gamma[list(space.independent)].any()
    assert abs(A @ gamma + c).max() <= 1e-12 * max(1, abs(gamma).max())


def test_offset_of_rows_of_any_size() -> None:
    A = chain(2)
    scale = 10.0 ** np.random.default_rng(0).integers(-150, 150, 16)
    c = np.random.default_rng(1).standard_normal(16)
    space = sparse_null_space(A)
    scaled = sparse_null_space(sparse.dia_array((scale[None], [0]), shape=(16, 16)) @ A, space.independent)
    assert np.allclose(scaled.offset(scale * c), space.offset(c), rtol=1e-12)


def test_a_row_that_c_does_not_repeat_is_named() -> None:
    A = chain(1)
    twice = sparse.vstack([A, 2 * A[[3]]], format="csr")
    space = sparse_null_space(twice)
    c = np.random.default_rng(2).standard_normal(9)
    c[8] = 2 * c[3]
    assert abs(twice @ space.offset(c) + c).max() < 1e-13
    c[8] += 1e-6
    with pytest.raises(InputError, match=r"A gamma \+ c = 0 has no solution: row [38] of A repeats others"):
        space.offset(c)


@pytest.mark.parametrize("c", [np.zeros(7), np.zeros((8, 1)), np.full(8, np.nan), ["a"] * 8])
def test_offset_needs_a_number_for_each_row(c: Any) -> None:
    with pytest.raises(InputError, match="c must hold 8 finite numbers"):
        sparse_null_space(chain(1)).offset(c)


def test_velocities_must_fit() -> None:
    with pytest.raises(InputError, match="v must hold 3 numbers"):
        sparse_null_space(chain(3)).move([1.0, 2.0])
