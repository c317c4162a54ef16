"""Independent columns that are given or preferred, and advice where they cannot be."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from nullbody.errors import InputError, SingularityError
from nullbody.nullspace.numeric.angle import subspace_angle
from nullbody.nullspace.sparse import sparse_null_space
from tests.nullspace.sparse.matrices import chain, dense, random_sparse, sparse_matrices, svd_basis

REGULAR = 1e-9


def greedy(Z: Any, order: list[int]) -> list[int]:
    """The columns of A that become independent one after the other: their rows of Z are."""
    taken: list[int] = []
    for j in order:
        if np.linalg.matrix_rank(Z[[*taken, j]], tol=REGULAR) > len(taken):
            taken.append(j)
    return taken


@settings(max_examples=40)
@given(sparse_matrices(), st.randoms(use_true_random=False))
def test_preferred_columns_come_first(A: Any, random: Any) -> None:
    Z = svd_basis(A)
    if not Z.shape[1]:
        return
    order = random.sample(range(A.shape[1]), random.randint(0, A.shape[1]))
    space = sparse_null_space(A, prefer=order)
    assert set(greedy(Z, order)) <= set(space.independent)
    assert subspace_angle(dense(space), Z) < max(1e-13, 10 * space.subspace_error)


@settings(max_examples=40)
@given(sparse_matrices(), st.randoms(use_true_random=False))
def test_given_columns_are_taken_or_refused(A: Any, random: Any) -> None:
    Z = svd_basis(A)
    n, d = Z.shape
    if not d:
        return
    chosen = random.sample(range(n), d)
    if np.linalg.matrix_rank(Z[chosen], tol=REGULAR) == d:
        space = sparse_null_space(A, chosen)
        assert space.independent == tuple(chosen)
        assert np.array_equal(dense(space)[chosen], np.eye(d))
        assert subspace_angle(dense(space), Z) < max(1e-13, 10 * space.subspace_error)
        return
    with pytest.raises(SingularityError, match="cannot be the independent ones") as error:
        sparse_null_space(A, chosen)
    if advice := re.search(r"columns \[([\d, ]*)\] would do", str(error.value)):
        would_do = [int(j) for j in advice[1].split(", ")]
        assert sparse_null_space(A, would_do).condition < 1e8


def test_advice_for_many_columns_names_those_to_exchange() -> None:
    A = chain(60)
    good = sparse_null_space(A).independent
    fixed = sparse.vstack([A, sparse.csr_array(([1.0], ([0], [good[0]])), shape=(1, A.shape[1]))], format="csr")
    with pytest.raises(InputError, match=r"rank 481: choose 59 independent columns, not 60"):
        sparse_null_space(fixed, good)
    other = next(j for j in range(540) if j not in good)
    with pytest.raises(SingularityError, match=r"in the places of \[\d+\] they would do") as error:
        sparse_null_space(fixed, [good[0], *(j for j in good[1:] if j != other)][:59])
    enter, leave = (
        int(j) for j in re.search(r"with columns \[(\d+)\] in the places of \[(\d+)\]", str(error.value)).groups()
    )
    assert leave == good[0]
    assert sparse_null_space(fixed, [enter if j == leave else j for j in good[:59]]).condition < 1e8


def test_order_of_the_columns_is_kept() -> None:
    A = chain(3)
    space = sparse_null_space(A)
    swapped = sparse_null_space(A, space.independent[::-1])
    assert np.allclose(dense(swapped), dense(space)[:, ::-1], atol=1e-14)
    v = np.array([1.0, 2.0, 3.0])
    assert np.allclose(swapped.move(v), swapped.basis @ v)
    assert np.allclose(swapped.move(np.outer(v, [1, 1j])), np.outer(swapped.basis @ v, [1, 1j]))


@pytest.mark.parametrize("columns", [[0, 0], [0, 99], [-1, 2], [0.5, 1], "ab", 3, [True, 2]])
def test_columns_must_be_columns(columns: Any) -> None:
    A = random_sparse(8, 10, 3)
    for kind in ("independent", "prefer"):
        with pytest.raises(InputError, match="columns must be"):
            sparse_null_space(A, **{kind: columns})


def test_number_of_columns_must_fit_the_rank() -> None:
    with pytest.raises(InputError, match="27 columns and rank 24: choose 3 independent columns, not 2"):
        sparse_null_space(chain(3), [1, 2])


def test_a_choice_and_a_preference_exclude_each_other() -> None:
    with pytest.raises(InputError, match="not both"):
        sparse_null_space(chain(1), [2], prefer=[2])
