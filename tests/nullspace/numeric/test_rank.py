"""What counts as zero: nearly dependent rows, scaled rows, huge and tiny entries, redundant rows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nullbody.errors import InputError
from nullbody.nullspace.numeric import array_null_space, subspace_angle
from tests.nullspace.numeric.exact import exact_angle, exact_basis
from tests.nullspace.numeric.matrices import METHODS, defective, regular_stack

BY_RANK = ("complete", "qr", "svd")


def nearly_dependent(distance: float) -> Any:
    A = regular_stack(1, 4, 7, seed=3)[0]
    A[2] = 2 * A[0] - A[1] + distance * A[2]
    return A


@pytest.mark.parametrize("method", BY_RANK)
@pytest.mark.parametrize(("distance", "rank"), [(1e-8, 4), (1e-12, 4), (1e-17, 3), (0.0, 3)])
def test_nearly_dependent_rows(method: str, distance: float, rank: int) -> None:
    space: Any = array_null_space(nearly_dependent(distance), method=method)
    assert space.rank == rank
    assert ("rank in doubt" in repr(space)) == (distance == 1e-12)
    assert (space.gap < 1e3) == (distance == 1e-12)


@pytest.mark.parametrize("method", BY_RANK)
def test_nearly_dependent_rows_cost_accuracy_and_it_is_said(method: str) -> None:
    A = nearly_dependent(1e-8)
    space: Any = array_null_space(A, method=method)
    assert 1e-12 < exact_angle(space.basis, exact_basis(A, space.independent)) < space.subspace_error < 1e-6


@pytest.mark.parametrize("method", BY_RANK)
def test_tolerance_of_the_caller_decides(method: str) -> None:
    A = nearly_dependent(1e-8)
    space: Any = array_null_space(A, method=method, tolerance=1e-7)
    assert space.rank == 3
    assert 10 < space.gap < 1e3  # what was dropped is no rounding
    assert "rank in doubt" in repr(space)
    assert array_null_space(A, method=method, tolerance=1e-4).gap > 1e3


def test_float32_rounding_is_no_rank() -> None:
    A = regular_stack(1, 4, 7)[0].astype(np.float32)
    A[3] = A[0] / 3 - A[1] / 7
    assert array_null_space(A).rank == 3
    assert array_null_space(A.astype(float)).rank == 4
    assert "rank in doubt" not in repr(array_null_space(A))


@given(A=defective(), powers=st.lists(st.integers(-150, 150), min_size=12, max_size=12))
def test_scaling_rows_changes_nothing(A: Any, powers: list[int]) -> None:
    first: Any = array_null_space(A)
    scale = 10.0 ** np.array(powers[: len(A)])[:, None]
    for method in METHODS:
        space: Any = array_null_space(A * scale, first.independent, method=method)
        np.testing.assert_allclose(space.basis, first.basis, atol=1e-11 * np.abs(first.basis).max())
        assert space.rank == first.rank
    doubled: Any = array_null_space(A * 2.0 ** np.array(powers[: len(A)])[:, None])
    assert doubled.independent == first.independent
    assert (doubled.basis == first.basis).all()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("factor", [1e-300, 1e-200, 1e200, 1e300])
def test_huge_and_tiny_entries(method: str, factor: float) -> None:
    A = regular_stack(1, 4, 6, seed=5)[0]
    plain: Any = array_null_space(A, (4, 5), "orthonormal", method)
    space: Any = array_null_space(A * factor, (4, 5), "orthonormal", method)
    assert subspace_angle(plain.basis, space.basis) < 1e-13
    assert space.delta == (np.inf if factor > 1 else 0) * np.sign(plain.delta)
    with pytest.raises(InputError, match="leaves the range of float64"):
        _ = space.scaled


@pytest.mark.parametrize("method", METHODS)
def test_huge_and_tiny_entries_in_one_row(method: str) -> None:
    A = np.array([[1e200, 1e-200, 0, 2e200], [0, 1e-200, 3e-200, 1e-200]])
    space: Any = array_null_space(A, (2, 3), method=method)
    np.testing.assert_allclose(space.basis[:2], [[0, -2], [-3, -1]], atol=1e-15)


def test_subnormal_numbers() -> None:
    space: Any = array_null_space(np.array([[5e-324, 1e-323, 0]]), (1, 2))
    assert space.basis.tolist() == [[-2, 0], [1, 0], [0, 1]]


@given(A=defective())
def test_repeats_are_the_combinations(A: Any) -> None:
    scale = 10.0 ** (np.arange(len(A)) % 5 * 40)[:, None]
    space: Any = array_null_space(A * scale)
    assert sorted([*space.rows, *space.redundant]) == list(range(len(A)))
    assert set(space.repeats) == set(space.redundant)
    for i, combination in space.repeats.items():
        total = sum((x * (A[k] * scale[k]) for k, x in combination.items()), np.zeros(A.shape[1]))
        np.testing.assert_allclose(total / scale[i], A[i], atol=1e-12)
        assert set(combination) <= set(space.rows)


def test_coefficients_of_rounding_are_left_out() -> None:
    A = regular_stack(1, 5, 7, seed=8)[0]
    A[4] = 3 * A[1] - A[2] / 3
    A[0] = 0
    space: Any = array_null_space(A)
    assert space.redundant[0] == 0
    assert space.repeats[0] == {}
    (other,) = set(space.redundant) - {0}
    assert set(space.repeats[other]) == {1, 2, 4} - {other}


@given(A=defective(), numbers=st.lists(st.integers(-5, 5), min_size=6, max_size=6))
def test_offset(A: Any, numbers: list[int]) -> None:
    x = np.array(numbers[: A.shape[1]], float)
    for method in METHODS:
        space: Any = array_null_space(A, method=method)
        gamma = space.offset(A @ x)
        np.testing.assert_allclose(A @ gamma, -(A @ x), atol=1e-11)
        assert not gamma[list(space.independent)].any()


def test_inconsistent_offset_names_the_row_and_how_much() -> None:
    A = np.array([[1.0, 2, 3], [0, 1, 1], [1, 3, 4]])
    space: Any = array_null_space(A)
    assert len(space.redundant) == 1
    with pytest.raises(InputError, match=rf"row {space.redundant[0]} of A repeats rows .*1\.0e-06 off") as caught:
        space.offset([1e3, 2e3, 3e3 + 1e-6])
    assert "no solution" in str(caught.value)
    space.offset([1e3, 2e3, 3e3 + 1e-11])
    with pytest.raises(InputError, match="not consistent"):
        array_null_space(np.zeros((1, 2))).offset([1e-300])
