"""IFToMM A05: the stiff governor, by the stiff and by the explicit method."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from nullbody import Trajectory
from nullbody.typing import FloatArray
from tests.benchmarks_published.published import moved, reference


def shaft_inertia(p: Any, alpha: Any) -> Any:
    """The whole governor's moment of inertia about the shaft."""
    along, across = p["m_arm"] * p["w"] ** 2 / 6, p["m_arm"] * (p["l"] ** 2 + p["w"] ** 2) / 12
    arm = p["m_arm"] * (p["d"] + p["l"] / 2 * np.cos(alpha)) ** 2 + p["M"] * (p["d"] + p["l"] * np.cos(alpha)) ** 2
    arm += along * np.sin(alpha) ** 2 + across * np.cos(alpha) ** 2
    return p["m_shaft"] * p["w"] ** 2 / 6 + p["m_slider"] * p["b"] ** 2 / 6 + 2 * arm


def swung(t: FloatArray, p: Any) -> FloatArray:
    """phi, s, alpha: both arms alike, the angular momentum about the shaft constant."""
    across = p["m_arm"] * (p["l"] ** 2 + p["w"] ** 2) / 12
    arms = 2 * (p["m_arm"] * p["l"] ** 2 / 4 + across + p["M"] * p["l"] ** 2)
    momentum = 2 * np.pi * shaft_inertia(p, np.pi / 6)

    def rate(_: float, y: FloatArray) -> list[float]:
        _, s, alpha, s_dot, alpha_dot = y
        wide, high = p["l"] / 2 * np.cos(alpha), p["H"] - p["l"] / 2 * np.sin(alpha) - s
        r = np.hypot(wide, high)
        by_alpha, by_s = -p["l"] / 2 * (wide * np.sin(alpha) + high * np.cos(alpha)) / r, -high / r
        force = 2 * (p["k"] * (r - p["l0"]) + p["c"] * (by_alpha * alpha_dot + by_s * s_dot))
        turn = momentum / shaft_inertia(p, alpha)
        spread = (shaft_inertia(p, alpha + 1e-30j) / 1e-30).imag * turn**2 / 2
        weight = 2 * p["g"] * np.cos(alpha) * (p["m_arm"] * p["l"] / 2 + p["M"] * p["l"])
        return [
            turn,
            s_dot,
            alpha_dot,
            -p["g"] - force * by_s / p["m_slider"],
            (spread + weight - force * by_alpha) / arms,
        ]

    start = [0.0, p["H"] - p["l"] / 2, np.pi / 6, 0.0, 0.0]
    return solve_ivp(rate, (0, t[-1]), start, "Radau", t_eval=t, rtol=1e-11, atol=1e-13).y[:3]


def columns(found: Trajectory) -> dict[str, FloatArray]:
    """In the names of the reference."""
    phi, s, alpha, _ = found.q.T
    return {
        "phi_shaft": phi,
        "s": s,
        "alpha": alpha,
        "omega_shaft": found["phi'"],
        "sdot": found["s'"],
        "alphadot": found["alpha1'"],
        "dissipated": -found.work,
    }


def test_the_published_motion_by_the_stiff_method() -> None:
    wanted = reference("flyball_governor", "turning")
    found = moved("flyball_governor", "turning", wanted["t"], method="stiff", rtol=1e-9)
    for name, values in columns(found).items():
        np.testing.assert_allclose(values, wanted[name], rtol=0, atol=1e-7, err_msg=name)
    np.testing.assert_allclose(found["alpha1"], found["alpha2"], rtol=0, atol=1e-12)


def test_the_first_second_by_the_explicit_method() -> None:
    """Its steps are no longer than the fastest motion of 8000 1/s allows."""
    wanted = reference("flyball_governor", "turning")
    found = moved("flyball_governor", "turning", wanted["t"][:2], method="explicit")
    for name, values in columns(found).items():
        np.testing.assert_allclose(values, wanted[name][:2], rtol=0, atol=1e-9, err_msg=name)
    assert found.statistics.steps > 2000


def test_the_angular_momentum_about_the_shaft_is_kept() -> None:
    found = moved("flyball_governor", "turning", np.linspace(0, 1, 11), method="stiff", rtol=1e-9)
    momentum = shaft_inertia(found.model.parameters, found["alpha1"]) * found["phi'"]
    np.testing.assert_allclose(momentum, 53.86899865841843, rtol=1e-8)


@pytest.mark.parametrize(
    "values",
    [
        {"k": 4e3, "c": 60.0, "M": 1.0, "H": 1.2, "d": 0.1},
        {"k": 2e5, "c": 3e3, "l": 0.7, "H": 0.8, "b": 0.15, "rho": 2000.0, "w": 0.03, "g": 3.7},
    ],
)
def test_other_governors(values: dict[str, float]) -> None:
    """Against three equations, springs soft and stiff."""
    t = np.linspace(0, 2, 9)
    found = moved("flyball_governor", "turning", t, values, rtol=1e-11)
    np.testing.assert_allclose(found.q.T[:3], swung(t, found.model.parameters), rtol=0, atol=1e-8)
