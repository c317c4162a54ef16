from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy

from nullbody.errors import InputError, SingularityError
from nullbody.expr import Graph
from nullbody.nullspace import null_space


@pytest.mark.parametrize(
    ("A", "message"),
    [
        ([[1, 2], [3]], "equal length"),
        ([], "non-empty"),
        ([[]], "non-empty"),
        ([[], []], "non-empty"),
        ([1, 2, 3], r"list of rows.*; for one row write \[\[1, 2, 3\]\]"),
        ([np.ones((2, 3))] * 2, "stack matrices by numpy.stack"),
        ([np.ones((3, 1))] * 2, "stack matrices by numpy.stack"),
        ([[[1, 2], [3, 4]]], "stack matrices by numpy.stack"),
        (5, "list of rows"),
        (None, "list of rows"),
        ([[1.0, float("nan")]], "finite"),
        ([[float("inf"), 1]], "finite"),
        (np.array([[np.nan, 1.0]]), "finite"),
        ([[sympy.nan, sympy.Integer(1)]], "finite"),
        ([[sympy.zoo, sympy.Integer(1)]], "finite"),
        ([[True, 1]], "number or an expression"),
        ([["1", 2]], "number or an expression"),
        ([[None, 2]], "number or an expression"),
        ([[1j, sympy.Symbol("x")]], "complex"),
        (["12", "34"], "text, sets and mappings are no rows"),
    ],
)
def test_bad_matrices(A: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        null_space(A)


@pytest.mark.parametrize(
    ("independent", "message"),
    [
        ([0], "choose 2 independent columns, not 1"),
        ([0, 1, 2], "choose 2 independent columns, not 3"),
        ([0, 0], "distinct"),
        ([0, 3], r"in 0\.\.2"),
        ([-1, 0], r"in 0\.\.2"),
        (["x", 0], r"in 0\.\.2"),
        ([0.5, 1], r"in 0\.\.2"),
    ],
)
def test_bad_columns(independent: list[Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        null_space([[1, 2, 3], [2, 4, 6]], independent)


def test_a_singular_choice_of_floats_says_so() -> None:
    with pytest.raises(SingularityError, match=r"\[0\] would do"):
        null_space([[0.0, 1.0]], [1])


def test_numpy_arrays_of_any_kind_are_welcome() -> None:
    for kind in (np.int64, np.float32, object):
        assert np.array(null_space(np.array([[1, 2, 4]], dtype=kind), [1, 2]).basis, float).tolist() == [
            [-2, -4],
            [1, 0],
            [0, 1],
        ]


def test_its_repr_says_what_it_is() -> None:
    assert repr(null_space([[1, 2, 4]])) == (
        "<NullSpace reduced 3 x 2, rank 1, independent columns [1, 2], by minors, delta = 1>"
    )
    graph = Graph()
    assert "operations" in repr(null_space([[graph.symbol("x"), graph.symbol("y")]]))


def test_floats_choose_columns_by_size() -> None:
    space = null_space([[0.1, 0.7, 1.0], [0.3, 2.1, 3.5]])
    assert 2 not in space.independent
    assert np.abs(np.array([[0.1, 0.7, 1.0], [0.3, 2.1, 3.5]]) @ np.array(space.basis, float)).max() < 1e-15
    repeated = null_space([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0]])
    assert repeated.rank == 1
    assert len(repeated.redundant) == 1
