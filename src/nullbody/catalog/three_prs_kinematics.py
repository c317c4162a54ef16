"""Closed-form kinematics of the 3-PRS robot: all assemblies for given slides, all slides for a given pose.

With d_i = a - s_i, the radius rho_i = d_i - l cos(alpha_i) and the height h_i = l sin(alpha_i) of joint B_i:

    |B_i - B_j|^2 = rho_i^2 + rho_j^2 + rho_i rho_j + (h_i - h_j)^2 = 3 b^2

which is bilinear in (1, cos, sin) of the two angles. Half-angle tangents make it biquadratic; eliminating two of
the three gives a polynomial of degree 16, so there are at most 16 assemblies.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations, product
from math import acos, asin, atan2, cos, hypot, pi, sin, sqrt

import numpy as np

from nullbody.catalog.closed_form import ClosedForm
from nullbody.errors import AssemblyError, SingularityError
from nullbody.typing import FloatArray

__all__ = ["CLOSED_FORM"]

Values = Mapping[str, float]

_OFFSET = 0.7391  # alpha = offset + 2 atan t, so that no symmetric assembly has an infinite t [rad]
_SAMPLES = 32  # of the resultant on the unit circle; its degree is 16
_NEARLY_REAL = 1e-3  # double roots split by the square root of rounding
_ROUNDING = 1e-12  # relative, by which a vertical link may seem too short
_E = np.array([[0, 0, 1], [sqrt(3) / 2, 0, -1 / 2], [-sqrt(3) / 2, 0, -1 / 2]])  # e_i


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """All assemblies for s1, s2, s3."""
    if set(known) != {"s1", "s2", "s3"}:
        return None
    s = [float(known[f"s{i}"]) for i in (1, 2, 3)]
    found: list[FloatArray] = []
    for start in _starts(p, s):
        angles = _polished(p, s, start)
        for solution in () if angles is None else (angles, -angles):  # each has its mirror image below the slides
            if not any(np.abs(np.exp(1j * solution) - np.exp(1j * x)).max() < 1e-7 for x in found):
                found.append(solution)
    return [_coordinates(p, s, angles) for angles in found]


def _forms(p: Values, s: list[float]) -> dict[tuple[int, int], FloatArray]:
    """G_ij with (1, cos_i, sin_i) G_ij (1, cos_j, sin_j)^T = |B_i - B_j|^2 - 3 b^2."""
    l, b = p["l"], p["b"]  # noqa: E741 - the paper's name of the length
    d = [p["a"] - x for x in s]
    forms = {}
    for i, j in combinations(range(3), 2):
        G = np.zeros((3, 3))
        G[0, 0] = d[i] ** 2 + d[j] ** 2 + d[i] * d[j] + 2 * l**2 - 3 * b**2
        G[1, 0] = -2 * d[i] * l - d[j] * l
        G[0, 1] = -2 * d[j] * l - d[i] * l
        G[1, 1], G[2, 2] = l**2, -2 * l**2
        forms[i, j] = G
    return forms


def _starts(p: Values, s: list[float]) -> list[FloatArray]:
    """Angles near all assemblies: real roots of the resultant, with both roots for the other two legs."""
    c, n = cos(_OFFSET), sin(_OFFSET)
    T = np.array([[1, 0, 1], [c, -2 * n, -c], [n, 2 * c, -n]])  # (1, cos, sin)(1 + t^2) = T (1, t, t^2)
    P = {pair: T.T @ G @ T for pair, G in _forms(p, s).items()}
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


def _polished(p: Values, s: list[float], start: FloatArray) -> FloatArray | None:
    """Newton on the three distances; None unless it converges."""
    forms, angles = _forms(p, s), start.copy()
    scale = p["l"] ** 2 + p["b"] ** 2 + max((p["a"] - x) ** 2 for x in s)
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


def _coordinates(p: Values, s: list[float], angles: FloatArray) -> dict[str, float]:
    """All coordinates from slides and elevations: the platform stands on its three joints."""
    y = np.array([0, 1, 0])
    B = [(p["a"] - s[i] - p["l"] * cos(angles[i])) * _E[i] + p["l"] * sin(angles[i]) * y for i in range(3)]
    centre = sum(B) / 3
    z_axis, x_axis = (B[0] - centre) / p["b"], (B[1] - B[2]) / (sqrt(3) * p["b"])
    R = np.column_stack([x_axis, np.cross(z_axis, x_axis), z_axis])
    theta = atan2(-R[2, 0], hypot(R[0, 0], R[1, 0]))
    pose = [*centre, atan2(R[2, 1], R[2, 2]), theta, atan2(R[1, 0], R[0, 0])]
    names = ["x", "y", "z", "psi", "theta", "phi", "alpha1", "alpha2", "alpha3", "s1", "s2", "s3"]
    return {name: float(value) for name, value in zip(names, [*pose, *angles, *s], strict=True)}


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """All assemblies for the height y and two of the angles psi, theta, phi: two for each leg.

    The joints B_i stay in the legs' planes: x, z follow, and sin(theta) (1 + cos(phi) cos(psi)) = -sin(phi) sin(psi).
    """
    if "y" not in pose or not set(pose) <= {"y", "psi", "theta", "phi"} or len(pose) != 3:
        return None
    found: list[dict[str, float]] = []
    missed: AssemblyError | None = None
    for tilt in _tilts(pose):
        try:
            found += _legs(p, float(pose["y"]), *tilt)
        except AssemblyError as error:
            missed = missed or error
    if missed is not None and not found:
        raise missed
    return found


def _tilts(pose: Values) -> list[tuple[float, float, float]]:
    """(psi, theta, phi) from two of them."""
    if "theta" not in pose:
        psi, phi = float(pose["psi"]), float(pose["phi"])
        if 1 + cos(phi) * cos(psi) < _ROUNDING:
            raise SingularityError("the platform is upside down: psi and phi do not determine theta")
        sine = -sin(phi) * sin(psi) / (1 + cos(phi) * cos(psi))  # within -1..1: 1 + cos(phi +- psi) >= 0
        return [(psi, asin(max(-1.0, min(1.0, sine))), phi)]
    other = "psi" if "psi" in pose else "phi"
    theta, tilt = float(pose["theta"]), float(pose[other])
    # sin(theta) cos(tilt) cos(x) + sin(tilt) sin(x) = -sin(theta) for the angle x that is not given
    A, B, C = sin(theta) * cos(tilt), sin(tilt), -sin(theta)
    size = hypot(A, B)  # at least |C|
    if size < _ROUNDING:
        raise SingularityError(f"theta = 0 and {other} = 0 leave the third angle free: give psi and phi")
    middle, half = atan2(B, A), acos(max(-1.0, min(1.0, C / size)))
    third = sorted({middle + half, middle - half}, key=lambda x: abs(atan2(sin(x), cos(x))))
    turned = [atan2(sin(x), cos(x)) for x in third]
    return [(tilt, theta, x) if other == "psi" else (x, theta, tilt) for x in turned]


def _legs(p: Values, y: float, psi: float, theta: float, phi: float) -> list[dict[str, float]]:
    """Both elevations of every leg for a platform pose."""
    Rx = np.array([[1, 0, 0], [0, cos(psi), -sin(psi)], [0, sin(psi), cos(psi)]])
    Ry = np.array([[cos(theta), 0, sin(theta)], [0, 1, 0], [-sin(theta), 0, cos(theta)]])
    Rz = np.array([[cos(phi), -sin(phi), 0], [sin(phi), cos(phi), 0], [0, 0, 1]])
    arms = [p["b"] * (Rz @ Ry @ Rx @ e) for e in _E]
    lateral = [np.cross([0, 1, 0], e) for e in _E]
    x = -arms[0][0]
    z = float(lateral[1] @ arms[1] - lateral[2] @ arms[2]) / sqrt(3)
    centre = np.array([x, y, z])
    choices = []
    for i in range(3):
        B = centre + arms[i]
        sine, radius = B[1] / p["l"], float(B @ _E[i])
        if abs(sine) > 1 + _ROUNDING:
            gap = abs(B[1]) - p["l"]
            raise AssemblyError(
                f"the pose is out of reach: joint B{i + 1} of the platform would be {abs(B[1]):.4g} m from the plane "
                f"of the slides, link {i + 1} reaches {p['l']:.4g} m: loop 'leg{i + 1}' stays open by {gap:.3g} m. "
                "Lower the platform or tilt it less",
                loop=f"leg{i + 1}",
                gap=gap,
            )
        up = asin(max(-1.0, min(1.0, sine)))
        choices.append([(angle, p["a"] - radius - p["l"] * cos(angle)) for angle in (up, pi - up)])
    names = ("x", "y", "z", "psi", "theta", "phi")
    pose = dict(zip(names, (float(x), y, z, psi, theta, phi), strict=True))
    found = []
    for legs in product(*choices):
        angles = {f"alpha{i}": float(leg[0]) for i, leg in enumerate(legs, 1)}
        slides = {f"s{i}": float(leg[1]) for i, leg in enumerate(legs, 1)}
        found.append({**pose, **angles, **slides})
    return found


#: Closed-form kinematics of the 3-PRS robot.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
