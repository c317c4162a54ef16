"""Closed-form kinematics of the planar slider-crank, either way."""

from __future__ import annotations

from collections.abc import Mapping
from math import atan2, cos, hypot, sin, sqrt

from nullbody.catalog.angle import roots
from nullbody.catalog.closed_form import ClosedForm
from nullbody.errors import AssemblyError

__all__ = ["CLOSED_FORM", "forward"]

Values = Mapping[str, float]


def forward(p: Values, theta: float) -> list[dict[str, float]]:
    """Both assemblies for the crank's angle, that on the right first: s = r cos(theta) +- sqrt(l^2 - (e - r sin)^2)."""
    x, rise = p["r"] * cos(theta), p["e"] - p["r"] * sin(theta)
    square = p["l"] ** 2 - rise**2
    if square < 0:
        return []
    return [_coordinates(p, theta, x + side * sqrt(square)) for side in (1, -1)]


def _coordinates(p: Values, theta: float, s: float) -> dict[str, float]:
    beta = atan2(p["e"] - p["r"] * sin(theta), s - p["r"] * cos(theta)) - theta
    return {"theta": float(theta), "beta": atan2(sin(beta), cos(beta)), "s": float(s)}


def _from_slider(p: Values, s: float) -> list[dict[str, float]]:
    """Both assemblies for the slider's place: 2 r (s cos(theta) + e sin(theta)) = s^2 + e^2 + r^2 - l^2."""
    r, l, e = p["r"], p["l"], p["e"]  # noqa: E741 - the name of the length
    angles = roots(2 * r * s, 2 * r * e, s * s + e * e + r * r - l * l)
    return [_coordinates(p, atan2(sin(theta), cos(theta)), s) for theta in angles]


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """Both assemblies for the crank's angle, or for the slider's place."""
    if set(known) == {"theta"}:
        return forward(p, float(known["theta"]))
    return _from_slider(p, float(known["s"])) if set(known) == {"s"} else None


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """Both assemblies for the slider's place."""
    if set(pose) != {"s"}:
        return None
    s = float(pose["s"])
    found = _from_slider(p, s)
    if found:
        return found
    distance, nearest, farthest = hypot(s, p["e"]), abs(p["l"] - p["r"]), p["l"] + p["r"]
    gap = max(nearest - distance, distance - farthest)
    raise AssemblyError(
        f"s = {s:.4g} is out of reach: the slider would be {distance:.4g} m from the shaft, crank and rod reach from "
        f"{nearest:.4g} to {farthest:.4g} m: loop 'wristpin' stays open by {gap:.3g} m",
        loop="wristpin",
        gap=gap,
    )


#: Closed-form kinematics of the planar slider-crank.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
