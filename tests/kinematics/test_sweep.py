"""sweep: many assemblies on one branch, and the point at which a path leaves the reach."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import AssemblyError, InputError, UnknownName
from nullbody.kinematics import sweep
from tests.robot import HOME, SLIDES, robot


def test_it_names_the_point_that_is_out_of_reach() -> None:
    path = [HOME, {**HOME, "s1": 0.65}, {**HOME, "s1": 3.0}]
    with pytest.raises(
        AssemblyError, match=r"^point 3 of 3 of the path: the loops cannot be closed for s1 = 3,"
    ) as caught:
        sweep(robot(), path)
    assert caught.value.loop == "leg1"
    assert caught.value.gap > 0.1
    assert 0.0 < caught.value.reach < 1.0


def test_each_point_continues_the_one_before() -> None:
    below = {"y": -0.5, "alpha1": -1.57, "alpha2": -1.57, "alpha3": -1.57}
    states = sweep(robot(), [HOME, {**HOME, "s1": 0.63}, {**HOME, "s1": 0.66}], guess=below)
    assert [x["s1"] for x in states] == [0.6, 0.63, 0.66]
    assert all(x["y"] < 0 and not x.v.any() for x in states)


def test_unnamed_coordinates_stay_where_the_last_point_left_them() -> None:
    first, second = sweep(robot(), [{"s1": 0.55}, {"s2": 0.56}])
    assert first["s1"] == 0.55
    assert second["s1"] == pytest.approx(0.55, abs=0.01)
    assert second["s2"] == 0.56


def test_it_never_changes_the_branch() -> None:
    begin, end = np.array([0.453, 0.285, 0.555]), np.array([0.867, 0.358, 0.197])
    path = [dict(zip(SLIDES, begin + part * (end - begin), strict=True)) for part in np.linspace(0, 1, 100)]
    with pytest.raises(AssemblyError, match=r"^point \d+ of 100 of the path: the branch of the guess ends") as caught:
        sweep(robot(), path)
    number = int(str(caught.value).split()[1])
    states = sweep(robot(), path[: number - 1])
    determinants = [robot().evaluate("kinematics", x.q, x.v)[3] for x in states]
    assert min(determinants) > 0
    assert determinants[-1] == min(determinants)


def test_empty_path() -> None:
    assert sweep(robot(), []) == []


def test_wrong_points() -> None:
    with pytest.raises(UnknownName, match="did you mean 's1'"):
        sweep(robot(), [{"s_1": 0.6}])
    with pytest.raises(InputError, match="by name"):
        sweep(robot(), [(0.6, 0.6, 0.6)])  # type: ignore[list-item]
