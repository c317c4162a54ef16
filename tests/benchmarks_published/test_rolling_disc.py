"""Rolling discs: a coin, a wobbling disc, and steady rolling in a circle; motion, spin and contact force."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import Trajectory
from nullbody.typing import FloatArray
from tests.benchmarks_published.published import moved, reference


def seen(found: Trajectory) -> dict[str, FloatArray]:
    """Centre, axis, angular velocity and contact force, in the names of the reference."""
    e0, e1, e2, e3 = found.q.T[3:]
    d0, d1, d2, d3 = found.q_dot.T[3:]
    columns = dict(zip(("x", "y", "z"), found.q.T[:3], strict=True))
    columns |= {"n_x": 1 - 2 * (e2**2 + e3**2), "n_y": 2 * (e1 * e2 + e0 * e3), "n_z": 2 * (e1 * e3 - e0 * e2)}
    columns["wx"] = 2 * (-e1 * d0 + e0 * d1 - e3 * d2 + e2 * d3)
    columns["wy"] = 2 * (-e2 * d0 + e3 * d1 + e0 * d2 - e1 * d3)
    columns["wz"] = 2 * (-e3 * d0 - e2 * d1 + e1 * d2 + e0 * d3)
    forces = []
    for t in found.t:
        state = found.state(float(t))
        chart = found.model.in_chart(state.independent)
        force = dict(zip(chart.labels, chart.reactions(state), strict=True))
        forces.append([force[f"contact {row}"] for row in ("slip_x", "slip_y", "height")])
    return columns | dict(zip(("Fx", "Fy", "Fz"), np.array(forces).T, strict=True))


@pytest.mark.parametrize(("motion", "digits"), [("coin", 5e-9), ("generic", 5e-9), ("steady", 5e-9)])
def test_the_published_motions(motion: str, digits: float) -> None:
    wanted = reference("rolling_disc", motion)
    found = moved("rolling_disc", motion, wanted["t"])
    for name, values in seen(found).items():
        np.testing.assert_allclose(values, wanted[name], rtol=0, atol=digits, err_msg=name)
    assert found.statistics.energy_drift < 1e-9
    assert found.statistics.residual < 1e-13


@pytest.mark.parametrize(
    "values",
    [{"r": 0.13, "m": 2.5}, {"g": 1.62}, {"r": 0.8, "Ia": 0.7, "Id": 0.35}, {"r": 0.4, "Ia": 0.03, "Id": 0.09}],
)
def test_other_discs_roll_steadily_in_their_circle(values: dict[str, float]) -> None:
    """R = r spin / W; x = r sin(a) + R (1 - cos(W t)), y = -R sin(W t); z and the upright force m g stay.

    The slope that gives the spin is the balance of moments about the contact point of a body of any Ia, Id.
    """
    t = np.linspace(0, 3, 7)
    found = moved("rolling_disc", "steady", t, values)
    p, a, W = found.model.parameters, np.pi / 9, 1.5
    s, c = np.sin(a), np.cos(a)
    spin = (p["m"] * p["g"] * p["r"] * s - p["Id"] * W**2 * s * c) / ((p["Ia"] + p["m"] * p["r"] ** 2) * c * W)
    R = p["r"] * spin / W
    columns = seen(found)
    np.testing.assert_allclose(columns["x"], p["r"] * s + R * (1 - np.cos(W * t)), rtol=0, atol=2e-9)
    np.testing.assert_allclose(columns["y"], -R * np.sin(W * t), rtol=0, atol=2e-9)
    np.testing.assert_allclose(columns["z"], p["r"] * c, rtol=0, atol=1e-9)
    np.testing.assert_allclose(columns["Fz"], p["m"] * p["g"], rtol=1e-8)
    np.testing.assert_allclose(columns["Fx"], p["m"] * R * W**2 * np.cos(W * t), rtol=0, atol=1e-7)
