"""Closed-form kinematics of the 3-RPS robot: all platforms for given legs, the legs for a given pose.

Each joint B_i stays in the vertical plane of its leg, so (Lee and Shah, 1988), with R = Rz(phi) Ry(theta) Rx(psi):

    tan(phi) = sin(theta) sin(psi) / (cos(theta) + cos(psi)),   x = b (R_xx - R_yy)/2,   y = -b R_yx
"""

from __future__ import annotations

from collections.abc import Mapping
from math import atan2, cos, hypot, radians, sin, sqrt

import numpy as np

from nullbody.catalog.angle import angles_of, roll_pitch_yaw, turn
from nullbody.catalog.closed_form import ClosedForm
from nullbody.catalog.three_legs import ThreeLegs
from nullbody.errors import SingularityError
from nullbody.typing import FloatArray

__all__ = ["CLOSED_FORM"]

Values = Mapping[str, float]

_LEGS = ("s1", "s2", "s3")
_ROUNDING = 1e-12  # by which a platform upside down may seem not to be
_TURNS = [turn("z", radians(degrees)) for degrees in (0, 120, -120)]


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """All assemblies for s1, s2, s3, legs of positive length: the legs start at the distance a, in one plane."""
    if set(known) != set(_LEGS):
        return None
    s = [float(known[name]) for name in _LEGS]
    legs = ThreeLegs((p["a"],) * 3, (0.0, 0.0, 0.0), (s[0], s[1], s[2]), p["b"])
    return [_coordinates(p, legs.ends(angles), angles, s) for angles in legs.elevations()]


def _coordinates(p: Values, ends: FloatArray, angles: FloatArray, s: list[float]) -> dict[str, float]:
    """All coordinates from the joints' radii and heights: the platform stands on its three joints."""
    B = [R @ np.array([rho, 0.0, h]) for R, (rho, h) in zip(_TURNS, ends, strict=True)]
    centre = sum(B) / 3
    x_axis, y_axis = (B[0] - centre) / p["b"], (B[1] - B[2]) / (sqrt(3) * p["b"])
    R = np.column_stack([x_axis, y_axis, np.cross(x_axis, y_axis)])
    names = ["x", "y", "z", "psi", "theta", "phi", "alpha1", "alpha2", "alpha3", *_LEGS]
    values = [*centre, *angles_of(R), *angles, *s]
    return {name: float(value) for name, value in zip(names, values, strict=True)}


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """The assembly for the height z and the tilts psi, theta, with legs of positive length."""
    if set(pose) != {"z", "psi", "theta"}:
        return None
    z, psi, theta = (float(pose[name]) for name in ("z", "psi", "theta"))
    if hypot(sin(theta) * sin(psi), cos(theta) + cos(psi)) < _ROUNDING:
        raise SingularityError("the platform is upside down: psi and theta do not determine phi")
    phi = atan2(sin(theta) * sin(psi), cos(theta) + cos(psi))
    R = roll_pitch_yaw(psi, theta, phi)
    centre = np.array([p["b"] * (R[0, 0] - R[1, 1]) / 2, -p["b"] * R[1, 0], z])
    angles: dict[str, float] = {}
    lengths: dict[str, float] = {}
    for i, turned in enumerate(_TURNS, 1):
        rho, _, h = turned.T @ (centre + R @ turned @ np.array([p["b"], 0.0, 0.0]))
        angles[f"alpha{i}"], lengths[f"s{i}"] = atan2(h, p["a"] - rho), hypot(h, p["a"] - rho)
    x, y, _ = centre.tolist()
    return [{"x": x, "y": y, "z": z, "psi": psi, "theta": theta, "phi": phi, **angles, **lengths}]


#: Closed-form kinematics of the 3-RPS robot.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
