"""The loops of robots and linkages, written out once more in NumPy."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from nullbody import catalog
from tests.catalog.robot import NAMES, model, states

X, Y, Z = np.eye(3)
Q = Mapping[str, float]


def turn(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' formula."""
    K = np.cross(axis, np.eye(3)).T
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def pose(q: Q) -> tuple[np.ndarray, np.ndarray]:
    """p and R of a platform with roll-pitch-yaw angles."""
    R = turn(Z, q["phi"]) @ turn(Y, q["theta"]) @ turn(X, q["psi"])
    return np.array([q["x"], q["y"], q["z"]]), R


def flat(angle: float) -> np.ndarray:
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def three_prs(q: Q, p: Q, *, upright: bool = False) -> list[np.ndarray]:
    (centre, R), rows = pose(q), []
    for i, degrees in enumerate((0, 120, -120), 1):
        e, alpha, s = turn(Y, np.radians(degrees)) @ Z, q[f"alpha{i}"], q[f"s{i}"]
        start = p["a"] * e + s * Y if upright else (p["a"] - s) * e
        rows.append(start + p["l"] * (np.sin(alpha) * Y - np.cos(alpha) * e) - centre - R @ (p["b"] * e))
    return rows


def three_prs_vertical(q: Q, p: Q) -> list[np.ndarray]:
    return three_prs(q, p, upright=True)


def three_rps(q: Q, p: Q) -> list[np.ndarray]:
    (centre, R), rows = pose(q), []
    for i, degrees in enumerate((0, 120, -120), 1):
        e, alpha, s = turn(Z, np.radians(degrees)) @ X, q[f"alpha{i}"], q[f"s{i}"]
        rows.append(p["a"] * e + s * (np.sin(alpha) * Z - np.cos(alpha) * e) - centre - R @ (p["b"] * e))
    return rows


def stewart_platform(q: Q, p: Q) -> list[np.ndarray]:
    (centre, R), rows = pose(q), []
    for i in range(1, 7):
        middle = np.radians(120 * ((i - 1) // 2))
        side = (-1) ** i
        neighbour = middle + side * np.pi / 3  # the middle of the platform's pair that leg i goes to
        A = p["a"] * turn(Z, middle + side * p["ga"]) @ X
        B = p["b"] * turn(Z, neighbour - side * p["gb"]) @ X
        direction = turn(Z, middle) @ turn(X, q[f"alpha{i}"]) @ turn(Y, q[f"beta{i}"]) @ Z
        rows.append(A + q[f"s{i}"] * direction - centre - R @ B)
    return rows


def delta(q: Q, p: Q) -> list[np.ndarray]:
    (centre, R), rows = pose(q), []
    for i, degrees in enumerate((0, 120, -120), 1):
        about = turn(Z, np.radians(degrees))
        arm = about @ turn(Y, q[f"alpha{i}"])
        forearm = arm @ turn(Y, q[f"beta{i}"]) @ turn(X, q[f"gamma{i}"])
        wrist = about @ X * p["a"] + arm @ X * p["la"] - forearm @ Z * p["lf"]
        rows.append(wrist - centre - R @ about @ X * p["b"])
        rows.append(np.array([(forearm @ X) @ (R @ about @ Y)]))
    return rows


def five_bar(q: Q, p: Q) -> list[np.ndarray]:
    tool = np.array([q["x"], q["y"], 0.0])
    first = p["a1"] * flat(q["theta1"]) + p["b1"] * flat(q["theta1"] + q["gamma"])
    second = p["d"] * X + p["a2"] * flat(q["theta2"])
    return [(first - tool)[:2], (second - tool + p["b2"] * flat(q["phi"]))[:2]]


def three_rrr(q: Q, p: Q) -> list[np.ndarray]:
    centre, rows = np.array([q["x"], q["y"], 0.0]), []
    for i, degrees in enumerate((-150, -30, 90), 1):
        e, theta = flat(np.radians(degrees)), q[f"theta{i}"]
        tip = p["a"] * e + p["l1"] * flat(theta) + p["l2"] * flat(theta + q[f"gamma{i}"])
        rows.append((tip - centre - turn(Z, q["phi"]) @ (p["b"] * e))[:2])
    return rows


def four_bar(q: Q, p: Q) -> list[np.ndarray]:
    pin = p["crank"] * flat(q["theta1"]) + p["coupler"] * flat(q["theta1"] + q["theta2"])
    return [(pin - p["base"] * X - p["rocker"] * flat(q["theta3"]))[:2]]


def slider_crank(q: Q, p: Q) -> list[np.ndarray]:
    pin = p["r"] * flat(q["theta"]) + p["l"] * flat(q["theta"] + q["beta"])
    return [(pin - np.array([q["s"], p["e"], 0.0]))[:2]]


def spatial_slider_crank(q: Q, p: Q) -> list[np.ndarray]:
    pin = np.array([0, p["ya"], p["za"]]) + p["r"] * turn(X, q["theta"]) @ Z
    return [q["s"] * X + p["l"] * turn(X, q["alpha"]) @ turn(Y, q["beta"]) @ Z - pin]


def rssr(q: Q, p: Q) -> list[np.ndarray]:
    coupler = turn(Z, q["theta"] + q["alpha"]) @ turn(Y, q["beta"]) @ X
    rocker = p["c"] * flat(q["psi"]) + p["f"] * Z
    return [p["a"] * flat(q["theta"]) + p["b"] * coupler - p["d"] * X - turn(X, p["w"]) @ rocker]


@pytest.mark.parametrize("name", NAMES)
def test_closures_as_written_out(name: str) -> None:
    """At coordinates that close nothing."""
    found, draw = model(name), np.random.default_rng(2)
    for state in states(name)[:4]:
        q = state.q + draw.normal(scale=0.3, size=len(state.q))
        by_name = dict(zip(found.coordinates, q.tolist(), strict=True))
        expected = np.concatenate(globals()[name](by_name, found.parameters))
        np.testing.assert_allclose(found.residual(q), expected, rtol=0, atol=4e-15)


OTHERS = {
    "three_prs": {"a": 1.1, "b": 0.3, "l": 0.9},
    "three_prs_vertical": {"a": 0.2, "b": 0.4, "l": 0.5},
    "three_rps": {"a": 0.2, "b": 0.2},
    "stewart_platform": {"a": 0.3, "b": 0.4, "ga": 0.4, "gb": 0.1},
    "delta": {"a": 0.1, "b": 0.12, "la": 0.5, "lf": 0.3},
    "five_bar": {"a1": 0.3, "a2": 0.2, "b1": 0.25, "b2": 0.45, "d": 0.1},
    "three_rrr": {"a": 0.5, "b": 0.2, "l1": 0.15, "l2": 0.3},
    "four_bar": {"crank": 3.0, "coupler": 2.0, "rocker": 4.0, "base": 1.5},
    "slider_crank": {"r": 0.4, "l": 0.3, "e": 0.1},
    "spatial_slider_crank": {"r": 0.2, "l": 0.31, "ya": -0.2},
    "rssr": {"a": 0.3, "b": 0.2, "d": 0.2, "f": 0.0, "w": 0.3},
}


@pytest.mark.parametrize("name", NAMES)
def test_home_closes_the_loops_for_other_lengths_too(name: str) -> None:
    for values in ({}, OTHERS[name]):
        mechanism = catalog.mechanism(name, **values)
        numbers = mechanism.values()
        gaps = np.concatenate(globals()[name](mechanism.home_values(numbers), numbers))
        np.testing.assert_allclose(gaps, 0, atol=2e-15 * max(1.0, *numbers.values()))


@pytest.mark.parametrize("name", NAMES)
def test_every_length_and_mass_is_a_parameter(name: str) -> None:
    """No number stands in a place or a mass; bodies are physical for the default values."""
    mechanism = catalog.mechanism(name)
    for body in mechanism.bodies:
        assert isinstance(body.mass, str)
        assert not any(isinstance(entry, float) for entry in (*body.centre, *body.inertia))
    for joint in (*mechanism.joints, *mechanism.loops):
        positions = (*joint.at.position, *joint.on.position)
        assert all(isinstance(entry, str) or entry == 0 for entry in positions)
    assert all(parameter.unit and parameter.meaning for parameter in mechanism.parameters)
    assert mechanism.end_effector in {body.name for body in mechanism.bodies}
