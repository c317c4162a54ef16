"""The 3-PRS robot by virtual power and multipliers in all twelve coordinates, with nothing from the package.

Written from the geometry in numpy: positions and rotations are differentiated by complex steps (exact to rounding),
accelerations for q'' = 0 by Richardson extrapolation of velocities along q + t q'. No elimination, no null space:

    [ M  A^T ] [ q''    ]   [ S F - h ]
    [ A   0  ] [ lambda ] = [  -c     ]
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np

__all__ = ["Multipliers", "Terms", "forward", "inverse"]

E = np.array([[0, 0, 1], [np.sqrt(3) / 2, 0, -1 / 2], [-np.sqrt(3) / 2, 0, -1 / 2]])  # the legs' directions
UP = np.array([0.0, 1.0, 0.0])
S = np.vstack([np.zeros((9, 3)), np.eye(3)])
TINY = 1e-30  # complex step


class Terms(NamedTuple):
    """M q'' + h + A^T lambda = S F,  A q'' + c = 0."""

    M: np.ndarray
    h: np.ndarray
    A: np.ndarray
    c: np.ndarray


@dataclass(frozen=True)
class Multipliers:
    """Terms of the equations of motion for one set of parameters.

    Attributes:
        p: a, b, l, M, m, g, Ixx, Iyy, Izz, ms.
        rod: inertia of a link about its centre, in units of m l^2.
        up: +1; -1 turns gravity around (to test the tests).
    """

    p: Mapping[str, float]
    rod: float = 1 / 12
    up: float = 1.0
    links: tuple[float, ...] = field(default=(1.0, 1.0, 1.0))

    def closures(self, q: np.ndarray) -> np.ndarray:
        """f = B_leg - B_platform."""
        R, gaps = rotation(q), []
        for i in range(3):
            leg = (self.p["a"] - q[9 + i]) * E[i] + self.p["l"] * along(q[6 + i], E[i])
            gaps.append(leg - q[:3] - R @ (self.p["b"] * E[i]))
        return np.concatenate(gaps)

    def centres(self, q: np.ndarray) -> np.ndarray:
        """Centres of mass: platform, three links, three sliders (7 x 3)."""
        sliders = [(self.p["a"] - q[9 + i]) * E[i] for i in range(3)]
        links = [sliders[i] + self.p["l"] / 2 * along(q[6 + i], E[i]) for i in range(3)]
        return np.array([q[:3], *links, *sliders])

    def masses(self) -> np.ndarray:
        """Masses of the same bodies."""
        return np.array([self.p["M"], *(self.p["m"] * np.array(self.links)), *[self.p["ms"]] * 3])

    def spins(self, q: np.ndarray, q_dot: np.ndarray) -> np.ndarray:
        """Angular velocities of platform and links in the ground frame (4 x 3)."""
        turning = rotation(q + 1j * TINY * q_dot).imag / TINY @ rotation(q).T
        platform = np.array([turning[2, 1], turning[0, 2], turning[1, 0]])
        return np.array([platform, *(-q_dot[6 + i] * np.cross(UP, E[i]) for i in range(3))])

    def inertias(self, q: np.ndarray) -> np.ndarray:
        """Inertia matrices of platform and links about their centres, in the ground frame (4 x 3 x 3)."""
        R = rotation(q)
        found = [R @ np.diag([self.p["Ixx"], self.p["Iyy"], self.p["Izz"]]) @ R.T]
        for i in range(3):
            d = along(q[6 + i], E[i])
            found.append(self.links[i] * self.rod * self.p["m"] * self.p["l"] ** 2 * (np.eye(3) - np.outer(d, d)))
        return np.array(found)

    def terms(self, q: np.ndarray, q_dot: np.ndarray) -> Terms:
        """M, h, A, c."""
        units, inertias = np.eye(12), self.inertias(q)
        J = np.array([rate(self.centres, q, e) for e in units])  # 12 x 7 x 3
        W = np.array([self.spins(q, e) for e in units])  # 12 x 4 x 3
        M = np.einsum("b,ibk,jbk->ij", self.masses(), J, J) + np.einsum("ibk,bkl,jbl->ij", W, inertias, W)
        bias = slope(lambda t: rate(self.centres, q + t * q_dot, q_dot)) + self.up * self.p["g"] * UP
        momentum = slope(
            lambda t: np.einsum("bkl,bl->bk", self.inertias(q + t * q_dot), self.spins(q + t * q_dot, q_dot))
        )
        h = np.einsum("b,ibk,bk->i", self.masses(), J, bias) + np.einsum("ibk,bk->i", W, momentum)
        A = np.array([rate(self.closures, q, e) for e in units]).T
        c = slope(lambda t: rate(self.closures, q + t * q_dot, q_dot))
        return Terms(M, h, A, c)

    def energy(self, q: np.ndarray, q_dot: np.ndarray) -> tuple[float, float]:
        """Kinetic and potential energy, body by body."""
        velocity, spin = rate(self.centres, q, q_dot), self.spins(q, q_dot)
        kinetic = self.masses() @ (velocity**2).sum(axis=1) / 2
        kinetic += np.einsum("bk,bkl,bl->", spin, self.inertias(q), spin) / 2
        return float(kinetic), float(self.p["g"] * self.masses() @ self.centres(q)[:, 1])


def along(alpha: float, e: np.ndarray) -> np.ndarray:
    """Direction of a link, from its slider to the platform."""
    return np.sin(alpha) * UP - np.cos(alpha) * e


def rotation(q: np.ndarray) -> np.ndarray:
    """R = Rz(phi) Ry(theta) Rx(psi)."""
    (a, b, c), (u, v, w) = np.cos(q[3:6]), np.sin(q[3:6])
    Rx = np.array([[1, 0, 0], [0, a, -u], [0, u, a]])
    Ry = np.array([[b, 0, v], [0, 1, 0], [-v, 0, b]])
    Rz = np.array([[c, -w, 0], [w, c, 0], [0, 0, 1]])
    return Rz @ Ry @ Rx


def rate(function: Callable[[np.ndarray], np.ndarray], q: np.ndarray, q_dot: np.ndarray) -> np.ndarray:
    """d/dt function(q + t q') at t = 0, by a complex step."""
    return function(q + 1j * TINY * q_dot).imag / TINY


def slope(function: Callable[[float], np.ndarray], step: float = 0.03, levels: int = 5) -> np.ndarray:
    """d/dt function(t) at t = 0, by central differences and Richardson extrapolation."""
    table = [(function(h) - function(-h)) / (2 * h) for h in step / 2.0 ** np.arange(levels)]
    for k in range(1, levels):
        table = [fine + (fine - coarse) / (4**k - 1) for coarse, fine in pairwise(table)]
    return table[0]


def forward(terms: Terms, F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """q'' and lambda for given forces."""
    matrix = np.block([[terms.M, terms.A.T], [terms.A, np.zeros((9, 9))]])
    solution = np.linalg.solve(matrix, np.concatenate([S @ F - terms.h, -terms.c]))
    return solution[:12], solution[12:]


def inverse(terms: Terms, s_ddot: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """F, q'' and lambda for given accelerations of the slides."""
    zero = np.zeros
    matrix = np.block(
        [
            [terms.M, terms.A.T, -S],
            [terms.A, zero((9, 9)), zero((9, 3))],
            [S.T, zero((3, 9)), zero((3, 3))],
        ]
    )
    solution = np.linalg.solve(matrix, np.concatenate([-terms.h, -terms.c, s_ddot]))
    return solution[21:], solution[:12], solution[12:21]
