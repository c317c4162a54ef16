from __future__ import annotations

from itertools import combinations
from math import inf
from typing import Any

import numpy as np
import pytest
import scipy.sparse
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st

from nullbody.catalog import three_prs
from nullbody.equations import derive
from nullbody.errors import InputError, SingularityError, UnknownName
from nullbody.expr import Graph, cos, sin
from nullbody.expr.transplant import transplant
from nullbody.nullspace import null_space
from nullbody.nullspace.atlas import Atlas
from nullbody.nullspace.charts import charts

A = [[1, 2, 0, 1], [5, 8, 1, 3]]


@pytest.fixture(scope="module")
def atlas(three_prs_jacobian: list[list[Any]]) -> Atlas:
    return charts(three_prs_jacobian)


def small() -> list[list[Any]]:
    """A 2 x 4 matrix with columns 0 and 1 dependent by sin^2 + cos^2 = 1 alone."""
    graph = Graph()
    x, p, q = graph.symbol("x"), graph.symbol("p"), graph.symbol("q")
    return [[cos(x), 1, p, 0], [1 - sin(x) * sin(x), cos(x), q, p * q]]


def test_the_220_charts_of_the_robot_of_which_17_are_singular(atlas: Atlas) -> None:
    coordinates = derive(three_prs()).coordinates
    column = {name: k for k, name in enumerate(coordinates)}
    assert (len(atlas), len(atlas.singular), len(atlas.regular)) == (220, 17, 203)
    assert atlas[column["psi"], column["theta"], column["phi"]].singular
    names = {tuple(coordinates[j] for j in chart.independent) for chart in atlas.singular}
    assert ("x", "psi", "phi") in names
    assert sum({"x", "theta"} <= set(chart) for chart in names) == 10  # x' = b cos(theta) theta'
    assert not atlas[9, 10, 11].singular


def test_costs_of_the_robot_are_those_of_null_space(atlas: Atlas, three_prs_jacobian: list[list[Any]]) -> None:
    cheapest = atlas.best()
    assert cheapest.operations is not None
    assert cheapest.operations.arithmetic <= 115
    for chart in (cheapest, atlas.best("scaled_operations"), atlas[9, 10, 11]):
        moved = iter(transplant([entry for row in three_prs_jacobian for entry in row], Graph()))
        space = null_space([[next(moved) for _ in range(12)] for _ in range(9)], chart.independent)
        assert chart.operations == space.operations
    assert all(chart.operations.arithmetic <= 420 for chart in atlas.regular if chart.operations)


def test_its_repr_and_its_table_fit_a_screen(atlas: Atlas) -> None:
    assert repr(atlas).startswith("<Atlas of 220 charts of 3 columns in 12, 17 identically singular; best conditioned")
    assert len(repr(atlas)) < 200
    lines = atlas.table(4).splitlines()
    assert lines[0].split() == ["independent", "N", "N~", "condition", "subspace", "error"]
    assert len(lines) == 5
    assert lines[1].startswith(str(atlas.best().independent))
    assert repr(atlas[3, 4, 5]) == "<Chart (3, 4, 5): singular>"


def test_what_was_made_before_does_not_change_the_costs() -> None:
    matrix = small()
    before = charts(matrix)
    for chart in before.regular:
        for form in ("reduced", "scaled"):
            space = null_space(matrix, chart.independent, form=form)  # type: ignore[arg-type]
            assert space.basis
    assert charts(matrix).charts == before.charts


def test_singular_by_an_identity_alone() -> None:
    found = charts(small())
    assert [chart.independent for chart in found.singular] == [(2, 3)]
    assert found[2, 3].operations is None
    assert found[2, 3].condition == inf


@settings(max_examples=40, deadline=None)
@given(st.lists(st.lists(st.integers(-2, 2), min_size=5, max_size=5), min_size=1, max_size=4), st.booleans())
def test_regular_charts_are_those_that_null_space_takes(matrix: list[list[int]], repeated: bool) -> None:
    matrix = [*matrix, matrix[0]] if repeated else matrix
    found = charts(matrix)
    size = null_space(matrix).shape[1]
    assert [chart.independent for chart in found] == list(combinations(range(5), size))
    for chart in found:
        if chart.singular:
            with pytest.raises(SingularityError):
                null_space(matrix, chart.independent)
        else:
            assert chart.condition == pytest.approx(null_space(matrix, chart.independent).condition, rel=1e-12)


def test_numbers_expressions_arrays_sparse_and_sympy_agree() -> None:
    graph = Graph()
    kinds = [
        A,
        np.array(A, float),
        scipy.sparse.csr_matrix(np.array(A, float)),
        sympy.Matrix(A),
        [[graph.constant(a) for a in row] for row in A],
    ]
    expected = [chart.condition for chart in charts(A)]
    for matrix in kinds:
        found = charts(matrix)
        assert [chart.condition for chart in found] == pytest.approx(expected, rel=1e-12)
        assert found.best("condition").independent == charts(A).best().independent


def test_numbers_of_any_size() -> None:
    found = charts([[10**400, 2 * 10**400, 3], [0, 1, 1]])
    assert [chart.singular for chart in found] == [False, False, False]
    assert found[2,].condition == pytest.approx(np.sqrt(6), rel=1e-12)  # N = [2, -1, 1] to 400 digits
    assert found.best().independent == (0,)


def test_complex_arrays_and_matrices_without_rows() -> None:
    found = charts(np.array([[1, 1j, 2]]))
    assert [chart.condition for chart in found] == pytest.approx([np.sqrt(1.5), np.sqrt(6), np.sqrt(6)])
    assert [chart.condition for chart in charts(np.zeros((0, 3)))] == [1]
    assert charts([[0, 0]])[0, 1].condition == 1


def test_conditions_at_the_worst_of_some_points() -> None:
    matrix = small()
    points = [{"x": 0.3, "p": 2.0, "q": 0.1}, {"x": 1.2, "p": -0.5}]
    one, two, both = charts(matrix, at=points[0]), charts(matrix, at=points[1]), charts(matrix, at=points)
    for chart in both.regular:
        conditions = [null_space(matrix, chart.independent).condition_at(point) for point in points]
        expected = [one[chart.independent].condition, two[chart.independent].condition]
        assert expected == pytest.approx(conditions, rel=1e-12)
        assert chart.condition == max(expected)
    lost = charts(matrix, at={"p": 0.0, "q": 0.0})  # the rows are parallel there
    assert {chart.condition for chart in lost} == {inf}


def test_candidates_limit_and_progress() -> None:
    seen: list[int] = []
    found = charts(small(), columns=[3, 1, 0], progress=seen.append)
    assert [chart.independent for chart in found] == [(0, 1), (0, 3), (1, 3)]
    assert seen == [1, 2, 3]
    with pytest.raises(InputError, match="about 1e119 choices of 200 of 400 columns"):
        charts(np.eye(200, 400))
    with pytest.raises(InputError, match="6 choices of 2 of 4 columns, more than the limit of 5: restrict"):
        charts(A, limit=5)
    with pytest.raises(InputError, match=r"columns= must hold at least 2, not \[1\]"):
        charts(A, columns=[1])
    with pytest.raises(SingularityError, match="all 1 charts are singular"):
        charts(small(), columns=[2, 3]).best()


@pytest.mark.parametrize(
    ("matrix", "options", "message"),
    [
        (A, {"at": {"x": 1.0}}, "there is no symbol 'x'"),
        (np.array(A, float), {"at": {"x": 1.0}}, "there is no symbol 'x'"),
        (A, {"method": "lu"}, "there is no method 'lu'"),
        (A, {"columns": [0, 4]}, r"candidate columns must be distinct and in 0\.\.3"),
        ([[1, 0], [0, 1]], {}, "full column rank 2"),
        (np.eye(2), {}, "only 0 is in the null space"),
        (np.ones((2, 1, 3)), {}, "one matrix"),
        (np.array([[1.0, np.nan]]), {}, "finite"),
        ([[1, 2], [3]], {}, "equal length"),
    ],
)
def test_bad_requests(matrix: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        charts(matrix, **options)


def test_bad_questions_to_an_atlas() -> None:
    found = charts(A)
    with pytest.raises(InputError, match=r"columns must be distinct and in 0\.\.3, not \[0, 7\]"):
        found[0, 7]
    with pytest.raises(InputError, match="must be distinct"):
        found[0, 0]
    with pytest.raises(InputError, match=r"no chart with the independent columns \[0\]"):
        found[0]
    with pytest.raises(InputError, match="numbers take no operations"):
        found.best("operations")
    with pytest.raises(UnknownName, match="'conditions'; did you mean 'condition'"):
        found.best("conditions")  # type: ignore[arg-type]
    assert found[1, 0] is found[0, 1] is found.charts[0]
