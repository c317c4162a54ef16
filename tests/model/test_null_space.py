"""N against a pivoted numeric solution, at tilted, symmetric, vertical and nearly singular poses."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nullbody import Model, SingularityError, State, inverse_kinematics
from nullbody.kinematics import with_rates
from tests.robot import SLIDES, robot, tilted, upright

PIVOTED = 1e-13
NEAR_SINGULAR = 1e-15  # times |N|: both roads lose digits as 1/|B|, which passes 1e-13 where |N| exceeds 100
tilts = st.floats(-0.45, 0.45)
few = settings(max_examples=60)
rates = st.tuples(*[st.floats(-2, 2)] * 3)


def assert_null_space(model: Model, state: State) -> None:
    """N = [-B^-1 C; I], A N = 0, gamma = [-B^-1 c; 0] and q' = N v."""
    A = model.jacobian(state.q)
    N, gamma, delta = model.null_space(state)
    wanted = np.vstack([-np.linalg.solve(A[:, :9], A[:, 9:]), np.eye(3)])
    scale = np.abs(wanted).max()
    allowed = max(PIVOTED, NEAR_SINGULAR * scale) * scale
    assert np.abs(N - wanted).max() <= allowed
    assert np.abs(A @ N).max() <= PIVOTED * scale
    assert delta == pytest.approx(np.linalg.det(A[:, :9]), rel=1e-11)
    assert not gamma[9:].any()
    assert np.abs(model.velocity(state) - wanted @ state.v).max() <= allowed * (1 + np.abs(state.v).max())


@few
@given(height=st.floats(0.12, 0.38), psi=tilts, phi=tilts, v=rates)
def test_tilted(height: float, psi: float, phi: float, v: tuple[float, ...]) -> None:
    model = robot()
    pose = inverse_kinematics(model, {"y": height, "psi": psi, "phi": phi})
    assert_null_space(model, with_rates(model, pose, dict(zip(SLIDES, v, strict=True))))


@few
@given(height=st.floats(0.02, 0.4999), v=rates)
def test_symmetric(height: float, v: tuple[float, ...]) -> None:
    model = robot()
    pose = inverse_kinematics(model, {"y": height, "psi": 0.0, "phi": 0.0})
    assert_null_space(model, with_rates(model, pose, dict(zip(SLIDES, v, strict=True))))


@few
@given(a=st.floats(0.3, 2), b=st.floats(0.05, 0.6), length=st.floats(0.1, 2), v=rates)
def test_vertical(a: float, b: float, length: float, v: tuple[float, ...]) -> None:
    model = robot().replace(a=a, b=b, l=length)
    assert_null_space(model, upright(model, v))


def singular_pose() -> np.ndarray:
    """Horizontal links in the plane of the slides: the platform moves up or down, whatever the slides do."""
    q = np.zeros(12)
    q[9:] = 0.8 - 0.2 - 0.5
    return q


def test_horizontal_links_are_a_forward_singularity() -> None:
    model = robot()
    state = model.state(singular_pose(), (0.1, 0.1, 0.1))
    for call in (model.velocity, model.null_space, model.energy, model.forward_dynamics, model.reactions):
        with pytest.raises(SingularityError, match=r"s1, s2, s3 are singular here: \|B\| = .*Derive with other"):
            call(state)
    for call in (model.inverse_dynamics, model.acceleration, model.generalized_forces):
        with pytest.raises(SingularityError, match="singular here"):
            call(state, (0, 0, 0))


@pytest.mark.parametrize("exponent", range(1, 16))
def test_near_the_singularity_numbers_hold_or_an_error_is_raised(exponent: int) -> None:
    model, alpha = robot(), 10.0**-exponent
    q = singular_pose()
    q[1], q[6:9] = 0.5 * np.sin(alpha), alpha
    q[9:] = 0.8 - 0.2 - 0.5 * np.cos(alpha)
    state = model.state(q, (0.1, 0.1, 0.1))
    try:
        y_dot = model.velocity(state)[1]
    except SingularityError:
        assert exponent >= 5
    else:
        assert y_dot == pytest.approx(0.1 * np.cos(alpha) / np.sin(alpha), rel=1e-15 / alpha + 1e-13)


def test_doubt_obeys_hadamard() -> None:
    for state in [upright(robot()), *tilted(robot(), 20)]:
        assert 1 <= robot().evaluate("kinematics", state.q, state.v)[-1] < 1e8


@pytest.mark.parametrize("psi", [0.0, 0.3, -0.7])
def test_gimbal_lock_is_refused(psi: float) -> None:
    model = robot()
    try:
        posed = inverse_kinematics(model, {"y": 0.1, "psi": psi, "theta": np.pi / 2})
    except SingularityError:
        return
    state = model.state(posed.q, (0.1, -0.2, 0.15))
    for call in (model.energy, model.forward_dynamics, model.reactions):
        with pytest.raises(SingularityError, match="singular here"):
            call(state)
