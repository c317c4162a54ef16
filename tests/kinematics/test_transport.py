"""Rates and accelerations from any coordinates, against differences of assembled positions."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import InputError, SingularityError, UnknownName, assemble
from nullbody.kinematics import accelerations, velocities, with_rates
from tests.robot import SLIDES, robot, tilted, upright

STEP = 1e-3


def differences(s: np.ndarray, rate: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """q' and q'' of assembled positions along s + t s' + t^2 s''/2, by differences of sixth order."""
    model, guess = robot(), assemble(robot(), dict(zip(SLIDES, s, strict=True)))
    t = STEP * np.arange(-3, 4)
    path = [dict(zip(SLIDES, s + k * rate + k * k / 2 * second, strict=True)) for k in t]
    q = np.array([assemble(model, known, guess=guess).q for known in path])
    first = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
    twice = np.array([2, -27, 270, -490, 270, -27, 2]) / 180
    return first @ q / STEP, twice @ q / STEP**2


@pytest.mark.parametrize("seed", range(4))
def test_against_differences_of_positions(seed: int) -> None:
    draw, model = np.random.default_rng(seed), robot()
    s = draw.uniform(0.5, 0.7, 3)
    rate, second = draw.normal(scale=0.3, size=(2, 3))
    q_dot, q_ddot = differences(s, rate, second)
    state = assemble(model, dict(zip(SLIDES, s, strict=True)), v=rate)
    np.testing.assert_allclose(model.velocity(state), q_dot, atol=1e-10)
    np.testing.assert_allclose(velocities(model, state, dict(zip(SLIDES, rate, strict=True))), q_dot, atol=1e-10)
    np.testing.assert_allclose(model.acceleration(state, second), q_ddot, atol=1e-7)
    np.testing.assert_allclose(accelerations(model, state, dict(zip(SLIDES, second, strict=True))), q_ddot, atol=1e-7)


@pytest.mark.parametrize("known", [("y", "psi", "phi"), ("x", "y", "psi"), ("alpha1", "s2", "psi")])
def test_rates_of_any_coordinates_determine_the_same_motion(known: tuple[str, ...]) -> None:
    model, (x,) = robot(), tilted(robot(), 1, seed=7)
    q_dot, q_ddot = model.velocity(x), model.acceleration(x, (0.3, -0.2, 0.5))
    place = [model.coordinates.index(name) for name in known]
    np.testing.assert_allclose(velocities(model, x, dict(zip(known, q_dot[place], strict=True))), q_dot, atol=1e-10)
    np.testing.assert_allclose(velocities(model, x.q, dict(zip(known, q_dot[place], strict=True))), q_dot, atol=1e-10)
    found = accelerations(model, x, dict(zip(known, q_ddot[place], strict=True)))
    np.testing.assert_allclose(found, q_ddot, atol=1e-9)
    turned = with_rates(model, x, dict(zip(known, q_dot[place], strict=True)))
    np.testing.assert_allclose(turned.v, x.v, atol=1e-11)


def test_rates_that_are_tied_determine_nothing() -> None:
    model, (x,) = robot(), tilted(robot(), 1, seed=7)
    assert x["x"] == pytest.approx(0.2 * np.sin(x["theta"]), abs=1e-15)
    with pytest.raises(SingularityError, match="the rates of x, y, theta do not determine the others"):
        velocities(model, x, {"x": 0.1, "y": 0.0, "theta": 0.1})


def test_they_satisfy_the_closures() -> None:
    model = robot()
    for x in tilted(model, 5, seed=8):
        assert np.abs(model.jacobian(x.q) @ model.velocity(x)).max() < 1e-13
        gamma = model.null_space(x).gamma
        assert np.abs(model.jacobian(x.q) @ (model.acceleration(x, (1, 2, 3)) - gamma)).max() < 1e-12


def test_rates_of_the_platform_at_vertical_links() -> None:
    model = robot()
    with pytest.raises(SingularityError, match="the rates of y, psi, phi do not determine the others here"):
        velocities(model, upright(model), {"y": 0.1, "psi": 0.0, "phi": 0.0})
    with pytest.raises(SingularityError, match="the accelerations of y, psi, phi"):
        accelerations(model, upright(model), {"y": 0.1, "psi": 0.0, "phi": 0.0})


def test_wrong_rates() -> None:
    model = robot()
    with pytest.raises(InputError, match="give the rates of 3 coordinates, not of 1"):
        velocities(model, upright(model), {"s1": 0.1})
    with pytest.raises(InputError, match="give the accelerations of 3 coordinates, not of 4"):
        accelerations(model, upright(model), {"s1": 0.1, "s2": 0.1, "s3": 0.1, "y": 0.0})
    with pytest.raises(UnknownName, match="did you mean 's1'"):
        with_rates(model, upright(model), {"s1'": 0.1, "s2": 0.1, "s3": 0.1})
