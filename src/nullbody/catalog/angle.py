"""Angles in numbers, for the closed forms of the catalog: rotation matrices, and equations that one angle fulfils."""

from __future__ import annotations

from math import acos, atan2, cos, hypot, pi, sin

import numpy as np

from nullbody.mechanism.body import Axis
from nullbody.mechanism.joints.base import elementary_rotation
from nullbody.typing import FloatArray

__all__ = ["angles_of", "both_ways", "roll_pitch_yaw", "roots", "turn"]

_ROUNDING = 1e-12  # relative, by which a cosine may seem to be above one where both roots meet


def turn(axis: Axis, angle: float) -> FloatArray:
    """Rotation about an axis by an angle [rad]."""
    return np.array(elementary_rotation(axis, sin(angle), cos(angle)), dtype=float)


def roll_pitch_yaw(psi: float, theta: float, phi: float) -> FloatArray:
    """R = Rz(phi) Ry(theta) Rx(psi)."""
    found: FloatArray = turn("z", phi) @ turn("y", theta) @ turn("x", psi)
    return found


def angles_of(R: FloatArray) -> tuple[float, float, float]:
    """(psi, theta, phi) of R = Rz(phi) Ry(theta) Rx(psi), with |theta| <= 90 degrees."""
    return atan2(R[2, 1], R[2, 2]), atan2(-R[2, 0], hypot(R[0, 0], R[1, 0])), atan2(R[1, 0], R[0, 0])


def roots(A: float, B: float, C: float) -> list[float]:
    """Both angles x with A cos(x) + B sin(x) = C, or none: x = atan2(B, A) +- acos(C / |(A, B)|)."""
    size = hypot(A, B)
    if abs(C) > size * (1 + _ROUNDING) or size == 0:
        return []
    middle, half = atan2(B, A), acos(max(-1.0, min(1.0, C / size)))
    return [middle + half, middle - half]


def both_ways(found: list[dict[str, float]], first: str, second: str) -> list[dict[str, float]]:
    """Assemblies with a rod in a universal joint, and after them those with the rod turned over.

    Its direction is the same for (alpha + 180 degrees, 180 degrees - beta), the rod half a turn about itself.
    """
    over = [{**one, first: _wound(one[first] + pi), second: _wound(pi - one[second])} for one in found]
    return [*found, *over]


def _wound(angle: float) -> float:
    """The same angle within half a turn."""
    return atan2(sin(angle), cos(angle))
