"""Identities that every mechanism must satisfy, whatever its independent coordinates are."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import State, assemble, simulate
from nullbody.mechanism import Wrench
from tests.contracts.subject import SUBJECTS, Subject, subject

EXACT = 1e-11


@pytest.fixture(params=SUBJECTS, scope="module")
def given(request: pytest.FixtureRequest) -> Subject:
    return subject(request.param)


def inputs(given: Subject) -> np.ndarray:
    return np.random.default_rng(2).normal(size=len(given.model.inputs))


def assert_small(value: np.ndarray, scale: float = 1.0, allowed: float = EXACT) -> None:
    assert np.abs(value).max(initial=0.0) <= allowed * max(1.0, scale)


def test_states_are_admissible_and_differ(given: Subject) -> None:
    for x in given.states:
        assert_small(given.model.residual(x.q), allowed=1e-14)
    assert np.ptp([x.q for x in given.states], axis=0).max() > 1e-2


def test_null_space(given: Subject) -> None:
    for x in given.states:
        N, gamma, delta = given.model.null_space(x)
        assert_small(given.model.jacobian(x.q) @ N, np.abs(N).max())
        np.testing.assert_array_equal(N[given.places], np.eye(len(x.v)))
        assert not gamma[given.places].any()
        assert delta != 0


def test_scaled_null_space(given: Subject) -> None:
    for x in given.states:
        q_dot = given.model.velocity(x)
        N, gamma, delta = given.model.null_space(x)
        np.testing.assert_allclose(given.value("N_scaled", x.q, q_dot), delta * N, atol=EXACT * abs(delta))
        np.testing.assert_allclose(given.value("N", x.q, q_dot), N, rtol=0, atol=EXACT * np.abs(N).max())
        allowed = EXACT * max(1.0, np.abs(gamma).max())
        np.testing.assert_allclose(given.value("gamma", x.q, q_dot), gamma, rtol=0, atol=allowed)


def test_jacobian_is_the_slope_of_the_closures(given: Subject) -> None:
    h = 1e-3
    weights = np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * h)
    for x in given.states[:2]:
        for j, e in enumerate(np.eye(len(x.q))):
            slope = weights @ np.array([given.model.residual(x.q + k * h * e) for k in range(-3, 4)])
            np.testing.assert_allclose(given.model.jacobian(x.q)[:, j], slope, atol=1e-11)


def test_accelerations_keep_the_loops_closed(given: Subject) -> None:
    """Phi(q + h q' + h^2 q''/2) + the same for -h is of order h^4, so A q'' + c = 0 where the sum over h^2 vanishes."""
    for x in given.states:
        q_dot = given.model.velocity(x)
        q_ddot = given.model.acceleration(x, np.arange(1.0, len(x.v) + 1))
        assert_small(given.model.jacobian(x.q) @ q_dot, np.abs(q_dot).max())
        bends = []
        for h in (2e-3, 1e-3):
            both = [given.model.residual(x.q + t * q_dot + t * t / 2 * q_ddot) for t in (h, -h)]
            bends.append((both[0] + both[1]) / h**2)
        assert_small(4 * bends[1] - bends[0], np.abs(q_ddot).max() + np.abs(q_dot).max() ** 4, 1e-8)
        A, c = given.value("A", x.q, q_dot).reshape(-1, len(x.q)), given.value("c", x.q, q_dot)
        assert_small(A @ q_ddot + c, np.abs(q_ddot).max())


def test_mass_matrix_is_symmetric_and_gives_the_energy(given: Subject) -> None:
    for x in given.states:
        q_dot = given.model.velocity(x)
        M = given.value("M", x.q, q_dot)
        np.testing.assert_allclose(M, M.T, rtol=0, atol=1e-15)
        assert np.linalg.eigvalsh(M).min() > -1e-14
        assert q_dot @ M @ q_dot / 2 == pytest.approx(given.model.energy(x).kinetic, rel=1e-11)


def test_reduced_mass_matrix(given: Subject) -> None:
    for x in given.states:
        N = given.model.null_space(x).N
        units = [given.model.generalized_forces(x, e) for e in np.eye(len(x.v))]
        Mr = np.array(units).T - given.model.generalized_forces(x, np.zeros(len(x.v)))[:, None]
        wanted = N.T @ given.value("M", x.q, given.model.velocity(x)) @ N
        np.testing.assert_allclose(Mr, wanted, rtol=0, atol=EXACT * np.abs(wanted).max())
        assert np.linalg.eigvalsh((Mr + Mr.T) / 2).min() > 0


def test_bias_is_lagrange_s(given: Subject) -> None:
    """N^T h = N^T (M' q' - dT/dq + dU/dq), with the slopes by differences; loads without a potential come on top."""
    loads = given.model.mechanism.loads
    if any(isinstance(load, Wrench) or getattr(load, "damping", 0) != 0 for load in loads):
        pytest.skip("a torque or a damper has no potential")
    step = 3e-4
    weights = np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * step)
    x = given.states[0]
    q_dot = given.model.velocity(x)

    def slope(function: object, direction: np.ndarray) -> np.ndarray:
        return np.tensordot(weights, [function(x.q + k * step * direction) for k in range(-3, 4)], 1)  # type: ignore[operator]

    h = slope(lambda q: given.value("M", q, q_dot) @ q_dot, q_dot)
    h -= [slope(lambda q: given.value("T", q, q_dot), e) for e in np.eye(len(x.q))]
    h += [slope(lambda q: given.value("U", q, q_dot), e) for e in np.eye(len(x.q))]
    N = given.model.null_space(x).N
    np.testing.assert_allclose(
        N.T @ given.value("h", x.q, q_dot), N.T @ h, rtol=0, atol=1e-8 * max(1.0, np.abs(h).max())
    )


def test_forward_and_inverse_are_inverses(given: Subject) -> None:
    u, S = inputs(given), given.input_matrix
    for x in given.states:
        v_dot = given.model.forward_dynamics(x, u)[given.places]
        pushed = given.model.null_space(x).N.T @ S @ u
        scale = np.abs(pushed).max() + np.abs(v_dot).max()
        np.testing.assert_allclose(given.model.generalized_forces(x, v_dot), pushed, rtol=0, atol=EXACT * scale)
        if len(u) == len(x.v):
            np.testing.assert_allclose(given.model.inverse_dynamics(x, v_dot), u, rtol=0, atol=1e-9 * max(1.0, scale))


def test_reactions_balance_every_coordinate(given: Subject) -> None:
    u, S = inputs(given), given.input_matrix
    for x in given.states:
        q_dot, q_ddot = given.model.velocity(x), given.model.forward_dynamics(x, u)
        h = given.value("h", x.q, q_dot)
        inertia = given.value("M", x.q, q_dot) @ q_ddot
        left = given.model.rows(x.q)[0].T @ given.model.reactions(x, u)
        np.testing.assert_allclose(left, S @ u - inertia - h, rtol=0, atol=EXACT * (np.abs(inertia).max() + 10))


def moved(given: Subject, x: State, q_ddot: np.ndarray, t: float) -> float:
    """Total energy a short time later, on the manifold."""
    s, v_dot = x.q[given.places], q_ddot[given.places]
    known = dict(zip(given.model.independent, s + t * x.v + t * t / 2 * v_dot, strict=True))
    return given.model.energy(assemble(given.model, known, v=x.v + t * v_dot, guess=x)).total


def test_power_balance(given: Subject) -> None:
    """dE/dt is the power of inputs and loads; along a path of positions that v alone determine."""
    if given.model.freedom > len(given.model.independent):
        pytest.skip("nonholonomic: positions are not determined by the independent coordinates")
    u = inputs(given)
    for x in given.states[:3]:
        q_ddot = given.model.forward_dynamics(x, u)
        slopes = [(moved(given, x, q_ddot, h) - moved(given, x, q_ddot, -h)) / (2 * h) for h in (2e-4, 1e-4)]
        power = float(given.model.evaluate("forward_dynamics", x.q, x.v, u)[-1])
        scale = np.abs(given.model.energy(x)).max() * (1 + np.abs(q_ddot).max())
        assert (4 * slopes[1] - slopes[0]) / 3 == pytest.approx(power, abs=1e-7 * max(1.0, scale))


def test_a_short_simulation_keeps_energy_and_loops(given: Subject) -> None:
    x = given.states[0]
    found = simulate(given.model, x, 0.02, u=inputs(given), rtol=1e-11)
    assert found.outcome.ok
    assert found.statistics.energy_drift < 1e-9 * max(1.0, np.abs(given.model.energy(x)).max())
    assert found.statistics.residual <= 1e-13
