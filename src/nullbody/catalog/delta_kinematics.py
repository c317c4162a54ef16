"""Closed-form kinematics of the delta robot, its platform not turned.

The platform's centre is lf away from three points, the elbows moved inwards by b:

    |p - E_i| = lf,   E_i = (a - b + la cos(alpha_i)) e_i - la sin(alpha_i) z

forward: where three spheres meet, twice at most; inverse: each arm fulfils A cos(alpha) + B sin(alpha) = C, twice at
most. Source: F. Pierrot, C. Reynaud, A. Fournier, Robotica 8 (1990) 105-109.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from math import atan2, cos, hypot, radians, sin, sqrt

import numpy as np

from nullbody.catalog.angle import roots, turn
from nullbody.catalog.closed_form import ClosedForm
from nullbody.errors import AssemblyError, SingularityError
from nullbody.typing import FloatArray

__all__ = ["CLOSED_FORM", "forward"]

Values = Mapping[str, float]

_ARMS = ("alpha1", "alpha2", "alpha3")
_TURNS = [turn("z", radians(degrees)) for degrees in (0, 120, -120)]
_FLAT = 1e-12  # relative size of a triangle of elbows whose three points are in one line


def forward(p: Values, arms: Sequence[float]) -> list[dict[str, float]]:
    """Both assemblies for the angles of the arms, the lower one first; none where the forearms are too short.

    Raises:
        SingularityError: the elbows, moved inwards by b, are in one line or one point.
    """
    E = [R @ _elbow(p, alpha) for R, alpha in zip(_TURNS, arms, strict=True)]
    first, second = E[1] - E[0], E[2] - E[0]
    normal = np.cross(first, second)
    size = float(normal @ normal)
    if size < _FLAT * max(p["lf"], p["la"]) ** 4:
        raise SingularityError("the elbows of the delta robot are in one line: its arms do not determine the platform")
    # the centre of the circle through the three points, and from there along the normal
    centre = np.cross(float(first @ first) * second - float(second @ second) * first, normal) / (2 * size)
    rest = p["lf"] ** 2 - float(centre @ centre)
    if rest < 0:
        return []
    up = normal / sqrt(size) * (1 if normal[2] > 0 else -1)
    return [_coordinates(p, E[0] + centre + side * sqrt(rest) * up, arms) for side in (-1, 1)]


def _elbow(p: Values, alpha: float) -> FloatArray:
    """E_i in the axes of its arm."""
    return np.array([p["a"] - p["b"] + p["la"] * cos(alpha), 0.0, -p["la"] * sin(alpha)])


def _coordinates(p: Values, position: FloatArray, arms: Sequence[float]) -> dict[str, float]:
    """All coordinates: f = (-sin(alpha + beta) cos(gamma), sin(gamma), -cos(alpha + beta) cos(gamma))."""
    pose = dict(zip(("x", "y", "z"), position.tolist(), strict=True)) | {"psi": 0.0, "theta": 0.0, "phi": 0.0}
    angles: dict[str, float] = {}
    for i, (R, alpha) in enumerate(zip(_TURNS, arms, strict=True), 1):
        u, w, n = (R.T @ position - _elbow(p, alpha)) / p["lf"]
        beta = atan2(-u, -n) - alpha
        angles[f"beta{i}"] = atan2(sin(beta), cos(beta))
        angles[f"gamma{i}"] = atan2(w, hypot(u, n))
    return {**pose, **dict(zip(_ARMS, (float(alpha) for alpha in arms), strict=True)), **angles}


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """Both assemblies for the angles of the arms."""
    return forward(p, [float(known[name]) for name in _ARMS]) if set(known) == set(_ARMS) else None


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """All assemblies for a position of the platform: each elbow outside or inside."""
    if set(pose) != {"x", "y", "z"}:
        return None
    position = np.array([float(pose[name]) for name in ("x", "y", "z")])
    choices = []
    for i, R in enumerate(_TURNS, 1):
        u, w, n = R.T @ position - np.array([p["a"] - p["b"], 0.0, 0.0])
        square = float(u * u + w * w + n * n)
        angles = roots(2 * p["la"] * u, -2 * p["la"] * n, square + p["la"] ** 2 - p["lf"] ** 2)
        if not angles:
            raise _out_of_reach(p, i, hypot(u, n), w)
        choices.append([atan2(sin(alpha), cos(alpha)) for alpha in angles])
    return [_coordinates(p, position, arms) for arms in product(*choices)]


def _out_of_reach(p: Values, leg: int, away: float, aside: float) -> AssemblyError:
    """The point that the forearm must reach is `away` from the arm's axis, in its plane, and `aside` of that plane."""
    farthest, nearest = hypot(p["la"] + away, aside), hypot(p["la"] - away, aside)
    gap = nearest - p["lf"] if nearest > p["lf"] else p["lf"] - farthest
    return AssemblyError(
        f"the position is out of reach: the elbow of arm {leg} would be {nearest:.4g} to {farthest:.4g} m from the "
        f"platform's joint, the forearm is {p['lf']:.4g} m long: loop 'leg{leg}' stays open by {gap:.3g} m. Move the "
        "platform nearer to the middle, or choose other lengths",
        loop=f"leg{leg}",
        gap=gap,
    )


#: Closed-form kinematics of the delta robot.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
