"""States: what is accepted, what is refused, and that nobody can change one."""

from __future__ import annotations

import dataclasses
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from nullbody import InputError, StateError, UnknownName
from tests.robot import robot, tilted, upright

HOME_Q = [0, 0.5, 0, 0, 0, 0, np.pi / 2, np.pi / 2, np.pi / 2, 0.6, 0.6, 0.6]


def test_arrays_and_names_give_the_same_state() -> None:
    model, (x,) = robot(), tilted(robot(), 1)
    by_name = model.state(x.positions, x.rates)
    np.testing.assert_array_equal(by_name.q, x.q)
    np.testing.assert_array_equal(by_name.v, x.v)
    assert by_name["alpha2"] == x.q[7]
    assert dict(by_name.rates) == dict(zip(model.independent, x.v.tolist(), strict=True))


def test_without_rates_it_rests() -> None:
    assert not robot().state(HOME_Q).v.any()


@pytest.mark.parametrize("kind", [tuple, list, np.array, lambda q: np.array(q, dtype=object)])
def test_sequences_of_numbers(kind: Any) -> None:
    model = robot().replace(a=1.0, b=0.5, l=0.5)
    q = [0, 0.5, 0, 0, 0, 0, np.pi / 2, np.pi / 2, np.pi / 2, 0.5, 0.5, 0.5]
    state = model.state(kind(q), (1, Fraction(1, 2), np.int64(2)))
    assert state.v.tolist() == [1.0, 0.5, 2.0]
    assert state.q.dtype == np.float64


@pytest.mark.parametrize(
    ("q", "message"),
    [
        (HOME_Q[:-1], r"12 coordinate values are needed \(x, y, .*\), not an array of shape \(11,\)"),
        ([HOME_Q], r"not an array of shape \(1, 12\)"),
        (0.5, "12 coordinate values are needed"),
        ([*HOME_Q[:-1], np.nan], "coordinate s3 must be finite, not nan"),
        ([np.inf, *HOME_Q[1:]], "coordinate x must be finite, not inf"),
        ([str(value) for value in HOME_Q], "must be real numbers"),
        ([Fraction(1), "0.5", *HOME_Q[2:]], "must be real numbers"),
        (np.array(HOME_Q) + 0j, "must be real numbers"),
        (None, "12 coordinate values are needed|real numbers"),
        ("home", "must be real numbers"),
        ([[1], [2, 3]], "must be real numbers"),
    ],
)
def test_wrong_coordinates(q: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        robot().state(q)


def test_wrong_names() -> None:
    home = dict(upright(robot()).positions)
    with pytest.raises(UnknownName, match="no coordinate 'alpha_1'; did you mean 'alpha1'") as caught:
        robot().state({**home, "alpha_1": 0.0})
    assert caught.value.suggestion == "alpha1"
    with pytest.raises(InputError, match="coordinate values are missing: y, s2"):
        robot().state({name: value for name, value in home.items() if name not in ("y", "s2")})
    with pytest.raises(UnknownName, match="no independent rate 'alpha1'"):
        robot().state(home, {"s1": 0, "s2": 0, "s3": 0, "alpha1": 1})


@pytest.mark.parametrize("v", [(1, 2), (1, 2, np.nan), ("1", "2", "3"), {"s1": 1.0}, 1.0])
def test_wrong_rates(v: Any) -> None:
    with pytest.raises(InputError, match="independent rate"):
        robot().state(HOME_Q, v)


def test_open_loop_is_named_with_its_gap() -> None:
    q = list(HOME_Q)
    q[1] += 0.003
    with pytest.raises(StateError, match=r"loop 'leg1' is open by 0\.003 m along y: .*nullbody\.assemble"):
        robot().state(q)


@pytest.mark.parametrize(("gap", "accepted"), [(0.9e-9, True), (1.1e-9, False)])
def test_a_nanometre_is_the_limit(gap: float, accepted: bool) -> None:
    q = list(HOME_Q)
    q[1] += gap
    if accepted:
        robot().state(q)
    else:
        with pytest.raises(StateError):
            robot().state(q)


@pytest.mark.parametrize(("place", "value"), [(11, 1e300), (6, 1e300), (6, 1e22), (0, -1e308)])
def test_absurd_numbers_are_off_the_manifold(place: int, value: float) -> None:
    q = list(HOME_Q)
    q[place] = value
    with pytest.raises(StateError, match="is open by"):
        robot().state(q)


def test_angles_of_many_turns() -> None:
    model = robot()
    q = np.array(HOME_Q)
    q[6] += 2 * np.pi * 159_155  # a million radians; the last bit of such an angle is 1e-10 rad
    state = model.state(q, (0.2, -0.3, -0.2))
    wanted = model.forward_dynamics(upright(model, (0.2, -0.3, -0.2)), (1, 2, 3))
    np.testing.assert_allclose(model.forward_dynamics(state, (1, 2, 3)), wanted, atol=1e-7)


def test_nobody_can_change_a_state() -> None:
    given = np.array(HOME_Q)
    state = robot().state(given)
    given[0] = 7.0
    assert state["x"] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        state.q[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        state.v[0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        state.q = given  # type: ignore[misc]
    with pytest.raises(TypeError):
        state.positions["x"] = 1.0  # type: ignore[index]


def test_unknown_coordinate_of_a_state() -> None:
    with pytest.raises(UnknownName, match=r"did you mean 'alpha[123]'"):
        upright(robot())["alpha"]


def test_it_shows_itself() -> None:
    assert repr(upright(robot(), (0.5, 0, 0))).startswith("<State x=0, y=0.5, ")
    assert "s1'=0.5" in repr(upright(robot(), (0.5, 0, 0)))
