"""Trajectory: names, samples, states, xarray, and that nobody can change one."""

from __future__ import annotations

import dataclasses
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

import numpy as np
import pytest

from nullbody import InputError, State, Trajectory, UnknownName, assemble, build, derive, simulate
from tests.mechanisms import four_bar, slider_crank
from tests.robot import HOME, robot


@cache
def moved() -> Trajectory:
    return simulate(robot(), assemble(robot(), HOME, v=(0.1, -0.1, 0.0)), 0.1, u=(1, 2, 3), samples=6)


def test_names() -> None:
    found = moved()
    np.testing.assert_array_equal(found["alpha2"], found.q[:, 7])
    np.testing.assert_array_equal(found["s2"], found.q[:, 10])
    np.testing.assert_array_equal(found["s2'"], found.v[:, 1])
    np.testing.assert_array_equal(found["F3"], [3.0] * 6)
    assert len(found) == 6


@pytest.mark.parametrize(
    ("name", "hint"),
    [("s4'", "s[123]'"), ("alpha", "alpha[123]"), ("f1", "s1|F1"), ("alpha4'", "alpha"), (3, "")],
)
def test_unknown_name(name: Any, hint: str) -> None:
    with pytest.raises(UnknownName, match=f"there is no coordinate, rate or input .*{hint}"):
        moved()[name]


def test_sample_at_any_times() -> None:
    found = moved()
    t, q, v = found.sample([0.0, 0.033, 0.1, 0.033])
    assert t.tolist() == [0.0, 0.033, 0.1, 0.033]
    np.testing.assert_array_equal(q[1], q[3])
    np.testing.assert_allclose(q[[0, 2]], found.q[[0, -1]], atol=1e-13)
    np.testing.assert_allclose(v[[0, 2]], found.v[[0, -1]], atol=1e-13)
    assert found.sample(0.05).q.shape == (1, 12)
    assert found.sample([]).q.shape == (0, 12)


def test_samples_come_in_the_order_of_their_times() -> None:
    found = moved()
    t = np.linspace(0.0, 0.1, 57)
    forward, backward = found.sample(t), found.sample(t[::-1])
    np.testing.assert_array_equal(forward.q, backward.q[::-1])
    np.testing.assert_array_equal(forward.v, backward.v[::-1])
    for time, q, v in zip(t[::8], forward.q[::8], forward.v[::8], strict=True):
        state = found.state(float(time))
        np.testing.assert_allclose(state.q, q, atol=1e-14)
        np.testing.assert_allclose(state.v, v, atol=1e-14)


def test_threads_may_sample_one_trajectory() -> None:
    found = simulate(robot(), assemble(robot(), HOME, v=(0.1, -0.1, 0.0)), 0.1, rtol=1e-7)
    t = np.linspace(0.0, 0.1, 400)
    with ThreadPoolExecutor(8) as pool:
        samples = list(pool.map(lambda _: found.sample(t), range(16)))
    for sample in samples:
        np.testing.assert_array_equal(sample.q, samples[0].q)
        np.testing.assert_array_equal(sample.v, samples[0].v)


def test_charts_that_were_used() -> None:
    assert moved().charts == ((0.0, robot().independent),)
    model = build(derive(slider_crank(), ("s",)))
    turning = simulate(model, assemble(model, {"s": 0.35}, v=[1.0]), 1.0)
    assert len(turning.charts) == turning.statistics.switches + 1 > 1
    assert turning.charts[0] == (0.0, ("s",))
    assert turning.charts[1][1] != ("s",)
    assert 0 < turning.charts[1][0] < 1
    assert simulate(model, assemble(model, {"s": 0.35}), 1e-3, throw=False, max_steps=1).charts[0][0] == 0.0


@pytest.mark.parametrize("times", [[-0.01], [0.11], [np.nan], [[0.0, 0.1]], "start", None])
def test_sample_outside(times: Any) -> None:
    with pytest.raises(InputError, match=r"times must be a list within 0\.\.0\.1 s"):
        moved().sample(times)


def test_state_at_any_time_is_a_start() -> None:
    state = moved().state(0.05)
    assert isinstance(state, State)
    again = simulate(robot(), state, 0.1, t0=0.05, u=(1, 2, 3))
    np.testing.assert_allclose(again.q[-1], moved().q[-1], atol=1e-10)


def test_nobody_can_change_a_trajectory() -> None:
    found = moved()
    for array in (found.t, found.q, found.v, found.u, found.kinetic, found.potential, found.work, found["s1"]):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 7.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.q = found.v  # type: ignore[misc]
    steps = simulate(robot(), assemble(robot(), HOME), 0.01)
    with pytest.raises(ValueError, match="read-only"):
        steps.t[0] = 7.0


def test_wanted_times_stay_the_caller_s() -> None:
    times = np.array([0.0, 0.05])
    found = simulate(robot(), assemble(robot(), HOME), 0.05, samples=times)
    times[0] = 9.0
    assert found.t[0] == 0.0


def test_xarray_has_units_and_attributes() -> None:
    data = moved().to_xarray()
    units = {
        name: data[name].attrs["units"] for name in ("t", "y", "psi", "s1", "s1_dot", "F1", "kinetic_energy", "work")
    }
    assert units == {
        "t": "s",
        "y": "m",
        "psi": "rad",
        "s1": "m",
        "s1_dot": "m/s",
        "F1": "N",
        "kinetic_energy": "J",
        "work": "J",
    }
    np.testing.assert_array_equal(data["alpha1"], moved()["alpha1"])
    np.testing.assert_array_equal(data["s2_dot"], moved()["s2'"])
    assert data.attrs["mechanism"] == "three_prs"
    assert data.attrs["outcome"] == "COMPLETED"
    assert data.attrs["parameter_l"] == 0.5
    assert data.attrs["statistics_steps"] == moved().statistics.steps
    assert set(data.dims) == {"t"}


def test_xarray_of_a_torque() -> None:
    model = build(derive(four_bar(), ("q1",)))
    data = simulate(model, assemble(model, {"q1": 1.3}), 0.05, u=[0.1]).to_xarray()
    assert data["torque"].attrs["units"] == "N m"
    assert data["q1_dot"].attrs["units"] == "rad/s"


def test_it_shows_itself() -> None:
    assert repr(moved()).startswith("<Trajectory 0.1 s, ")
    assert repr(moved()).endswith("completed>")
