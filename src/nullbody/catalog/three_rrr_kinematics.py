"""Inverse kinematics of the planar 3-RRR robot: where two circles meet, leg by leg."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from math import atan2, cos, hypot, radians, sin

from nullbody.catalog.closed_form import ClosedForm
from nullbody.catalog.dyad import dyad, meets
from nullbody.errors import AssemblyError

__all__ = ["CLOSED_FORM", "cranks"]

Values = Mapping[str, float]
Point = tuple[float, float]

_POSE = ("x", "y", "phi")
_E = tuple(radians(degrees) for degrees in (-150, -30, 90))


def cranks(p: Values, pose: Values, sides: Sequence[int]) -> dict[str, float]:
    """All coordinates for a pose of the platform; sides: 1 for an elbow left of the way to the platform, -1 right."""
    thetas: dict[str, float] = {}
    gammas: dict[str, float] = {}
    for i, side in enumerate(sides, 1):
        pivot, joint = _ends(p, pose, i)
        to, back = (pivot, joint, p["l1"], p["l2"]), (joint, pivot, p["l2"], p["l1"])
        elbow = dyad(*(to if side > 0 else back))
        theta = atan2(elbow[1] - pivot[1], elbow[0] - pivot[0])
        gamma = atan2(joint[1] - elbow[1], joint[0] - elbow[0]) - theta
        thetas[f"theta{i}"], gammas[f"gamma{i}"] = theta, atan2(sin(gamma), cos(gamma))
    return {**{name: float(pose[name]) for name in _POSE}, **thetas, **gammas}


def _ends(p: Values, pose: Values, leg: int) -> tuple[Point, Point]:
    """The pivot of a leg on the ground and its joint on the platform."""
    angle = _E[leg - 1]
    turned = angle + pose["phi"]
    pivot = (p["a"] * cos(angle), p["a"] * sin(angle))
    return pivot, (pose["x"] + p["b"] * cos(turned), pose["y"] + p["b"] * sin(turned))


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """All eight assemblies for a pose of the platform."""
    if set(pose) != set(_POSE):
        return None
    for i in (1, 2, 3):
        pivot, joint = _ends(p, pose, i)
        if not meets(pivot, joint, p["l1"], p["l2"]):
            raise _out_of_reach(p, i, hypot(joint[0] - pivot[0], joint[1] - pivot[1]))
    return [cranks(p, pose, sides) for sides in product((-1, 1), repeat=3)]


def _out_of_reach(p: Values, leg: int, distance: float) -> AssemblyError:
    nearest, farthest = abs(p["l1"] - p["l2"]), p["l1"] + p["l2"]
    gap = max(nearest - distance, distance - farthest)
    return AssemblyError(
        f"the pose is out of reach: the platform's joint {leg} would be {distance:.4g} m from its pivot, crank and "
        f"coupler reach from {nearest:.4g} to {farthest:.4g} m: loop 'leg{leg}' stays open by {gap:.3g} m. Choose a "
        "pose within reach",
        loop=f"leg{leg}",
        gap=gap,
    )


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """Not known for the cranks: up to six poses, the roots of a polynomial that is not short."""
    return None


#: Closed-form kinematics of the planar 3-RRR robot.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
