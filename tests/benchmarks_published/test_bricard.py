"""IFToMM A04: Bricard's mechanism, whose rows are one too many on the manifold only, and not always the same one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.polynomial import Chebyshev
from scipy.integrate import solve_ivp

from nullbody import Trajectory
from nullbody.typing import FloatArray
from tests.benchmarks_published.published import moved, reference

DIRECTIONS = np.array([(1, 0, 0), (0, -1, 0), (0, 0, 1), (-1, 0, 0), (0, 1, 0)])
AXES = np.eye(3)[[1, 2, 0, 1, 2]]


def even(odd: Any) -> Any:
    """theta2 = theta4 from theta1 = theta3 = theta5: (1 + sin(odd)) (1 + sin(even)) = 1."""
    return np.arcsin(1 / (1 + np.sin(odd)) - 1)


def rods(a: complex) -> list[tuple[Any, Any]]:
    """Orientation of each rod, and its centre for rods of length 1, on the threefold symmetric branch."""
    R, node, placed = np.eye(3), np.zeros(3), []
    for direction, axis, angle in zip(DIRECTIONS, AXES, [a, even(a), a, even(a), a], strict=True):
        cross = np.cross(np.eye(3), axis)
        R = R @ (np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)
        placed.append((R, node + R @ direction / 2))
        node = node + R @ direction
    return placed


def inertia_and_lift(a: float, w: float) -> tuple[float, float]:
    """2 T / theta1'^2 and the sum of the centres' heights, for rods of 1 kg and 1 m."""
    step = 1e-30
    inertia = lift = 0.0
    for (R, centre), direction in zip(rods(a + 1j * step), DIRECTIONS, strict=True):
        turn = (R.imag / step) @ R.real.T
        spin, velocity = np.array([turn[2, 1], turn[0, 2], turn[1, 0]]), centre.imag / step
        along = spin @ (R.real @ direction)
        moments = w**2 / 6 * along**2 + (1 + w**2) / 12 * (spin @ spin - along**2)
        inertia, lift = inertia + velocity @ velocity + moments, lift + centre.real[1]
    return inertia, lift


def swung(t: FloatArray, w: float, rate2: float) -> FloatArray:
    """theta1 from rest at 0: I a'' = -I' a'^2/2 - rate2 H', with rate2 = g/L."""
    samples = np.array([0.5 * np.pi * (1 + 1.05 * np.cos(np.pi * (k + 0.5) / 90)) for k in range(90)])
    values = np.array([inertia_and_lift(a, w) for a in samples]).T
    inertia, lift = (Chebyshev.fit(samples, column, 85, domain=[-0.025 * np.pi, 1.025 * np.pi]) for column in values)
    slope, pull = inertia.deriv(), lift.deriv()

    def rate(_: float, y: FloatArray) -> list[float]:
        return [y[1], -(slope(y[0]) * y[1] ** 2 / 2 + rate2 * pull(y[0])) / inertia(y[0])]

    return solve_ivp(rate, (0, t[-1]), [0.0, 0.0], "DOP853", t_eval=t, rtol=1e-12, atol=1e-13).y[0]


def third_node(found: Trajectory) -> FloatArray:
    """P3, node 2, and its velocity."""
    (a, b), (a_dot, b_dot) = found.q.T[:2], found.q_dot.T[:2]
    reach, reach_dot = 1 + np.sin(b), np.cos(b) * b_dot
    c, s = np.cos(a), np.sin(a)
    velocity = (reach_dot * c - reach * s * a_dot, np.sin(b) * b_dot, -reach_dot * s - reach * c * a_dot)
    return np.array([reach * c, -np.cos(b), -reach * s, *velocity])


def test_the_published_motion() -> None:
    """10 s, past 1.25 and 3.7 s, where a fixed choice of rows fails."""
    wanted = reference("bricard", "cube")
    found = moved("bricard", "cube", wanted["t"])
    columns = ("P3_x", "P3_y", "P3_z", "P3dot_x", "P3dot_y", "P3dot_z")
    np.testing.assert_allclose(third_node(found), [wanted[c] for c in columns], rtol=0, atol=1e-10)
    np.testing.assert_allclose(found["theta1"], wanted["theta1"], rtol=0, atol=1e-10)
    assert found.statistics.energy_drift < 1e-9
    assert found.statistics.residual < 1e-13


def test_one_row_repeats_the_others_where_the_loop_is_closed() -> None:
    found = moved("bricard", "cube", np.array([0.0, 0.5]))
    assert len(found.model.labels) == 4
    assert len(found.model.closure_labels) == 5
    assert found.model.freedom == 1


def test_the_branch_is_threefold_symmetric() -> None:
    found = moved("bricard", "cube", np.linspace(0, 10, 41))
    a, b, c, d, e = found.q.T
    for same in (c, e):
        np.testing.assert_allclose(a, same, rtol=0, atol=1e-10)
    for same in (b, d):
        np.testing.assert_allclose(even(a), same, rtol=0, atol=1e-10)


@pytest.mark.parametrize("values", [{}, {"w": 0.0}, {"L": 0.45, "w": 0.12, "m": 3.0}, {"L": 2.0, "g": 5.0}])
def test_other_rods(values: dict[str, float]) -> None:
    """Against one equation in theta1; masses fall out, lengths enter as g/L and w/L."""
    t = np.linspace(0, 4, 9)
    found = moved("bricard", "cube", t, values)
    p = found.model.parameters
    wanted = swung(t, p["w"] / p["L"], p["g"] / p["L"])
    np.testing.assert_allclose(found["theta1"], wanted, rtol=0, atol=1e-9)
