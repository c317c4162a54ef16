"""Closed-form kinematics of the 3-PRS with vertical rails: all plates for given slides, all slides for a given pose."""

from __future__ import annotations

from collections.abc import Mapping
from math import acos, sin

from nullbody.catalog.closed_form import ClosedForm
from nullbody.catalog.three_legs import ThreeLegs
from nullbody.catalog.upright_platform import coordinates, poses
from nullbody.errors import AssemblyError

__all__ = ["CLOSED_FORM"]

Values = Mapping[str, float]

_SLIDES = ("s1", "s2", "s3")
_ROUNDING = 1e-12  # relative, by which a level link may seem too short


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """All assemblies for s1, s2, s3: the legs start at the distance a, at the heights s_i."""
    if set(known) != set(_SLIDES):
        return None
    s = [float(known[name]) for name in _SLIDES]
    legs = ThreeLegs((p["a"],) * 3, (s[0], s[1], s[2]), (p["l"],) * 3, p["b"])
    return [coordinates(legs.ends(angles), p["b"], angles, s) for angles in legs.elevations()]


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """All assemblies for the height y and two of the angles psi, theta, phi: two for each leg."""

    def leg(i: int, radius: float, height: float) -> list[tuple[float, float]]:
        """rho = a - l cos(alpha), h = s + l sin(alpha)"""
        cosine = (p["a"] - radius) / p["l"]
        if abs(cosine) > 1 + _ROUNDING:
            raise _out_of_reach(p, i + 1, abs(p["a"] - radius))
        up = acos(max(-1.0, min(1.0, cosine)))
        return [(angle, height - p["l"] * sin(angle)) for angle in (up, -up)]

    return poses(p["b"], pose, leg)


def _out_of_reach(p: Values, leg: int, distance: float) -> AssemblyError:
    gap = distance - p["l"]
    return AssemblyError(
        f"the pose is out of reach: joint B{leg} of the plate would be {distance:.4g} m from column {leg}, "
        f"link {leg} reaches {p['l']:.4g} m: loop 'leg{leg}' stays open by {gap:.3g} m. Tilt the plate less",
        loop=f"leg{leg}",
        gap=gap,
    )


#: Closed-form kinematics of the 3-PRS with vertical rails.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
