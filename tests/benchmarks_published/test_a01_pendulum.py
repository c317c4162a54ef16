"""IFToMM A01: the pendulum in Cartesian coordinates, against elliptic functions."""

from __future__ import annotations

import numpy as np
import pytest
from mpmath import ellipfun, ellipk, mpf, sqrt

from nullbody.typing import FloatArray
from tests.benchmarks_published.published import moved, reference


def swung(t: FloatArray, L: float, g: float) -> FloatArray:
    """(x, y) from rest at x = -L: sin(theta/2) = k sn(K(k) + sqrt(g/L) t), k^2 = 1/2."""
    m = mpf(1) / 2
    points = []
    for time in t:
        sn = ellipfun("sn", ellipk(m) + sqrt(mpf(g) / mpf(L)) * mpf(float(time)), m=m)
        half = sqrt(m) * sn
        points.append((float(-L * 2 * half * sqrt(1 - half**2)), float(-L * (1 - 2 * half**2))))
    return np.array(points)


def test_the_published_motion() -> None:
    """16 changes of the independent coordinate on the way, none of them visible."""
    wanted = reference("a01_pendulum", "horizontal")
    found = moved("a01_pendulum", "horizontal", wanted["t"])
    np.testing.assert_allclose(found.q.T, [wanted["x"], wanted["y"]], rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.q_dot.T, [wanted["xd"], wanted["yd"]], rtol=0, atol=3e-9)
    assert found.statistics.energy_drift < 2e-9
    assert found.statistics.residual < 1e-13
    assert found.statistics.switches > 10


@pytest.mark.parametrize("values", [{"L": 0.37, "m": 4.0}, {"g": 1.62, "L": 2.5, "m": 0.02}])
def test_other_lengths_masses_and_gravity(values: dict[str, float]) -> None:
    t = np.linspace(0, 4, 9)
    found = moved("a01_pendulum", "horizontal", t, values)
    p = found.model.parameters
    np.testing.assert_allclose(found.q, swung(t, p["L"], p["g"]), rtol=0, atol=1e-9 * p["L"])


def test_the_bar_carries_three_times_the_weight_at_the_bottom() -> None:
    """Tension 3 m g cos(theta) = -3 m g y / L: from energy, and the centripetal force m v^2 / L."""
    t = np.linspace(0, 3, 13)
    found = moved("a01_pendulum", "horizontal", t, {"m": 2.0, "L": 0.5})
    wanted = -3 * 2.0 * 9.81 * found["y"] / 0.5
    tension = [found.model.in_chart(x.independent).reactions(x)[0] for x in map(found.state, t)]
    np.testing.assert_allclose(tension, wanted, rtol=0, atol=1e-7)
