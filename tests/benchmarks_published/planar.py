"""Plane rigid bodies held together by pins: Newton-Euler with multipliers, in coordinates of every body's centre.

    [M  G^T] [q'']   [Q    ]
    [G   0 ] [l  ] = [gamma],       q = (x, y, angle) of each body, one pair of rows in G for each pin

A second road that shares nothing with the package. Nothing is projected: it is for short motions.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

__all__ = ["Plant"]


@dataclass
class Plant:
    """Bodies, pins (body, point, body or None, point), springs (body, point, fixed point, stiffness, free length).

    Points are in a body's axes from its centre of mass; those of None are in the ground's.
    """

    mass: list[float]
    moment: list[float]
    pins: list[tuple[int, Any, int | None, Any]]
    springs: list[tuple[int, Any, Any, float, float]] = field(default_factory=list)
    torque: dict[int, float] = field(default_factory=dict)
    gravity: float = 0.0

    def accelerations(self, q: Any, q_dot: Any) -> Any:
        """q''"""
        n, c = 3 * len(self.mass), 2 * len(self.pins)
        system, right = np.zeros((n + c, n + c)), np.zeros(n + c)
        for k, (m, moment) in enumerate(zip(self.mass, self.moment, strict=True)):
            system[[3 * k, 3 * k + 1, 3 * k + 2], [3 * k, 3 * k + 1, 3 * k + 2]] = m, m, moment
            right[3 * k + 1 : 3 * k + 3] = -m * self.gravity, self.torque.get(k, 0.0)
        for k, point, anchor, stiffness, length in self.springs:
            arm = turned(q[3 * k + 2], point)
            span = q[3 * k : 3 * k + 2] + arm - anchor
            force = -stiffness * (1 - length / np.hypot(*span)) * span
            right[3 * k : 3 * k + 3] += [*force, arm[0] * force[1] - arm[1] * force[0]]
        for row, (a, at, b, on) in enumerate(self.pins):
            rows = slice(n + 2 * row, n + 2 * row + 2)
            for k, point, sign in ((a, at, 1.0), (b, on, -1.0)):
                if k is not None:
                    arm = turned(q[3 * k + 2], point)
                    system[rows, 3 * k : 3 * k + 3] += sign * np.array([[1, 0, -arm[1]], [0, 1, arm[0]]])
                    right[rows] += sign * arm * q_dot[3 * k + 2] ** 2
        system[:n, n:] = system[n:, :n].T
        return np.linalg.solve(system, right)[:n]

    def motion(self, q: Any, t: Any) -> Any:
        """Positions at times t, from rest."""
        n = len(q)

        def rate(_: float, y: Any) -> Any:
            return np.concatenate([y[n:], self.accelerations(y[:n], y[n:])])

        start = np.concatenate([q, np.zeros(n)])
        return solve_ivp(rate, (0, t[-1]), start, "DOP853", t_eval=t, rtol=1e-12, atol=1e-13).y[:n].T


def turned(angle: float, point: Any) -> Any:
    """A point of a body, from its centre, in the ground's axes."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])
