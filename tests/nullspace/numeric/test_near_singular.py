"""Charts at a known distance from |B| = 0, against exact arithmetic."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from nullbody.errors import SingularityError
from nullbody.nullspace.numeric import array_null_space
from tests.nullspace.numeric.exact import exact_angle, exact_basis
from tests.nullspace.numeric.matrices import METHODS, near_singular

CHART = (5, 6)
DISTANCES = [10.0**-k for k in range(2, 13, 2)]


@pytest.mark.parametrize("distance", DISTANCES)
@pytest.mark.parametrize("method", ["complete", "qr", "svd", "auto"])
@pytest.mark.parametrize("form", ["reduced", "orthonormal"])
def test_free_columns_keep_their_accuracy(distance: float, method: str, form: Any) -> None:
    A = near_singular(distance)
    space: Any = array_null_space(A, form=form, method=method)
    assert exact_angle(space.basis, exact_basis(A, space.independent)) < 3e-15
    assert space.condition < 10
    assert space.subspace_error < 1e-13


@pytest.mark.parametrize("distance", DISTANCES)
@pytest.mark.parametrize("method", ["qr", "svd", "auto"])
def test_orthonormal_form_does_not_suffer_from_the_chart(distance: float, method: str) -> None:
    A = near_singular(distance)
    space: Any = array_null_space(A, CHART, "orthonormal", method)
    assert exact_angle(space.basis, exact_basis(A, CHART)) < 3e-15
    assert space.subspace_error < 1e-13
    assert space.condition > 0.01 / distance


@pytest.mark.parametrize("distance", DISTANCES)
@pytest.mark.parametrize("method", METHODS)
def test_fixed_chart_loses_what_it_says(distance: float, method: str) -> None:
    A = near_singular(distance)
    space: Any = array_null_space(A, CHART, method=method)
    angle = exact_angle(space.basis, exact_basis(A, CHART))
    assert angle < space.subspace_error < 1e-13 / distance
    assert 0.01 / distance < space.condition < 100 / distance
    if distance < 1e-9:
        assert angle > 1e-14  # the loss is real: an estimate that is never reached would say nothing


@pytest.mark.parametrize("distance", DISTANCES)
def test_residual_stays_small_all_the_same(distance: float) -> None:
    A = near_singular(distance)
    N = array_null_space(A, CHART).basis
    assert np.abs(A @ N).max() < 1e-14 * np.abs(N).max()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("distance", [0.0, 1e-17])
def test_singular_chart_names_columns_that_would_do(method: str, distance: float) -> None:
    A = near_singular(distance)
    with pytest.raises(SingularityError, match=r"columns \[5, 6\] .* columns \[.*\] would do") as caught:
        array_null_space(A, CHART, method=method)
    named = [int(j) for j in re.findall(r"\[([\d, ]+)\] would do", str(caught.value))[0].split(",")]
    assert len(set(named) & set(CHART)) == 1  # as many of the caller's as possible
    space: Any = array_null_space(A, named)
    assert space.condition < 100
    assert float(re.findall(r"\((\S+) of the product", str(caught.value))[0]) < 1e-15


@pytest.mark.parametrize("seed", range(4))
def test_the_size_of_the_determinant_is_relative_to_its_columns(seed: int) -> None:
    A = near_singular(1e-17, seed=seed) * 1e150
    with pytest.raises(SingularityError, match=r"\(\d\.\de-(1[6-9]|2\d) of the product|\(0.0e\+00 of the product"):
        array_null_space(A, CHART)
