"""All assemblies of a platform on three legs that swing in vertical planes 120 degrees apart: 3-PRS, 3-RPS.

Leg i starts at the distance d_i from the axis and the height z_i, is l_i long and has the elevation alpha_i, 0 inwards.
Its end B_i has the radius rho_i = d_i - l_i cos(alpha_i) and the height h_i = z_i + l_i sin(alpha_i). Three joints on a
platform, at the radius b, are sqrt(3) b apart:

    |B_i - B_j|^2 = rho_i^2 + rho_j^2 + rho_i rho_j + (h_i - h_j)^2 = 3 b^2

which is bilinear in (1, cos, sin) of the two angles. Half-angle tangents make it biquadratic; eliminating two of the
three gives a polynomial of degree 16, so there are at most 16 assemblies.

Source: K.-M. Lee, D. K. Shah, IEEE J. Robotics Automation 4 (1988) 354-360.
"""

from __future__ import annotations

from itertools import combinations, product
from math import cos, pi, sin
from typing import NamedTuple

import numpy as np

from nullbody.typing import FloatArray

__all__ = ["ThreeLegs"]

_OFFSET = 0.7391  # alpha = offset + 2 atan t, so that no symmetric assembly has an infinite t [rad]
_SAMPLES = 32  # of the resultant on the unit circle; its degree is 16
_NEARLY_REAL = 1e-3  # double roots split by the square root of rounding


class ThreeLegs(NamedTuple):
    """The starts and lengths of the three legs, and the radius of the platform's joints [m]."""

    d: tuple[float, float, float]
    z: tuple[float, float, float]
    l: tuple[float, float, float]  # noqa: E741 - the name of the length
    b: float

    def elevations(self) -> list[FloatArray]:
        """alpha_1, alpha_2, alpha_3 of all assemblies [rad]."""
        found: list[FloatArray] = []
        mirrored = len(set(self.z)) == 1  # then each assembly has its mirror image below the starts
        for start in self._starts():
            angles = self._polished(start)
            for solution in () if angles is None else (angles, -angles) if mirrored else (angles,):
                if not any(np.abs(np.exp(1j * solution) - np.exp(1j * x)).max() < 1e-7 for x in found):
                    found.append(solution)
        return found

    def ends(self, angles: FloatArray) -> FloatArray:
        """(rho_i, h_i) row by row."""
        radius = np.array(self.d) - np.array(self.l) * np.cos(angles)
        return np.column_stack([radius, np.array(self.z) + np.array(self.l) * np.sin(angles)])

    def _forms(self) -> dict[tuple[int, int], FloatArray]:
        """G_ij with (1, cos_i, sin_i) G_ij (1, cos_j, sin_j)^T = |B_i - B_j|^2 - 3 b^2."""
        forms = {}
        for i, j in combinations(range(3), 2):
            (di, dj), (li, lj), rise = (self.d[i], self.d[j]), (self.l[i], self.l[j]), self.z[i] - self.z[j]
            G = np.zeros((3, 3))
            G[0, 0] = di**2 + dj**2 + di * dj + rise**2 + li**2 + lj**2 - 3 * self.b**2
            G[1, 0], G[2, 0] = -2 * di * li - dj * li, 2 * rise * li
            G[0, 1], G[0, 2] = -2 * dj * lj - di * lj, -2 * rise * lj
            G[1, 1], G[2, 2] = li * lj, -2 * li * lj
            forms[i, j] = G
        return forms

    def _starts(self) -> list[FloatArray]:
        """Angles near all assemblies: real roots of the resultant, with both roots for the other two legs."""
        c, n = cos(_OFFSET), sin(_OFFSET)
        T = np.array([[1, 0, 1], [c, -2 * n, -c], [n, 2 * c, -n]])  # (1, cos, sin)(1 + t^2) = T (1, t, t^2)
        P = {pair: T.T @ G @ T for pair, G in self._forms().items()}
        circle = np.exp(2j * pi * np.arange(_SAMPLES) / _SAMPLES)
        values = np.array([_resultant(P, t) for t in circle])
        polynomial = np.fft.fft(values)[:17] / _SAMPLES
        roots = np.roots(polynomial.real[::-1])
        starts = []
        for root in roots[np.abs(roots.imag) < _NEARLY_REAL * (1 + np.abs(roots))].real:
            power = np.array([1, root, root**2])
            seconds, thirds = _near_real(power @ P[0, 1]), _near_real(power @ P[0, 2])
            starts += [_OFFSET + 2 * np.arctan([root, second, third]) for second, third in product(seconds, thirds)]
        return starts

    def _polished(self, start: FloatArray) -> FloatArray | None:
        """Newton on the three distances; None unless it converges."""
        forms, angles = self._forms(), start.copy()
        scale = max(self.l) ** 2 + self.b**2 + max(d * d for d in self.d) + max(z * z for z in self.z)
        for _ in range(40):
            values, slopes = np.zeros(3), np.zeros((3, 3))
            for row, ((i, j), G) in enumerate(forms.items()):
                left, right = (np.array([1, cos(angles[k]), sin(angles[k])]) for k in (i, j))
                turn = [np.array([0, -sin(angles[k]), cos(angles[k])]) for k in (i, j)]
                values[row], slopes[row, i], slopes[row, j] = left @ G @ right, turn[0] @ G @ right, left @ G @ turn[1]
            step = np.linalg.lstsq(slopes, -values, rcond=1e-12)[0]
            angles += step * min(1.0, 0.3 / max(float(np.abs(step).max()), 1e-300))
            if np.abs(step).max() < 1e-13 or np.abs(values).max() < 1e-16 * scale:
                break
        return angles if np.abs(values).max() < 1e-13 * scale else None


def _resultant(P: dict[tuple[int, int], FloatArray], t: complex) -> complex:
    """Resultant of the three biquadratics at t_1 = t: first t_2, then t_3 is eliminated."""
    power = np.array([1, t, t * t])
    c0, c1, c2 = power @ P[0, 1]  # in t_2
    q0, q1, q2 = P[1, 2]  # rows: powers of t_2, polynomials in t_3
    mixed = c2 * q0 - c0 * q2
    quartic = np.convolve(mixed, mixed) - np.convolve(c2 * q1 - c1 * q2, c1 * q0 - c0 * q1)
    quadratic = power @ P[0, 2]
    sylvester = np.zeros((6, 6), dtype=complex)
    for k in range(2):
        sylvester[k, k : k + 5] = quartic
    for k in range(4):
        sylvester[2 + k, k : k + 3] = quadratic
    return complex(np.linalg.det(sylvester))


def _near_real(ascending: FloatArray) -> list[float]:
    """Real parts of the roots of a quadratic; complex pairs stand for a nearly double root."""
    return [float(root.real) for root in np.roots(ascending[::-1])]
