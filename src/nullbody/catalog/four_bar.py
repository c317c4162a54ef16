"""The planar four-bar: crank, coupler and rocker on a base.

    q = [theta1 theta2 theta3]

The frame has y up. The crank turns about (0, 0) by theta1 and carries the coupler at its tip, turned by theta2 against
it; the rocker turns about (base, 0) by theta3. Angles are counter-clockwise, 0 along x.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import atan2, cos, pi, sin, sqrt

from nullbody.catalog.dyad import dyad, meets
from nullbody.catalog.start import Start
from nullbody.mechanism import GROUND, Actuator, Body, Mechanism, Parameter, Placement, Revolute, Spherical

__all__ = ["four_bar", "starts"]

_PARAMETERS = (
    Parameter("crank", 2.0, "m", "length of the crank"),
    Parameter("coupler", 8.0, "m", "length of the coupler"),
    Parameter("rocker", 5.0, "m", "length of the rocker"),
    Parameter("base", 10.0, "m", "distance between the pivots on the ground"),
    Parameter("m1", 2.0, "kg", "mass of the crank", "non-negative"),
    Parameter("m2", 8.0, "kg", "mass of the coupler", "non-negative"),
    Parameter("m3", 5.0, "kg", "mass of the rocker", "non-negative"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -y", "any"),
)

_ALMERIA = {"crank": 1.0, "coupler": 2.0, "rocker": sqrt(13), "base": 4.0, "m1": 1.0, "m2": 2.0, "m3": 4.0}
_ALMERIA_GRAVITY = 9.80665
_HOME = pi / 3  # crank angle
_STEPS = 180  # of the crank angle tried where bars of these lengths cannot meet at home


def four_bar(**values: float) -> Mechanism:
    """The four-bar with uniform bars, input: a torque on the crank.

    Loop: crank (c1, s1) + coupler (c12, s12) - (base, 0) - rocker (c3, s3) = 0 with c12 = cos(theta1 + theta2).

    Home has the crank at 60 degrees, or as near to that as the lengths allow, and the pin of coupler and rocker on the
    left of the way from the crank's tip to the rocker's pivot: the upper assembly.

    Source: the two models of the MBDE toolbox, Universities of A Coruna (default) and Almeria.

    Args:
        values: parameters that differ from those of A Coruna: crank, coupler, rocker, base [m], m1, m2, m3 [kg],
            g [m/s^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    mechanism = Mechanism(
        name="four_bar",
        bodies=(_bar("crank", "m1"), _bar("coupler", "m2"), _bar("rocker", "m3")),
        joints=(
            Revolute("crank", GROUND, "crank", ("theta1",)),
            Revolute("knee", "crank", "coupler", ("theta2",), Placement(("crank", 0, 0))),
            Revolute("rocker", GROUND, "rocker", ("theta3",), Placement(("base", 0, 0))),
        ),
        loops=(Spherical("pin", "coupler", "rocker", at=Placement(("coupler", 0, 0)), on=Placement(("rocker", 0, 0))),),
        actuators=(Actuator("torque", "theta1"),),
        parameters=_PARAMETERS,
        gravity=(0, "-g", 0),
        end_effector="coupler",
    ).with_parameters(**values)
    return replace(mechanism, home=_home(mechanism.values()))


def _bar(name: str, mass: str) -> Body:
    """A uniform thin bar along x from its first pin; the parameter of its length has its name."""
    moment = f"{mass}*{name}^2/12"
    return Body(name, mass, (f"{name}/2", 0, 0), (0, moment, moment))


def _home(p: Mapping[str, float]) -> dict[str, float]:
    """All angles at the crank angle nearest to 60 degrees at which coupler and rocker meet."""
    turns = (sign * pi * k / _STEPS for k in range(_STEPS) for sign in (1, -1))
    angles = (_HOME + turn for turn in turns)
    closed = (angle for angle in angles if meets(_tip(p, angle), (p["base"], 0.0), p["coupler"], p["rocker"]))
    return _angles(p, next(closed, _HOME))


def _tip(p: Mapping[str, float], theta1: float) -> tuple[float, float]:
    return p["crank"] * cos(theta1), p["crank"] * sin(theta1)


def _angles(p: Mapping[str, float], theta1: float) -> dict[str, float]:
    """theta1, theta2, theta3 of the upper assembly."""
    tip = _tip(p, theta1)
    x, y = dyad(tip, (p["base"], 0.0), p["coupler"], p["rocker"])
    return {"theta1": theta1, "theta2": atan2(y - tip[1], x - tip[0]) - theta1, "theta3": atan2(y, x - p["base"])}


def starts(**values: float) -> dict[str, Start]:
    """`ferrol`: at rest, crank at 60 degrees or as home has it; `almeria`: other bars, at rest, crank at 0."""
    ferrol, almeria = four_bar(**values), four_bar(**{**_ALMERIA, "g": _ALMERIA_GRAVITY, **values})
    return {
        "ferrol": Start(ferrol, duration=5.0, source="MBDE toolbox, University of A Coruna"),
        "almeria": Start(almeria, _angles(almeria.values(), 0.0), {}, 5.0, "MBDE toolbox, University of Almeria"),
    }
