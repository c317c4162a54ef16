"""IFToMM A02: rows of four-bars that pass their flat pose twice a turn, against elliptic functions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from mpmath import ellipfun, mpf, re

from nullbody import Trajectory
from nullbody.typing import FloatArray
from tests.benchmarks_published.published import moved, reference

N = pytest.mark.parametrize("n", [1, 2, 3, 10])


def top(found: Trajectory) -> FloatArray:
    """Position and velocity of B0, the top of bar 0."""
    L, theta, rate = found.model.parameters["L"], found["theta0"], found["theta0'"]
    return L * np.array([np.sin(theta), np.cos(theta), np.cos(theta) * rate, -np.sin(theta) * rate])


def parallel(t: FloatArray, n: int, p: Any, speed: float = 1.0) -> FloatArray:
    """B0 as long as all bars are parallel: sin(theta/2) = sn(w t/2 | -4 k / w^2), theta' = w dn, w = speed / L."""
    L, w = mpf(p["L"]), mpf(speed) / mpf(p["L"])
    lift, inertia = (n + 1) * p["m"] / 2 + n * p["mc"], (n + 1) * p["m"] / 3 + n * p["mc"]
    m = -4 * mpf(p["g"]) * lift / (L * inertia) / w**2
    columns = []
    for time in t:
        sn, cn, dn = (re(ellipfun(name, w * mpf(float(time)) / 2, m=m)) for name in ("sn", "cn", "dn"))
        x, y, rate = L * 2 * sn * cn, L * (1 - 2 * sn**2), w * dn
        columns.append([float(value) for value in (x, y, y * rate, -x * rate)])
    return np.array(columns).T


@N
def test_the_exact_solution_is_the_references(n: int) -> None:
    wanted = reference("n_four_bar", str(n))
    exact = parallel(wanted["t"], n, {"L": 1.0, "m": 1.0, "mc": 1.0, "g": 9.81})
    np.testing.assert_allclose(exact, [wanted[c] for c in ("B0_x", "B0_y", "B0_xd", "B0_yd")], rtol=0, atol=1e-13)


@N
def test_until_right_before_the_flat_pose(n: int) -> None:
    """The bars lie flat at 0.708 to 0.722 s."""
    t = np.linspace(0, 0.68, 5)
    found = moved("n_four_bar", "upright", t, {"n": n})
    np.testing.assert_allclose(top(found), parallel(t, n, found.model.parameters), rtol=0, atol=1e-9)
    assert found.statistics.crossings == 0


@pytest.mark.parametrize("n", [1, 2, 3, 10, 40])
def test_through_twenty_flat_poses(n: int) -> None:
    """20 s, ten turns. The published criterion is an energy error below 0.1 J over 10 s."""
    wanted = reference("n_four_bar", str(n))
    found = moved("n_four_bar", "upright", wanted["t"], {"n": n}, rtol=1e-9)
    position, velocity = np.split(top(found), 2)
    np.testing.assert_allclose(position, [wanted["B0_x"], wanted["B0_y"]], rtol=0, atol=2e-5)
    np.testing.assert_allclose(velocity, [wanted["B0_xd"], wanted["B0_yd"]], rtol=0, atol=2e-4)
    assert found.statistics.crossings in (20, 21)
    assert found.statistics.energy_drift < 1e-4
    assert found.statistics.residual < 1e-13


def test_all_bars_stay_parallel() -> None:
    """No branch is left in a flat pose: the couplers never turn."""
    found = moved("n_four_bar", "upright", np.linspace(0, 4, 41), {"n": 3}, rtol=1e-9)
    theta, phi = found.q[:, :4], found.q[:, 4:]
    np.testing.assert_allclose(theta, np.tile(theta[:, :1], 4), rtol=0, atol=1e-6)
    np.testing.assert_allclose(phi, -theta[:, :3], rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("n", "values"),
    [(1, {"L": 0.4, "m": 2.0}), (2, {"b": 0.3, "mc": 5.0}), (4, {"L": 1.5, "b": 2.0, "g": 3.7, "m": 0.2, "mc": 0.1})],
)
def test_other_lengths_and_masses(n: int, values: dict[str, float]) -> None:
    t = np.linspace(0, 5, 11)
    found = moved("n_four_bar", "upright", t, {"n": n, **values}, rtol=1e-9)
    np.testing.assert_allclose(top(found), parallel(t, n, found.model.parameters), rtol=0, atol=5e-5)
