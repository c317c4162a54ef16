"""Closed-form kinematics of the five-bar robot: where two circles meet, once for the tool or twice for the elbows."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from math import atan2, cos, hypot, sin

from nullbody.catalog.closed_form import ClosedForm
from nullbody.catalog.dyad import dyad, meets
from nullbody.errors import AssemblyError

__all__ = ["CLOSED_FORM", "forward"]

Values = Mapping[str, float]
Point = tuple[float, float]


def forward(p: Values, theta1: float, theta2: float) -> list[dict[str, float]]:
    """Both assemblies for the angles of the cranks, first that with the tool left of the way from elbow to elbow."""
    elbow1 = (p["a1"] * cos(theta1), p["a1"] * sin(theta1))
    elbow2 = (p["d"] + p["a2"] * cos(theta2), p["a2"] * sin(theta2))
    if not meets(elbow1, elbow2, p["b1"], p["b2"]):
        return []
    tools = dyad(elbow1, elbow2, p["b1"], p["b2"]), dyad(elbow2, elbow1, p["b2"], p["b1"])
    return [_coordinates(p, tool, theta1, theta2) for tool in tools]


def _coordinates(p: Values, tool: Point, theta1: float, theta2: float) -> dict[str, float]:
    x, y = tool
    gamma = atan2(y - p["a1"] * sin(theta1), x - p["a1"] * cos(theta1)) - theta1
    phi = atan2(y - p["a2"] * sin(theta2), x - p["d"] - p["a2"] * cos(theta2))
    wound = atan2(sin(gamma), cos(gamma))
    return {"x": x, "y": y, "phi": phi, "theta1": float(theta1), "theta2": float(theta2), "gamma": wound}


def _assemblies(p: Values, known: Values) -> list[dict[str, float]] | None:
    """Both assemblies for the angles of the cranks."""
    return forward(p, known["theta1"], known["theta2"]) if set(known) == {"theta1", "theta2"} else None


def _inverse(p: Values, pose: Values) -> list[dict[str, float]] | None:
    """All assemblies for a position of the tool: each elbow on either side."""
    if set(pose) != {"x", "y"}:
        return None
    tool = (float(pose["x"]), float(pose["y"]))
    choices = []
    for i, start in ((1, 0.0), (2, p["d"])):
        pivot, crank, coupler = (start, 0.0), p[f"a{i}"], p[f"b{i}"]
        if not meets(pivot, tool, crank, coupler):
            raise _out_of_reach(i, hypot(tool[0] - start, tool[1]), crank, coupler)
        elbows = dyad(pivot, tool, crank, coupler), dyad(tool, pivot, coupler, crank)
        choices.append([atan2(y, x - start) for x, y in elbows])
    return [_coordinates(p, tool, *cranks) for cranks in product(*choices)]


def _out_of_reach(side: int, distance: float, crank: float, coupler: float) -> AssemblyError:
    nearest, farthest = abs(crank - coupler), crank + coupler
    gap = max(nearest - distance, distance - farthest)
    return AssemblyError(
        f"the position is out of reach: the tool would be {distance:.4g} m from pivot {side}, crank and coupler reach "
        f"from {nearest:.4g} to {farthest:.4g} m: the loops stay open by {gap:.3g} m. Choose a position within reach",
        loop="tool" if side == 1 else "elbow2",
        gap=gap,
    )


#: Closed-form kinematics of the five-bar robot.
CLOSED_FORM = ClosedForm(_assemblies, _inverse)
