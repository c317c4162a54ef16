"""Simulated motion against the 200-bit reference, and what every motion must keep."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

from nullbody import Model, State, Trajectory, assemble, build, derive, simulate
from tests.mechanisms import four_bar, slider_crank, two_bodies
from tests.robot import fitted, reference, robot, tilted

CLOSED = 1e-13


@cache
def motion() -> Any:
    return reference("free_motion")["scenarios"]["S1_hanging_swing_zero_force"]


@cache
def hanging() -> tuple[Model, State]:
    model = fitted(motion()["params"])
    return model, model.state(motion()["q"][0], motion()["qd"][0][9:])


@cache
def swing(rtol: float) -> Trajectory:
    return simulate(*hanging(), 2.0, rtol=rtol)


def gaps(model: Model, q: np.ndarray) -> float:
    return max(float(np.abs(model.residual(row.copy())).max(initial=0.0)) for row in q)


def worst(rtol: float) -> float:
    return float(np.abs(swing(rtol).sample(motion()["t"]).q - motion()["q"]).max())


def test_free_motion_by_dense_output() -> None:
    found = swing(1e-12).sample(motion()["t"])
    assert np.abs(found.q - motion()["q"]).max() < 1e-10
    assert np.abs(found.v - np.array(motion()["qd"])[:, 9:]).max() < 1e-9


def test_free_motion_by_stored_samples() -> None:
    found = simulate(*hanging(), 2.0, rtol=1e-12, samples=motion()["t"])
    np.testing.assert_array_equal(found.t, motion()["t"])
    assert np.abs(found.q - motion()["q"]).max() < 1e-10
    assert np.abs(found.kinetic - motion()["kinetic"]).max() < 1e-11
    assert np.abs(found.potential - motion()["potential"]).max() < 1e-11
    rows = zip(found.q, found.v, motion()["qdd"], strict=True)
    for q, v, q_ddot in rows:
        found_ddot = found.model.forward_dynamics(found.model.state(q, v))
        np.testing.assert_allclose(found_ddot, q_ddot, atol=1e-8)


def test_error_follows_the_tolerance() -> None:
    errors = [worst(rtol) for rtol in (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)]
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    assert ratios.min() > 8  # a hundredth of the tolerance
    assert errors[0] / errors[-1] > 1e5


def test_energy_drift_follows_the_tolerance() -> None:
    drifts = [swing(rtol).statistics.energy_drift for rtol in (1e-6, 1e-8, 1e-10)]
    assert drifts[0] > 10 * drifts[1] > 100 * drifts[2]
    assert swing(1e-12).statistics.energy_drift < 1e-11


@pytest.mark.parametrize("rtol", [1e-4, 1e-8, 1e-12])
def test_loops_stay_closed(rtol: float) -> None:
    model, found = hanging()[0], swing(rtol)
    assert gaps(model, found.q) <= CLOSED
    assert gaps(model, found.sample(np.linspace(0, 2, 401)).q) <= CLOSED
    assert found.statistics.residual <= CLOSED


def test_dense_output_passes_through_the_steps() -> None:
    found = swing(1e-10)
    dense = found.sample(found.t)
    np.testing.assert_allclose(dense.q, found.q, atol=1e-12)
    np.testing.assert_allclose(dense.v, found.v, atol=1e-12)
    middle = (found.t[1:] + found.t[:-1]) / 2
    np.testing.assert_allclose(found.sample(middle).q, swing(1e-12).sample(middle).q, atol=1e-8)


def test_dense_rates_are_the_slopes_of_dense_positions() -> None:
    found, h = swing(1e-12), 1e-4
    t = np.linspace(0.1, 1.9, 19)
    slope = (found.sample(t + h).q - found.sample(t - h).q) / (2 * h)
    for k, row in enumerate(found.sample(t).q):
        state = found.model.state(row, found.sample(t).v[k])
        np.testing.assert_allclose(found.model.velocity(state), slope[k], rtol=1e-4, atol=1e-4)


def test_time_reversal_returns_to_the_start() -> None:
    model, start = hanging()
    end = swing(1e-12).state(2.0)
    back = simulate(model, model.state(end.q, -end.v), 2.0, rtol=1e-12).state(2.0)
    np.testing.assert_allclose(back.q, start.q, atol=1e-9)
    np.testing.assert_allclose(-back.v, start.v, atol=1e-8)


def test_start_time_only_shifts_the_clock() -> None:
    model, start = hanging()
    late = simulate(model, start, 5.5, t0=5.0, u=lambda t, x: [np.sin(t - 5), 0, 0], samples=11)
    early = simulate(model, start, 0.5, u=lambda t, x: [np.sin(t), 0, 0], samples=11)
    np.testing.assert_allclose(late.t - 5, early.t, atol=1e-15)
    np.testing.assert_allclose(late.q, early.q, atol=1e-9)


@pytest.mark.parametrize(
    "u", [(0.5, -0.3, 0.2), lambda t, x: [np.sin(5 * t), x.v[1] * -0.3, 0.2]], ids=["constant", "u(t, x)"]
)
def test_work_of_the_inputs_is_the_change_of_energy(u: Callable | tuple) -> None:
    found = simulate(*hanging(), 1.0, u=u, rtol=1e-11)
    total = found.kinetic + found.potential
    np.testing.assert_allclose(total - total[0], found.work, atol=1e-10)
    assert np.abs(found.work).max() > 1e-3
    assert found.statistics.energy_drift == pytest.approx(np.abs(total - total[0] - found.work).max(), abs=1e-12)


def test_work_is_the_integral_of_power() -> None:
    found = simulate(*hanging(), 1.0, u=(0.5, -0.3, 0.2), samples=2001, rtol=1e-11)
    power = (found.u * found.v).sum(axis=1)
    integral = np.sum((power[1:] + power[:-1]) / 2 * np.diff(found.t))
    assert found.work[-1] == pytest.approx(integral, abs=1e-6)
    assert found.work[-1] == pytest.approx([0.5, -0.3, 0.2] @ (found.q[-1, 9:] - found.q[0, 9:]), abs=1e-10)


def test_projection_keeps_loops_closed_at_loose_tolerance() -> None:
    found = swing(1e-4)
    assert found.statistics.projections > 0
    assert found.statistics.steps == len(found) - 1
    assert found.statistics.evaluations > 10 * found.statistics.steps


@pytest.mark.parametrize(
    ("make", "known", "rate"), [(four_bar, "q1", 8.0), (slider_crank, "alpha", 9.0)], ids=["four_bar", "slider_crank"]
)
def test_full_turns_of_other_mechanisms(make: Any, known: str, rate: float) -> None:
    model = build(derive(make(), (known,)))
    begin = model.mechanism.home_values(model.parameters)[known]
    found = simulate(model, assemble(model, {known: begin}, v=[rate]), 2.0, rtol=1e-11)
    assert found.outcome.ok
    assert abs(found[known][-1] - found[known][0]) > 4 * np.pi
    assert found.statistics.energy_drift < 1e-8
    assert gaps(model, found.q) <= CLOSED


def test_mechanism_without_loops() -> None:
    model = build(derive(two_bodies()))
    start = assemble(model, {"swing": 0.4}, v=0.3 * np.ones(8))
    found = simulate(model, start, 1.0, rtol=1e-11)
    assert found.statistics.energy_drift < 1e-9
    assert found.statistics.projections == 0
    half = simulate(model, found.state(0.5), 1.0, t0=0.5, rtol=1e-11)
    np.testing.assert_allclose(half.q[-1], found.q[-1], atol=1e-9)


def test_symmetric_motion_stays_symmetric() -> None:
    model = robot().replace(m=0.2)
    guess = {"y": -0.4} | dict.fromkeys(("alpha1", "alpha2", "alpha3"), -1.0)
    found = simulate(model, assemble(model, {"s1": 0.4, "s2": 0.4, "s3": 0.4}, guess=guess), 0.5)
    np.testing.assert_allclose(found["s2"], found["s1"], atol=1e-9)
    np.testing.assert_allclose(found["psi"], 0, atol=1e-9)


def test_start_with_velocity_of_the_platform() -> None:
    model, (x,) = robot(), tilted(robot(), 1)
    found = simulate(model, x, 1e-3)
    np.testing.assert_allclose((found.q[-1] - x.q) / 1e-3, model.velocity(x), atol=0.1)
