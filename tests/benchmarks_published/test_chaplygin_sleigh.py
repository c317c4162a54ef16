"""The Chaplygin sleigh against its closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from nullbody import Trajectory
from nullbody.typing import FloatArray
from tests.benchmarks_published.published import moved, reference


def speeds(found: Trajectory) -> FloatArray:
    """v along the blade, w = phi'."""
    phi, (x_dot, y_dot, w) = found["phi"], found.q_dot.T
    return np.array([x_dot * np.cos(phi) + y_dot * np.sin(phi), w])


def exact(t: FloatArray, p: Any, v0: float = -0.5, w0: float = 1.0) -> tuple[FloatArray, FloatArray]:
    """(x, y, phi), (v, w): v = A tanh(k t + c), w = B sech(k t + c), phi = (B/k) (gd(k t + c) - gd(c))."""
    J = p["I"] + p["m"] * p["a"] ** 2
    A = np.sqrt(v0**2 + J * w0**2 / p["m"])
    B = np.sqrt(A**2 * p["m"] / J)
    k, c = p["a"] * B**2 / A, np.arctanh(v0 / A)

    def phi(time: float) -> float:
        return float(B / k * 2 * (np.arctan(np.tanh((k * time + c) / 2)) - np.arctan(np.tanh(c / 2))))

    def way(trace: Any, end: float) -> float:
        def along(s: float) -> float:
            return float(A * np.tanh(k * s + c) * trace(phi(s)))

        return float(quad(along, 0, end, epsabs=1e-13, epsrel=1e-13, limit=400)[0])

    q = [[way(np.cos, s), way(np.sin, s), phi(s)] for s in t]
    return np.array(q).T, np.array([A * np.tanh(k * t + c), B / np.cosh(k * t + c)])


def test_the_published_motion() -> None:
    wanted = reference("chaplygin_sleigh", "backwards")
    found = moved("chaplygin_sleigh", "backwards", wanted["t"])
    np.testing.assert_allclose(found.q.T, [wanted[c] for c in ("x", "y", "phi")], rtol=0, atol=1e-9)
    np.testing.assert_allclose(speeds(found), [wanted["v"], wanted["omega"]], rtol=0, atol=1e-10)
    np.testing.assert_allclose(found.kinetic, 0.18, rtol=0, atol=1e-10)


@pytest.mark.parametrize("values", [{"a": 0.35, "m": 3.0, "I": 0.2}, {"a": 0.02, "I": 0.01}])
def test_other_sleighs(values: dict[str, float]) -> None:
    t = np.linspace(0, 6, 7)
    found = moved("chaplygin_sleigh", "backwards", t, values)
    q, v = exact(t, found.model.parameters)
    np.testing.assert_allclose(found.q.T, q, rtol=0, atol=1e-9)
    np.testing.assert_allclose(speeds(found), v, rtol=0, atol=1e-9)


def test_the_force_on_the_blade() -> None:
    """m (v w + a w') to its left."""
    t = np.linspace(0, 5, 6)
    found = moved("chaplygin_sleigh", "backwards", t)
    for time, v, w in zip(t, *speeds(found), strict=True):
        x = found.state(float(time))
        chart = found.model.in_chart(x.independent)
        assert chart.reactions(x)[0] == pytest.approx(v * w + 0.1 * chart.forward_dynamics(x)[2], abs=1e-10)
