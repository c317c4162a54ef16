"""Forward and inverse kinematics of robots and linkages: closed forms against the loops and against Newton's method."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import AssemblyError, SingularityError, assemble, branches, catalog, inverse_kinematics
from nullbody.catalog.angle import angles_of, roll_pitch_yaw, roots
from tests.catalog.robot import FORMS, NAMES, form, model, nearest, states, turned

FORWARD = [name for name in FORMS if name not in ("stewart_platform", "three_rrr")]


def task(name: str) -> tuple[str, ...]:
    return catalog.describe(name).task


def gap(name: str, one: dict[str, float]) -> float:
    found = model(name)
    return float(np.abs(found.residual(np.array([one[c] for c in found.coordinates]))).max())


@pytest.mark.parametrize("name", FORWARD)
def test_forward_closes_the_loops_and_finds_every_state(name: str) -> None:
    found = model(name)
    for state in states(name):
        known = {c: state[c] for c in found.mechanism.actuated}
        assemblies = form(name).assemblies(found.parameters, known)
        assert max(gap(name, one) for one in assemblies) < 1e-13
        assert all(np.exp(1j * one[c]) == pytest.approx(np.exp(1j * known[c])) for one in assemblies for c in known)
        assert nearest(name, assemblies, state) < 1e-11


@pytest.mark.parametrize("name", FORMS)
def test_inverse_closes_the_loops_and_finds_every_state(name: str) -> None:
    found = model(name)
    for state in states(name):
        wanted = {c: state[c] for c in task(name)}
        assemblies = form(name).inverse(found.parameters, wanted)
        assert max(gap(name, one) for one in assemblies) < 1e-13
        assert nearest(name, assemblies, state) < 1e-11


@pytest.mark.parametrize("name", NAMES)
def test_inverse_kinematics_gives_the_state_back(name: str) -> None:
    for state in states(name):
        found = inverse_kinematics(model(name), {c: state[c] for c in task(name)}, guess=state)
        assert turned(name, found.q, state.q) < 1e-11


@pytest.mark.parametrize("name", NAMES)
def test_forward_by_newton_agrees_with_the_closed_form(name: str) -> None:
    for state in states(name)[:6]:
        found = assemble(model(name), {c: state[c] for c in model(name).mechanism.actuated}, guess=state)
        assert turned(name, found.q, state.q) < 1e-11


@pytest.mark.parametrize(
    ("name", "count"),
    [("three_prs_vertical", 8), ("three_rps", 8), ("five_bar", 2), ("slider_crank", 2), ("four_bar", 2), ("rssr", 4)],
)
def test_random_starts_find_no_other_assembly(name: str, count: int) -> None:
    home = assemble(model(name), {})
    found = branches(model(name), {c: home[c] for c in model(name).mechanism.actuated})
    assert (len(found), found.complete) == (count, True)


@pytest.mark.parametrize(("name", "known"), [("slider_crank", "s"), ("spatial_slider_crank", "s"), ("rssr", "psi")])
def test_linkages_are_solved_from_the_other_end_too(name: str, known: str) -> None:
    state = states(name)[-1]
    found = branches(model(name), {known: state[known]}, guess=state)
    assert found.complete
    assert turned(name, found[0].q, state.q) < 1e-11


@pytest.mark.parametrize("name", FORMS)
def test_other_coordinates_are_left_to_the_general_method(name: str) -> None:
    values = model(name).parameters
    assert form(name).assemblies(values, {}) is None
    assert form(name).inverse(values, {}) is None


@pytest.mark.parametrize(
    ("name", "pose", "said"),
    [
        ("three_prs_vertical", {"y": 0.5, "psi": 1.2, "phi": 0.0}, "link 1 reaches 0.3 m: loop 'leg1' stays open by"),
        ("delta", {"x": 0.0, "y": 0.0, "z": -0.9}, "the forearm is 0.55 m long: loop 'leg1' stays open by"),
        ("delta", {"x": 0.9, "y": 0.0, "z": -0.4}, "loop 'leg1' stays open by"),
        ("five_bar", {"x": 0.1, "y": 0.6}, "reach from 0.1 to 0.5 m"),
        ("three_rrr", {"x": 0.5, "y": 0.0, "phi": 0.0}, "loop 'leg1' stays open by"),
        ("four_bar", {"theta3": 0.0}, "loop 'pin' stays open by 5 m"),
        ("slider_crank", {"s": 0.46}, "reach from 0.25 to 0.45 m: loop 'wristpin' stays open by 0.01 m"),
        ("spatial_slider_crank", {"s": 0.5}, "the rod is 0.3 m long: loop 'crankpin' stays open by"),
        ("rssr", {"psi": 0.0}, "the coupler is 0.4 m long: loop 'ball' stays open by"),
    ],
)
def test_out_of_reach_names_loop_gap_and_reach(name: str, pose: dict[str, float], said: str) -> None:
    with pytest.raises(AssemblyError, match="out of reach") as caught:
        inverse_kinematics(model(name), pose)
    assert said in str(caught.value)
    assert caught.value.gap > 0
    assert caught.value.loop in {loop.name for loop in model(name).mechanism.loops}


def test_poses_that_are_not_determined() -> None:
    with pytest.raises(SingularityError, match="upside down"):
        form("three_rps").inverse(model("three_rps").parameters, {"z": 0.4, "psi": np.pi, "theta": 0.0})
    straight = catalog.delta(a=0.05, b=0.3, la=0.25).values()  # level arms end above each other in one point
    with pytest.raises(SingularityError, match="in one line"):
        form("delta").assemblies(straight, {"alpha1": 0.0, "alpha2": 0.0, "alpha3": 0.0})


def test_forearms_that_are_too_short_leave_no_assembly() -> None:
    short = catalog.delta(lf=0.1).values()
    assert form("delta").assemblies(short, {"alpha1": 0.0, "alpha2": 0.0, "alpha3": 0.0}) == []


def test_closed_forms_are_for_other_parameters_too() -> None:
    assert catalog.closed_form_of(catalog.delta(la=0.3)) is not None  # though its home has other numbers


def test_one_angle_of_an_equation() -> None:
    for A, B, C in ((0.3, -0.4, 0.2), (0.0, 2.0, -2.0), (1.0, 0.0, 1.0 + 1e-14)):
        for x in roots(A, B, C):
            assert A * np.cos(x) + B * np.sin(x) == pytest.approx(C, abs=1e-7)
    assert roots(0.3, 0.4, 0.6) == roots(0.0, 0.0, 0.0) == []


def test_roll_pitch_yaw_there_and_back() -> None:
    angles = (0.4, -1.2, 2.5)
    assert angles_of(roll_pitch_yaw(*angles)) == pytest.approx(angles, abs=1e-14)
