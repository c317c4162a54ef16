"""The evidence of the paper, and where it errs: theory section 4 and its errata, number by number."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from nullbody import simulate
from nullbody.control import DesiredMotion, FeedForward, desired_motion, paper_reference
from tests.oracles.multipliers import Multipliers, forward, inverse
from tests.robot import reference, robot, tilted

FORCES = {
    0.5: (-0.7344, 1.1380, 0.7231),
    1.0: (-1.3561, 2.4473, 1.2304),
    1.5: (-1.6299, 3.5653, 1.3558),
    2.0: (-1.4791, 2.8463, 1.3002),
    2.5: (-0.9298, 1.4840, 0.9013),
    3.0: (-0.2114, 0.3162, 0.2114),
}


@cache
def desired() -> DesiredMotion:
    return desired_motion(robot(), paper_reference(), 3.0)


@cache
def course() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """q, q' and F at 601 times of the paper's motion."""
    times = np.linspace(0, 3, 601)
    states = [desired().state(float(t)) for t in times]
    F = [desired().inputs(float(t)) for t in times]
    return np.array([x.q for x in states]), np.array([robot().velocity(x) for x in states]), np.array(F)


@pytest.mark.parametrize("t", FORCES)
def test_forces_on_the_trajectory(t: float) -> None:
    np.testing.assert_allclose(desired().inputs(t), FORCES[t], atol=5.1e-5)


def test_course_of_the_platform() -> None:
    q, q_dot, _ = course()
    y, psi, theta, phi = q[:, 1], q[:, 3], q[:, 4], q[:, 5]
    assert (y[0], y[300]) == pytest.approx((0.5, 0.4375), abs=5e-5)
    assert y[-1] == pytest.approx(0.4989, abs=5e-5)
    assert y.min() == pytest.approx(0.4371, abs=5e-5)
    assert (psi.min(), theta.min(), phi.min()) == pytest.approx((-0.106, -0.0098, -0.184), abs=5e-4)
    assert max(psi.max(), theta.max(), phi.max()) < 1e-15
    assert np.linalg.norm(q_dot[:, :3], axis=1).max() == pytest.approx(0.0625, abs=5e-5)


def test_extreme_forces() -> None:
    F = course()[2]
    assert F[:, 0].min() == pytest.approx(-1.634, abs=5e-4)
    assert F[:, 1].max() == pytest.approx(3.591, abs=5e-4)
    assert F[:, 2].max() == pytest.approx(1.356, abs=5e-4)
    assert F.min() > -2
    assert F.max() < 4


def test_residual_along_the_trajectory() -> None:
    assert max(np.abs(robot().residual(row.copy())).max() for row in course()[0]) < 1e-15


def test_start() -> None:
    model, x = robot(), desired().state(0.0)
    A = model.jacobian(x.q)
    assert np.linalg.cond(A[:, :9]) == pytest.approx(7.2, abs=0.05)
    q_dot, q_ddot = model.velocity(x), model.acceleration(x, np.zeros(3))
    np.testing.assert_allclose(q_dot[:9], [0] * 6 + [0.4, -0.6, -0.4], atol=1e-15)
    np.testing.assert_allclose(q_ddot[[1, 3, 5]], [-0.34 / 3, -1 / 6, -np.sqrt(3) / 6], rtol=1e-14)
    singular = A[:, [j for j in range(12) if j not in (1, 3, 4)]]
    assert np.linalg.svd(singular, compute_uv=False)[-1] < 1e-15


@pytest.mark.parametrize(("t", "least", "most"), [(0.5, 30, 60), (1.0, 1e4, 4e4), (1.75, 5e7, 2e9)])
def test_growth_of_a_perturbation_in_open_loop(t: float, least: float, most: float) -> None:
    model, start, push = robot(), desired().state(0.0), 1e-11
    ends = []
    for sign in (1, -1):
        pushed = model.state(start.q, start.v + sign * push * np.array([1.0, 0, 0]))
        found = simulate(model, pushed, t, u=FeedForward(desired()), rtol=1e-13, throw=False)
        ends.append(found.q[-1, 9:])
    assert least < np.abs(ends[0] - ends[1]).max() / (2 * push) < most


def test_hanging_below_the_slides_is_stable() -> None:
    model = robot()
    hanging = (
        {"y": -0.5} | dict.fromkeys(("alpha1", "alpha2", "alpha3"), -np.pi / 2) | dict.fromkeys(("s1", "s2", "s3"), 0.6)
    )
    rest = {name: hanging.get(name, 0.0) for name in model.coordinates}
    for v in ((0.01, 0, 0), (0.01, -0.02, 0.01)):
        found = simulate(model, model.state(rest, v), 3.0, rtol=1e-9)
        assert np.abs(found["y"] + 0.5).max() < 1e-3
        assert np.abs(found.v).max() < 0.1


def literal_gamma() -> tuple[np.ndarray, np.ndarray]:
    """w and v'' at t = 0.8 s with gamma = -A^+ A' N v' in place of [-B^-1 c; 0]."""
    model, x, F = robot(), desired().state(0.8), desired().inputs(0.8)
    M, h, A, c = Multipliers(model.parameters).terms(x.q, model.velocity(x))
    N, gamma = model.null_space(x).N, -np.linalg.pinv(A) @ c
    w = np.linalg.solve(N.T @ M @ N, N.T @ (np.concatenate([np.zeros(9), F]) - h - M @ gamma))
    return w, N @ w + gamma


def test_equation_41_taken_literally_is_wrong() -> None:
    w, _ = literal_gamma()
    np.testing.assert_allclose(w, (-0.1463, 0.1184, 0.1464), atol=5.1e-5)
    np.testing.assert_allclose(paper_reference()(0.8).acceleration, (-0.1435, 0.2152, 0.1435), atol=5.1e-5)


def test_pseudo_inverse_in_full_coordinates_is_right() -> None:
    x, F = desired().state(0.8), desired().inputs(0.8)
    np.testing.assert_allclose(literal_gamma()[1], robot().forward_dynamics(x, F), atol=1e-10)


def test_rod_about_its_end_counts_it_twice() -> None:
    right, wrong = Multipliers(robot().parameters), Multipliers(robot().parameters, rod=1 / 3)
    motion = reference("inverse_dynamics")
    states = [
        (np.array(q), np.array(d), np.array(dd[9:]))
        for q, d, dd in zip(*(motion[k] for k in ("q", "qd", "qdd")), strict=True)
    ]
    off = [inverse(wrong.terms(q, d), a)[0] - inverse(right.terms(q, d), a)[0] for q, d, a in states]
    assert np.abs(off).max() / 3.59 == pytest.approx(0.0045, rel=0.1)
    changes = []
    for case in reference("random_states")["states"][:10]:
        q, q_dot = np.array(case["q"]), np.array(case["qd"])
        (a, _), (b, _) = (forward(oracle.terms(q, q_dot), np.array(case["F"])) for oracle in (right, wrong))
        changes.append(np.linalg.norm(b - a) / np.linalg.norm(a))
    assert 0.3 < np.median(changes) < 0.45


def test_gravity_pulls_down() -> None:
    model = robot()
    (x,) = tilted(model, 1)
    centres = x["y"] + 0.1 * 0.25 * sum(np.sin(x[f"alpha{i}"]) for i in (1, 2, 3))
    assert robot().replace(g=0.0).energy(x).potential == 0.0
    assert model.energy(x).potential == pytest.approx(9.8 * centres, rel=1e-13)


def test_links_and_slides_are_coupled() -> None:
    model, (x,) = robot(), tilted(robot(), 1)
    M = Multipliers(model.parameters).terms(x.q, model.velocity(x)).M
    for i in range(3):
        assert M[6 + i, 9 + i] == pytest.approx(-0.1 * 0.25 * np.sin(x.q[6 + i]), rel=1e-13)
