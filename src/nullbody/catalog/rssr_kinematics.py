"""Closed-form kinematics of the RSSR linkage: either angle from the other one.

The rocker's pin is (d + c cos(psi), Y, Z) with (Y, Z) = Rx(w) (c sin(psi), f). Its distance from the crank's pin is b:

    b^2 = (d + c cos(psi) - a cos(theta))^2 + (c cos(w) sin(psi) - f sin(w) - a sin(theta))^2
          + (c sin(w) sin(psi) + f cos(w))^2

which is A cos(x) + B sin(x) = C in either angle x, for the other one given. Source: R. S. Hartenberg, J. Denavit,
Kinematic Synthesis of Linkages (1964), chapter 12.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import atan2, cos, hypot, sin

import numpy as np

from nullbody.catalog.angle import both_ways, roots, turn
from nullbody.catalog.closed_form import ClosedForm
from nullbody.errors import AssemblyError
from nullbody.typing import FloatArray

__all__ = ["CLOSED_FORM", "forward"]

Values = Mapping[str, float]


def forward(p: Values, theta: float) -> list[dict[str, float]]:
    """Both assemblies for the crank's angle."""
    x = p["d"] - p["a"] * cos(theta)
    y = -p["f"] * sin(p["w"]) - p["a"] * sin(theta)
    z = p["f"] * cos(p["w"])
    across = 2 * p["c"] * (y * cos(p["w"]) + z * sin(p["w"]))
    angles = roots(2 * p["c"] * x, across, p["b"] ** 2 - p["c"] ** 2 - x * x - y * y - z * z)
    return [_coordinates(p, theta, psi) for psi in angles]


def _backward(p: Values, psi: float) -> list[dict[str, float]]:
    """Both assemblies for the rocker's angle."""
    x, y, z = _rocker_pin(p, psi)
    angles = roots(2 * p["a"] * x, 2 * p["a"] * y, p["a"] ** 2 + x * x + y * y + z * z - p["b"] ** 2)
    return [_coordinates(p, theta, psi) for theta in angles]


def _rocker_pin(p: Values, psi: float) -> FloatArray:
    local = np.array([p["c"] * cos(psi), p["c"] * sin(psi), p["f"]])
    found: FloatArray = np.array([p["d"], 0, 0]) + turn("x", p["w"]) @ local
    return found


def _coordinates(p: Values, theta: float, psi: float) -> dict[str, float]:
    """The coupler is b (cos(alpha) cos(beta), sin(alpha) cos(beta), -sin(beta)) in the crank's axes, |beta| <= pi/2."""
    x, y, z = turn("z", -theta) @ _rocker_pin(p, psi) - np.array([p["a"], 0, 0])
    wound = {name: atan2(sin(angle), cos(angle)) for name, angle in (("theta", theta), ("psi", psi))}
    return {"theta": wound["theta"], "alpha": atan2(y, x), "beta": atan2(-z, hypot(x, y)), "psi": wound["psi"]}


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """Both assemblies for the crank's angle, or for the rocker's, each with the coupler either way round."""
    if set(known) == {"theta"}:
        return both_ways(forward(p, float(known["theta"])), "alpha", "beta")
    return both_ways(_backward(p, float(known["psi"])), "alpha", "beta") if set(known) == {"psi"} else None


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """Both assemblies for the rocker's angle, each with the coupler either way round."""
    found = _assemblies(p, pose) if set(pose) == {"psi"} else None
    if found != []:
        return found
    x, y, z = _rocker_pin(p, float(pose["psi"]))
    nearest, farthest = hypot(hypot(x, y) - p["a"], z), hypot(hypot(x, y) + p["a"], z)
    gap = max(nearest - p["b"], p["b"] - farthest)
    raise AssemblyError(
        f"psi = {float(pose['psi']):.4g} is out of reach: the rocker's pin would be {nearest:.4g} to {farthest:.4g} m "
        f"from the crank's, the coupler is {p['b']:.4g} m long: loop 'ball' stays open by {gap:.3g} m",
        loop="ball",
        gap=gap,
    )


#: Closed-form kinematics of the RSSR linkage.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
