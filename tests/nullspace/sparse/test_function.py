"""The basis as a function of the entries."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import sparse

from nullbody.errors import InputError, SingularityError
from nullbody.expr import Tape
from nullbody.nullspace.numeric.angle import subspace_angle
from nullbody.nullspace.sparse import sparse_null_space
from nullbody.nullspace.sparse.factor import Core, Factors
from nullbody.nullspace.sparse.function import SparseFunction
from nullbody.nullspace.sparse.replay import replayed
from tests.nullspace.sparse.matrices import chain, random_sparse, regular_rows, svd_basis


def changed(A: Any, seed: int = 1) -> Any:
    """The same pattern with other numbers."""
    other = A.copy()
    other.data = A.data * np.random.default_rng(seed).uniform(0.7, 1.3, A.nnz)
    return other


@pytest.mark.parametrize("form", ["reduced", "scaled", "orthogonal", "orthonormal"])
def test_function_gives_the_basis_of_other_matrices(form: Any) -> None:
    A = chain(3)
    function = sparse_null_space(A, sparse_null_space(A).independent[::-1], form).to_function()
    other = changed(A)
    expected = sparse_null_space(other, function.independent, form).basis
    for given in (other, other.data):
        difference = function(given) - expected
        assert abs(difference).max() < 1e-12 * abs(expected).max()


def test_small_ones_are_compiled() -> None:
    function = sparse_null_space(chain(3)).to_function()
    assert isinstance(function, SparseFunction) and function.compiled
    assert repr(function) == "<SparseFunction (24 x 27, 88 entries) -> reduced basis, compiled>"


def test_replay_follows_the_exchanges_of_the_dense_end() -> None:
    part = np.array([[0.0, 1.0, 2.0], [3.0, 0.0, 4.0]])
    factors = Factors.of((2, 3), (), Core.of(part, np.arange(2), np.arange(2), np.array([2])))
    names, entries = replayed(np.array([1, 2, 3, 5]), factors, 100) or ([], [])
    values = Tape.of([entry for _, _, entry in entries], names).run([1.0, 2.0, 3.0, 4.0])
    assert {(i, k): value for (i, k, _), value in zip(entries, values, strict=True)} == {(0, 0): -4 / 3, (1, 0): -2.0}
    assert replayed(np.array([1, 2, 3, 5]), factors, 1) is None


@pytest.mark.parametrize("A", [random_sparse(120, 150, 5), chain(2) * 1j])
def test_others_are_eliminated_anew(A: Any) -> None:
    function, other = sparse_null_space(A).to_function(), changed(A)
    assert not function.compiled
    assert subspace_angle(function(other).toarray(), svd_basis(other)) < 1e-10


def test_pivots_that_vanish_are_replaced() -> None:
    A = sparse.csr_array(np.array([[2.0, 1.0, 1.0, 3.0], [1.0, 3.0, 1.0, 1.0], [1.0, 1.0, 4.0, 1.0]]))
    function = sparse_null_space(A, [3]).to_function()
    assert function.compiled
    for zero in range(9):
        data = A.data.copy()
        data[zero] = 0
        matrix = sparse.csr_array((data, A.indices, A.indptr), shape=(3, 4))
        assert abs(matrix @ function(data)).max() < 1e-14


def test_redundant_rows_must_stay_redundant() -> None:
    A = regular_rows(6, 12, 3).toarray()
    A = sparse.csr_array(np.vstack([A, A[0] + A[1]]))
    function = sparse_null_space(A).to_function()
    assert abs(A @ function(A)).max() < 1e-14
    with pytest.raises(InputError, match="rank 7: choose 5"):
        function(changed(A))


def test_singular_columns_are_named() -> None:
    A = sparse.csr_array(np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]))
    function = sparse_null_space(A, [2]).to_function()
    with pytest.raises(SingularityError, match="would do"):
        function(np.array([1.0, 2.0, 3.0, 2.0, 4.0, 1.0]))


def test_entries_must_fit_the_pattern() -> None:
    A = chain(1)
    function = sparse_null_space(A).to_function()
    strange = A.tolil()
    strange[0, 8] = 1.0
    with pytest.raises(InputError, match=r"A\[0, 8\] was not an entry"):
        function(strange.tocsr())
    with pytest.raises(InputError, match="must be 24 numbers"):
        function(A.data[:-1])
    with pytest.raises(InputError, match=r"A\[0, 0\] must be finite"):
        function(np.where(np.arange(24) == 0, np.nan, A.data))
    with pytest.raises(InputError, match="must be 8 x 9"):
        function(chain(2))


def test_stored_zeros_belong_to_the_pattern() -> None:
    A = sparse.csr_array(([1.0, 0.0, 2.0], ([0, 0, 0], [0, 1, 2])), shape=(1, 3))
    function = sparse_null_space(A, [0, 1]).to_function()
    assert function(np.array([1.0, 5.0, 2.0])).toarray()[2].tolist() == [-0.5, -2.5]
