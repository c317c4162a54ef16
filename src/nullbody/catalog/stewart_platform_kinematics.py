"""Inverse kinematics of the Stewart platform: s_i d_i = p + R B_i - A_i, leg by leg."""

from __future__ import annotations

from collections.abc import Mapping
from math import atan2, cos, hypot, radians, sin, sqrt

import numpy as np

from nullbody.catalog.angle import roll_pitch_yaw, turn
from nullbody.catalog.closed_form import ClosedForm
from nullbody.typing import FloatArray

__all__ = ["CLOSED_FORM", "legs"]

Values = Mapping[str, float]

_POSE = ("x", "y", "z", "psi", "theta", "phi")
_GROUND_PAIRS = (0, 0, 120, 120, 240, 240)
_PLATFORM_PAIRS = (300, 60, 60, 180, 180, 300)


def legs(p: Values, pose: Values) -> dict[str, float]:
    """All coordinates for a pose of the platform, legs of positive length, with |beta| <= 90 degrees.

    d = (sin(beta), -sin(alpha) cos(beta), cos(alpha) cos(beta)) in the axes of the pair on the ground.
    """
    position = np.array([pose[name] for name in _POSE[:3]])
    R = roll_pitch_yaw(*(pose[name] for name in _POSE[3:]))
    angles: dict[str, float] = {}
    lengths: dict[str, float] = {}
    for i, (ground, platform) in enumerate(zip(_GROUND_PAIRS, _PLATFORM_PAIRS, strict=True), 1):
        side = -1 if i % 2 else 1
        pair = turn("z", radians(ground))
        A = pair @ _on_circle(p["a"], side * p["ga"])
        B = turn("z", radians(platform)) @ _on_circle(p["b"], -side * p["gb"])
        u, w, n = pair.T @ (position + R @ B - A)
        angles[f"alpha{i}"], angles[f"beta{i}"] = atan2(-w, n), atan2(u, hypot(w, n))
        lengths[f"s{i}"] = sqrt(u * u + w * w + n * n)
    return {**{name: float(pose[name]) for name in _POSE}, **angles, **lengths}


def _on_circle(radius: float, angle: float) -> FloatArray:
    return radius * np.array([cos(angle), sin(angle), 0.0])


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """The one assembly for a pose of the platform; each leg could also be turned over, with alpha + 180 degrees."""
    return [legs(p, pose)] if set(pose) == set(_POSE) else None


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """Not known for leg lengths: up to 40 poses, the roots of a polynomial that is not short."""
    return None


#: Closed-form kinematics of the Stewart platform.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
