"""Closed-form kinematics of the 3-PRS robot: all assemblies for given slides, all slides for a given pose."""

from __future__ import annotations

from collections.abc import Mapping
from math import asin, cos, pi

from nullbody.catalog.closed_form import ClosedForm
from nullbody.catalog.three_legs import ThreeLegs
from nullbody.catalog.upright_platform import coordinates, poses
from nullbody.errors import AssemblyError

__all__ = ["CLOSED_FORM"]

Values = Mapping[str, float]

_SLIDES = ("s1", "s2", "s3")
_ROUNDING = 1e-12  # relative, by which a vertical link may seem too short


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """All assemblies for s1, s2, s3: the legs start at the distance a - s_i, in one plane."""
    if set(known) != set(_SLIDES):
        return None
    s = [float(known[name]) for name in _SLIDES]
    legs = ThreeLegs((p["a"] - s[0], p["a"] - s[1], p["a"] - s[2]), (0.0, 0.0, 0.0), (p["l"],) * 3, p["b"])
    return [coordinates(legs.ends(angles), p["b"], angles, s) for angles in legs.elevations()]


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """All assemblies for the height y and two of the angles psi, theta, phi: two for each leg."""

    def leg(i: int, radius: float, height: float) -> list[tuple[float, float]]:
        """h = l sin(alpha), rho = a - s - l cos(alpha)"""
        sine = height / p["l"]
        if abs(sine) > 1 + _ROUNDING:
            raise _out_of_reach(p, i + 1, abs(height))
        up = asin(max(-1.0, min(1.0, sine)))
        return [(angle, p["a"] - radius - p["l"] * cos(angle)) for angle in (up, pi - up)]

    return poses(p["b"], pose, leg)


def _out_of_reach(p: Values, leg: int, distance: float) -> AssemblyError:
    gap = distance - p["l"]
    return AssemblyError(
        f"the pose is out of reach: joint B{leg} of the platform would be {distance:.4g} m from the plane "
        f"of the slides, link {leg} reaches {p['l']:.4g} m: loop 'leg{leg}' stays open by {gap:.3g} m. "
        "Lower the platform or tilt it less",
        loop=f"leg{leg}",
        gap=gap,
    )


#: Closed-form kinematics of the 3-PRS robot.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
