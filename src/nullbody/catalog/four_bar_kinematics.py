"""Closed-form kinematics of the planar four-bar: where two bars meet, for the crank's angle or the rocker's."""

from __future__ import annotations

from collections.abc import Mapping
from math import atan2, cos, hypot, sin

from nullbody.catalog.closed_form import ClosedForm
from nullbody.catalog.dyad import dyad, meets
from nullbody.errors import AssemblyError

__all__ = ["CLOSED_FORM"]

Values = Mapping[str, float]
Point = tuple[float, float]


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """Both assemblies for the crank's angle, the upper one first, or for the rocker's."""
    if set(known) == {"theta1"}:
        tip, pivot = _tip(0.0, p["crank"], known["theta1"]), (p["base"], 0.0)
        return [_coordinates(p, tip, pin) for pin in _pins(tip, pivot, p["coupler"], p["rocker"])]
    return _from_rocker(p, known) if set(known) == {"theta3"} else None


def _from_rocker(p: Values, known: Values) -> list[dict[str, float]]:
    pin = _tip(p["base"], p["rocker"], known["theta3"])
    return [_coordinates(p, tip, pin) for tip in _pins((0.0, 0.0), pin, p["crank"], p["coupler"])]


def _tip(start: float, length: float, angle: float) -> Point:
    return start + length * cos(angle), length * sin(angle)


def _pins(a: Point, b: Point, ra: float, rb: float) -> list[Point]:
    """The points at the distance ra from a and rb from b, first that on the left of the way from a to b."""
    return [dyad(a, b, ra, rb), dyad(b, a, rb, ra)] if meets(a, b, ra, rb) else []


def _coordinates(p: Values, tip: Point, pin: Point) -> dict[str, float]:
    theta1 = atan2(tip[1], tip[0])
    theta2 = atan2(pin[1] - tip[1], pin[0] - tip[0]) - theta1
    return {"theta1": theta1, "theta2": atan2(sin(theta2), cos(theta2)), "theta3": atan2(pin[1], pin[0] - p["base"])}


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """Both assemblies for the rocker's angle."""
    if set(pose) != {"theta3"}:
        return None
    found = _from_rocker(p, pose)
    if found:
        return found
    distance = hypot(*_tip(p["base"], p["rocker"], pose["theta3"]))
    nearest, farthest = abs(p["crank"] - p["coupler"]), p["crank"] + p["coupler"]
    gap = max(nearest - distance, distance - farthest)
    raise AssemblyError(
        f"theta3 = {float(pose['theta3']):.4g} is out of reach: the rocker's pin would be {distance:.4g} m from the "
        f"crank's pivot, crank and coupler reach from {nearest:.4g} to {farthest:.4g} m: loop 'pin' stays open by "
        f"{gap:.3g} m",
        loop="pin",
        gap=gap,
    )


#: Closed-form kinematics of the planar four-bar.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
