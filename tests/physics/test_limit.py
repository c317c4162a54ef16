"""Limits in which the robot is a textbook system."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import assemble, simulate
from tests.robot import HOME, SLIDES, robot, upright


def test_small_oscillation_of_the_hanging_robot() -> None:
    """Legs in step at alpha = -pi/2 + e: y moves with e^2, the massless slides give way: M falls out of the inertia."""
    model = robot().replace(M=1e-9, Ixx=1e-12, Iyy=1e-12, Izz=1e-12, ms=2.0, m=0.3)
    e = 1e-4
    rest = dict.fromkeys(model.coordinates, 0.0) | {"y": -0.5 * np.cos(e)}
    rest |= dict.fromkeys(("alpha1", "alpha2", "alpha3"), -np.pi / 2 + e)
    rest |= dict.fromkeys(SLIDES, 0.8 - 0.2 - 0.5 * np.sin(e))
    found = model.forward_dynamics(model.state(rest))
    # the tip stays on a vertical line, so the slider is off by d = l sin(e) and the rod's centre by d/2
    inertia = 2.0 * 0.5**2 + 0.3 * (0.5**2 / 4 + 0.5**2 / 12)
    assert found[6] == pytest.approx(-0.3 * 9.8 * 0.25 * e / inertia, rel=1e-5)


def test_light_legs_drop_the_platform_freely() -> None:
    """With massless-like links and slides nothing holds the tilted-in platform but the constraint: y'' = -g."""
    model = robot().replace(m=1e-9)
    x = assemble(model, dict.fromkeys(SLIDES, 0.4))
    q_ddot = model.forward_dynamics(x)
    assert q_ddot[1] == pytest.approx(-9.8, rel=1e-6)
    assert np.abs(q_ddot[3:6]).max() < 1e-6


def test_static_forces_hold_the_weight() -> None:
    """Legs at the same elevation: virtual work, 3 F s' = (M + 3 m/2) g y' with y' = s' cot(alpha)."""
    model = robot()
    x = assemble(model, dict.fromkeys(SLIDES, 0.4))
    F = model.inverse_dynamics(x, np.zeros(3))
    lift = np.cos(x["alpha1"]) / np.sin(x["alpha1"])
    np.testing.assert_allclose(F, (1.0 + 0.15) * 9.8 * lift / 3, rtol=1e-12)
    np.testing.assert_allclose(model.forward_dynamics(x, F), 0, atol=1e-12)


def test_vertical_links_carry_the_platform() -> None:
    """At rest upright each leg's joint bears a third of the platform; lambda has the paper's sign."""
    model = robot()
    lam = model.reactions(upright(model)).reshape(3, 3)
    np.testing.assert_allclose(lam[:, 1], 9.8 / 3, rtol=1e-12)
    np.testing.assert_allclose(lam[:, [0, 2]], 0, atol=1e-13)


def test_heavy_sliders_move_alone() -> None:
    model = robot().replace(ms=1e6)
    x = assemble(model, {**HOME, "s1": 0.5})
    np.testing.assert_allclose(model.forward_dynamics(x, (1e6, 2e6, -3e6))[9:], (1, 2, -3), rtol=1e-4)


def test_turned_robot_moves_alike() -> None:
    """Cyclic exchange of the legs turns the platform by 120 degrees about y and changes nothing else."""
    model = robot()
    s, v, F = np.array([0.55, 0.62, 0.6]), np.array([0.2, -0.1, 0.3]), np.array([1.0, 2.0, -1.0])
    runs = []
    for shift in range(3):
        known = dict(zip(SLIDES, np.roll(s, shift), strict=True))
        found = simulate(model, assemble(model, known, v=np.roll(v, shift)), 0.1, u=np.roll(F, shift))
        runs.append((np.roll(found.q[-1, 9:], -shift), found["y"][-1], np.hypot(found["x"], found["z"])[-1]))
    for run in runs[1:]:
        np.testing.assert_allclose(run[0], runs[0][0], atol=1e-10)
        np.testing.assert_allclose(run[1:], runs[0][1:], atol=1e-10)


def test_lengths_and_masses_scale() -> None:
    """Twice the lengths: accelerations of lengths stay, those of angles halve where g rules; masses fall out."""
    small, large = robot(), robot().replace(a=1.6, b=0.4, l=1.0, M=3.0, m=0.3)
    x = assemble(small, {"s1": 0.45, "s2": 0.5, "s3": 0.4})
    y = assemble(large, {"s1": 0.9, "s2": 1.0, "s3": 0.8})
    found, wanted = large.forward_dynamics(y), small.forward_dynamics(x)
    np.testing.assert_allclose(found[[0, 1, 2, 9, 10, 11]], wanted[[0, 1, 2, 9, 10, 11]], rtol=1e-10)
    np.testing.assert_allclose(found[3:9], wanted[3:9] / 2, rtol=1e-10, atol=1e-12)
