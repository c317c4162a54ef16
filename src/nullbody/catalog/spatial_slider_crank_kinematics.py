"""Closed-form kinematics of the spatial slider-crank, either way.

    s^2 = l^2 - (ya - r sin(theta))^2 - (za + r cos(theta))^2

Source: E. J. Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 12.2.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import atan2, cos, hypot, sin, sqrt

from nullbody.catalog.angle import both_ways, roots
from nullbody.catalog.closed_form import ClosedForm
from nullbody.errors import AssemblyError

__all__ = ["CLOSED_FORM", "forward"]

Values = Mapping[str, float]


def forward(p: Values, theta: float) -> list[dict[str, float]]:
    """Both assemblies for the crank's angle, that with s > 0 first."""
    y, z = p["ya"] - p["r"] * sin(theta), p["za"] + p["r"] * cos(theta)
    square = p["l"] ** 2 - y * y - z * z
    if square < 0:
        return []
    return [_coordinates(theta, side * sqrt(square), y, z) for side in (1, -1)]


def _coordinates(theta: float, s: float, y: float, z: float) -> dict[str, float]:
    """The rod's direction times its length is (-s, y, z); of its two pairs of angles that with |beta| <= 90 degrees."""
    return {"theta": float(theta), "alpha": atan2(-y, z), "beta": atan2(-s, hypot(y, z)), "s": float(s)}


def _from_slider(p: Values, s: float) -> list[dict[str, float]]:
    """Both assemblies for the slider's place."""
    r, y, z = p["r"], p["ya"], p["za"]
    angles = roots(2 * r * z, -2 * r * y, p["l"] ** 2 - s * s - r * r - y * y - z * z)
    wound = [atan2(sin(theta), cos(theta)) for theta in angles]
    return [_coordinates(theta, s, y - r * sin(theta), z + r * cos(theta)) for theta in wound]


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """Both assemblies for the crank's angle, or for the slider's place, each with the rod either way round."""
    if set(known) == {"theta"}:
        return both_ways(forward(p, float(known["theta"])), "alpha", "beta")
    return both_ways(_from_slider(p, float(known["s"])), "alpha", "beta") if set(known) == {"s"} else None


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """Both assemblies for the slider's place, each with the rod either way round."""
    found = _assemblies(p, pose) if set(pose) == {"s"} else None
    if found != []:
        return found
    s = float(pose["s"])
    aside = hypot(p["ya"], p["za"])
    nearest, farthest = hypot(s, aside - p["r"]), hypot(s, aside + p["r"])
    gap = max(nearest - p["l"], p["l"] - farthest)
    raise AssemblyError(
        f"s = {s:.4g} is out of reach: the crank's pin would be {nearest:.4g} to {farthest:.4g} m from the slider, the "
        f"rod is {p['l']:.4g} m long: loop 'crankpin' stays open by {gap:.3g} m",
        loop="crankpin",
        gap=gap,
    )


#: Closed-form kinematics of the spatial slider-crank.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
