"""The platform of the 3-PRS robots, y up: its pose from its three joints, and the joints from three pose coordinates.

Each joint B_i stays in the vertical plane of its leg, through e_i. So x, z follow from the tilt, and of the three
angles one follows from the two others: sin(theta) (1 + cos(phi) cos(psi)) = -sin(phi) sin(psi).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import product
from math import asin, atan2, cos, sin, sqrt

import numpy as np

from nullbody.catalog.angle import angles_of, roll_pitch_yaw, roots
from nullbody.errors import AssemblyError, SingularityError
from nullbody.typing import FloatArray

__all__ = ["coordinates", "poses"]

Values = Mapping[str, float]
#: (leg 0..2, radius rho, height h of its joint) -> both (alpha, s) of the leg; raises AssemblyError out of reach.
LegSolver = Callable[[int, float, float], list[tuple[float, float]]]

_ROUNDING = 1e-12  # relative, by which three angles may seem not to determine each other
_E = np.array([[0, 0, 1], [sqrt(3) / 2, 0, -1 / 2], [-sqrt(3) / 2, 0, -1 / 2]])  # e_i
_POSE = ("x", "y", "z", "psi", "theta", "phi")


def coordinates(ends: FloatArray, b: float, angles: FloatArray, slides: list[float]) -> dict[str, float]:
    """All coordinates from the joints' radii and heights (rho_i, h_i): the platform stands on its three joints."""
    B = [rho * e + h * np.array([0, 1, 0]) for (rho, h), e in zip(ends, _E, strict=True)]
    centre = sum(B) / 3
    z_axis, x_axis = (B[0] - centre) / b, (B[1] - B[2]) / (sqrt(3) * b)
    R = np.column_stack([x_axis, np.cross(z_axis, x_axis), z_axis])
    names = [*_POSE, "alpha1", "alpha2", "alpha3", "s1", "s2", "s3"]
    values = [*centre, *angles_of(R), *angles, *slides]
    return {name: float(value) for name, value in zip(names, values, strict=True)}


def poses(b: float, pose: Values, solver: LegSolver) -> list[dict[str, float]] | None:
    """All assemblies for the height y and two of the angles psi, theta, phi; None for other coordinates.

    Raises:
        AssemblyError: a leg does not reach its joint.
        SingularityError: the two angles do not determine the third.
    """
    if "y" not in pose or not set(pose) <= {"y", "psi", "theta", "phi"} or len(pose) != 3:
        return None
    found: list[dict[str, float]] = []
    missed: AssemblyError | None = None
    for tilt in _tilts(pose):
        try:
            found += _legs(b, float(pose["y"]), tilt, solver)
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
    A, B = sin(theta) * cos(tilt), sin(tilt)
    if A * A + B * B < _ROUNDING**2:
        raise SingularityError(f"theta = 0 and {other} = 0 leave the third angle free: give psi and phi")
    turned = {atan2(sin(x), cos(x)) for x in roots(A, B, -sin(theta))}  # |(A, B)| is at least |sin(theta)|
    return [(tilt, theta, x) if other == "psi" else (x, theta, tilt) for x in sorted(turned, key=abs)]


def _legs(b: float, y: float, tilt: tuple[float, float, float], solver: LegSolver) -> list[dict[str, float]]:
    """Both elevations of every leg for a platform pose."""
    R = roll_pitch_yaw(*tilt)
    arms = [b * (R @ e) for e in _E]
    lateral = [np.cross([0, 1, 0], e) for e in _E]
    centre = np.array([-arms[0][0], y, float(lateral[1] @ arms[1] - lateral[2] @ arms[2]) / sqrt(3)])
    joints = [centre + arm for arm in arms]
    choices = [solver(i, float(B @ e), float(B[1])) for i, (B, e) in enumerate(zip(joints, _E, strict=True))]
    pose = dict(zip(_POSE, (float(centre[0]), y, float(centre[2]), *tilt), strict=True))
    found = []
    for legs in product(*choices):
        angles = {f"alpha{i}": float(alpha) for i, (alpha, _) in enumerate(legs, 1)}
        found.append({**pose, **angles, **{f"s{i}": float(s) for i, (_, s) in enumerate(legs, 1)}})
    return found
