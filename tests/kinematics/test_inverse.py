"""Inverse kinematics of the robot in closed form, and of other mechanisms by assembling."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from nullbody import (
    AssemblyError,
    InputError,
    SingularityError,
    UnknownName,
    assemble,
    build,
    derive,
    inverse_kinematics,
)
from tests.mechanisms import four_bar
from tests.robot import SLIDES, robot, upright

tilt = st.floats(-0.5, 0.5)


@settings(max_examples=60)
@given(height=st.floats(0.15, 0.38), psi=tilt, phi=tilt)
def test_forward_kinematics_returns_the_pose(height: float, psi: float, phi: float) -> None:
    model = robot()
    x = inverse_kinematics(model, {"y": height, "psi": psi, "phi": phi})
    assert np.abs(model.residual(x.q)).max() <= 1e-14
    assert (x["y"], x["psi"], x["phi"]) == (height, psi, phi)
    assume(np.linalg.cond(model.jacobian(x.q)[:, :9]) < 1e4)
    back = assemble(model, {name: x[name] for name in SLIDES}, guess=x)
    np.testing.assert_allclose(back.q, x.q, atol=1e-12)


def test_legs_stay_in_their_planes() -> None:
    for psi, phi in ((0.2, 0.3), (-0.4, 0.1), (0.0, 0.5)):
        x = inverse_kinematics(robot(), {"y": 0.35, "psi": psi, "phi": phi})
        tied = np.sin(x["theta"]) * (1 + np.cos(phi) * np.cos(psi))
        assert tied == pytest.approx(-np.sin(phi) * np.sin(psi), abs=1e-15)


def test_vertical_links() -> None:
    model = robot()
    x = inverse_kinematics(model, {"y": 0.5, "psi": 0.0, "phi": 0.0})
    np.testing.assert_allclose(x.q, upright(model).q, atol=1e-15)


def test_one_vertical_link() -> None:
    model = robot()
    height = 0.5 + 0.2 * np.sin(
        0.1
    )  # psi lowers joint 1 of the platform by b sin(psi), raises the others by half of it
    x = inverse_kinematics(model, {"y": height - 0.3 * np.sin(0.1), "psi": 0.1, "phi": 0.0})
    assert np.abs(model.residual(x.q)).max() <= 1e-14
    assert max(abs(np.sin(x[name])) for name in ("alpha1", "alpha2", "alpha3")) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("excess", [1e-13, 1e-6, 0.05])
def test_too_high_by(excess: float) -> None:
    with pytest.raises(AssemblyError) as caught:
        inverse_kinematics(robot(), {"y": 0.5 + excess, "psi": 0.0, "phi": 0.0})
    assert caught.value.loop in ("leg1", "leg2", "leg3")
    assert caught.value.gap == pytest.approx(excess, rel=1e-2)


def test_message_out_of_reach() -> None:
    message = r"joint B1 of the platform would be 0\.55 m from the plane.*link 1 reaches 0\.5 m.*Lower the platform"
    with pytest.raises(AssemblyError, match=message):
        inverse_kinematics(robot(), {"y": 0.55, "psi": 0.0, "phi": 0.0})


@settings(max_examples=60)
@given(height=st.floats(0.2, 0.4), psi=st.floats(0.05, 0.9), phi=st.floats(-0.9, -0.05))
def test_theta_in_place_of_another_angle(height: float, psi: float, phi: float) -> None:
    model = robot()
    try:
        x = inverse_kinematics(model, {"y": height, "psi": psi, "phi": phi})
    except AssemblyError:
        assume(False)
    for other in ("psi", "phi"):
        found = inverse_kinematics(model, {"y": height, "theta": x["theta"], other: x[other]}, guess=x)
        np.testing.assert_allclose(found.q, x.q, atol=1e-9)


def test_second_tilt_out_of_reach_does_not_hide_the_first() -> None:
    model = robot()
    x = inverse_kinematics(model, {"y": 0.391089, "psi": -0.460427, "phi": -0.918053})
    found = inverse_kinematics(model, {"y": 0.391089, "theta": x["theta"], "phi": x["phi"]})
    assert found["psi"] == pytest.approx(x["psi"], abs=1e-12)


def test_poses_that_determine_nothing() -> None:
    model = robot()
    with pytest.raises(SingularityError, match="theta = 0 and psi = 0 leave the third angle free"):
        inverse_kinematics(model, {"y": 0.45, "theta": 0.0, "psi": 0.0})
    with pytest.raises(SingularityError, match="upside down"):
        inverse_kinematics(model, {"y": 0.2, "psi": np.pi, "phi": 0.0})


@settings(max_examples=60)
@given(
    first=st.floats(-3, 3),
    second=st.floats(-3, 3),
    names=st.sampled_from([("psi", "phi"), ("theta", "psi"), ("theta", "phi")]),
)
def test_every_tilt_exists_on_short_arms(first: float, second: float, names: tuple[str, str]) -> None:
    model, (one, two) = robot().replace(b=0.01), names
    try:
        x = inverse_kinematics(model, {"y": 0.2, one: first, two: second})
    except SingularityError:
        assume(False)
    assert (x[one], x[two]) == (first, second)
    assert np.abs(model.residual(x.q)).max() <= 1e-14


def test_guess_chooses_the_branch() -> None:
    model, pose = robot(), {"y": 0.4, "psi": 0.1, "phi": 0.05}
    inward, outward = inverse_kinematics(model, pose), inverse_kinematics(model, pose, guess={"alpha1": 2.4})
    assert inward["alpha1"] + outward["alpha1"] == pytest.approx(np.pi, abs=1e-12)
    assert inward["alpha2"] == pytest.approx(outward["alpha2"], abs=1e-14)


def test_wrong_poses() -> None:
    model = robot()
    with pytest.raises(
        InputError, match="a pose of 'three_prs' is 3 of its coordinates, usually of the end effector, not 2"
    ):
        inverse_kinematics(model, {"y": 0.4, "psi": 0.1})
    with pytest.raises(UnknownName, match="did you mean 'psi'"):
        inverse_kinematics(model, {"y": 0.4, "psi ": 0.1, "phi": 0.0})
    with pytest.raises(InputError, match="coordinate y must be finite"):
        inverse_kinematics(model, {"y": np.inf, "psi": 0.1, "phi": 0.0})


def test_position_of_the_platform_is_assembled() -> None:
    model = robot()
    x = inverse_kinematics(model, {"y": 0.4, "psi": 0.2, "phi": 0.15})
    found = inverse_kinematics(model, {"x": x["x"], "y": x["y"], "z": x["z"]}, guess=x)
    np.testing.assert_allclose(found.q, x.q, atol=1e-9)


def test_without_closed_form() -> None:
    model = build(derive(four_bar(), ("q1",)))
    x = inverse_kinematics(model, {"q3": 1.8})
    assert x["q3"] == 1.8
    assert np.abs(model.residual(x.q)).max() <= 1e-14
