"""Independent columns: given, preferred, or free."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nullbody.errors import InputError, UnknownName
from nullbody.nullspace.numeric import array_null_space
from tests.nullspace.numeric.matrices import METHODS, near_singular, regular_stack


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("prefer", [(0,), (6, 0), (1, 2, 0), (4, 3, 2, 1, 0)])
def test_preferred_columns_stay_independent(method: str, prefer: tuple[int, ...]) -> None:
    A = regular_stack(1, 4, 7, seed=2)[0]
    space: Any = array_null_space(A, method=method, prefer=prefer)
    best: Any = array_null_space(A)
    assert set(prefer[:3]) <= set(space.independent)
    assert space.independent == tuple(sorted(space.independent))
    assert space.condition < 1e3 * best.condition
    np.testing.assert_allclose(A @ space.basis, 0, atol=1e-12)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("distance", "honoured"), [(1e-1, True), (1e-6, False), (0.0, False)])
def test_preference_gives_way_to_condition(method: str, distance: float, honoured: bool) -> None:
    space: Any = array_null_space(near_singular(distance), prefer=(5, 6), method=method)
    assert (space.independent == (5, 6)) == honoured
    assert 5 in space.independent
    assert space.condition < 1e4


@pytest.mark.parametrize("method", [*METHODS, "auto", "compiled"])
@pytest.mark.parametrize("chart", [(6, 0, 3), (0, 3, 6), [np.int64(3), 6, 0]])
def test_the_order_of_given_columns_is_kept(method: str, chart: Any) -> None:
    A = regular_stack(1, 4, 7, seed=2)[0]
    space: Any = array_null_space(A, chart, method=method)
    assert space.independent == tuple(chart)
    assert (space.basis[list(chart)] == np.eye(3)).all()
    assert space.dependent == (1, 2, 4, 5)
    np.testing.assert_allclose(A @ space.basis, 0, atol=1e-12)


def test_a_tiny_column_is_not_taken_for_granted() -> None:
    A = np.array([[1e-9, 1.0, 0], [0, 1.0, 1.0]])
    assert array_null_space(A).independent == (0,)
    assert array_null_space(A, method="qr").independent == (0,)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("chart", "message"),
    [
        ([0], "A has 4 columns and rank 2: choose 2 independent columns, not 1"),
        ([0, 1, 2], "rank 2: choose 2 independent columns, not 3"),
        ([0, 1, 2, 3], "rank 2: choose 2 independent columns, not 4"),
        ([], "rank (2|at most 3): choose (at least 1|2) independent columns, not 0"),
        ([0, 0], "distinct"),
        ([0, 4], r"in 0\.\.3"),
        ([-1, 0], r"in 0\.\.3"),
        (["x", 0], r"in 0\.\.3"),
        ([0.0, 1], r"in 0\.\.3"),
        ([True, 2], r"in 0\.\.3"),
    ],
)
def test_bad_columns(method: str, chart: Any, message: str) -> None:
    A = np.array([[1.0, 2, 3, 0], [2, 4, 6, 0], [0, 1, 1, 5]])
    with pytest.raises(InputError, match=message):
        array_null_space(A, chart, method=method)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"independent": [0], "prefer": [1]}, "not both"),
        ({"prefer": [2]}, "preferred columns"),
        ({"tolerance": 0}, "tolerance"),
        ({"tolerance": 1.5}, "tolerance"),
        ({"tolerance": float("nan")}, "tolerance"),
        ({"tolerance": True}, "tolerance"),
    ],
)
def test_bad_requests(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        array_null_space(np.ones((1, 2)), **options)


@pytest.mark.parametrize("options", [{"form": "reducd"}, {"method": "completely"}])
def test_unknown_names(options: dict[str, Any]) -> None:
    with pytest.raises(UnknownName, match="did you mean"):
        array_null_space(np.ones((1, 2)), **options)


@pytest.mark.parametrize(
    ("A", "message"),
    [
        ([[1.0, float("nan")]], "row 0, column 1 holds nan"),
        ([[[1.0, 2]], [[float("inf"), 1]]], "matrix 1, row 0, column 0 holds inf"),
        ([[1 + 1j, complex("nan")]], "row 0, column 1"),
        (np.array([[1, "2"]], object), "object"),
        ([["1", "2"]], "must hold real or complex numbers"),
        ([[True, False]], "bool"),
        ([[1.0, 2], [3]], "no array of numbers"),
        (np.zeros((2, 0)), "n >= 1"),
        (np.zeros(3), "n >= 1"),
        (np.zeros((1, 1, 1, 2)), "n >= 1"),
        (3.0, "n >= 1"),
        (None, "object"),
    ],
)
def test_bad_arrays(A: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        array_null_space(A)


@pytest.mark.parametrize(
    ("c", "message"),
    [([1.0], "one entry for each"), ([[1.0, 2]], "one entry"), ([1.0, float("nan")], "entry 1 holds nan"), ("ab", "c")],
)
def test_bad_offsets(c: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        array_null_space(np.array([[1.0, 2, 3], [0, 1, 1]])).offset(c)


def test_large_determinant_is_refused_by_minors() -> None:
    with pytest.raises(InputError, match="too large to expand"):
        array_null_space(np.random.default_rng(0).normal(size=(15, 17)), method="minors")
