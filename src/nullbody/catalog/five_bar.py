"""The planar five-bar robot (5R): two driven cranks carry a tool between their couplers.

    q = [x y phi | theta1 theta2 | gamma]

The frame has y up. Crank 1 turns about (0, 0) by theta1, crank 2 about (d, 0) by theta2, 0 along x. Coupler 1 hangs at
the tip of crank 1, turned by gamma against it. Coupler 2 has its origin in the tool at (x, y) and turns by phi: at
phi = 0 its elbow, the tip of crank 2, is on the left, towards -x.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import pi

from nullbody.catalog.five_bar_kinematics import forward
from nullbody.mechanism import GROUND, Actuator, Body, Mechanism, Parameter, Placement, Planar, Revolute, Spherical

__all__ = ["five_bar"]

_PARAMETERS = (
    Parameter("a1", 0.2, "m", "length of crank 1"),
    Parameter("b1", 0.3, "m", "length of coupler 1"),
    Parameter("a2", "a1", "m", "length of crank 2"),
    Parameter("b2", "b1", "m", "length of coupler 2"),
    Parameter("d", 0.25, "m", "distance between the pivots on the ground"),
    Parameter("ma1", 0.3, "kg", "mass of crank 1"),
    Parameter("mb1", 0.2, "kg", "mass of coupler 1"),
    Parameter("ma2", "ma1", "kg", "mass of crank 2"),
    Parameter("mb2", "mb1", "kg", "mass of coupler 2"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -y; 0 for a robot that lies flat", "any"),
    *(
        Parameter(f"I{bar}", f"m{bar}*{bar}^2/12", "kg m^2", f"moment of inertia of {name} about its centre")
        for bar, name in (("a1", "crank 1"), ("b1", "coupler 1"), ("a2", "crank 2"), ("b2", "coupler 2"))
    ),
)

_HOME = tuple(pi / 2 + pi * k / 36 for k in (4, 8, 12, 16, 0, -4, -8, -12, -16))  # of crank 1, the first that closes


def five_bar(**values: float) -> Mechanism:
    """The five-bar robot, inputs tau1, tau2 turn the cranks; the tool's x and y are the task.

    Loops, c and s of cosine and sine, gamma1 = theta1 + gamma:
    tool: a1 (c1, s1) + b1 (cos(gamma1), sin(gamma1)) - (x, y) = 0;
    elbow: (d, 0) + a2 (c2, s2) - (x, y) + b2 (cos(phi), sin(phi)) = 0.
    Two degrees of freedom. By default the robot is symmetric and its bars uniform thin rods.

    Home has the cranks spread by 20 degrees to either side of the vertical, or as near to that as the lengths allow,
    and the tool above.

    Source: X.-J. Liu, J. Wang, G. Pritschow, Mechanism and Machine Theory 41 (2006) 145-169.

    Args:
        values: parameters that differ from the defaults: a1, b1, a2, b2, d [m], ma1, mb1, ma2, mb2 [kg], g [m/s^2],
            Ia1, Ib1, Ia2, Ib2 [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    mechanism = Mechanism(
        name="five_bar",
        bodies=(_bar("coupler2", "b2", "-"), _bar("crank1", "a1"), _bar("crank2", "a2"), _bar("coupler1", "b1")),
        joints=(
            Planar("plane", GROUND, "coupler2", ("x", "y", "phi")),
            Revolute("shoulder1", GROUND, "crank1", ("theta1",)),
            Revolute("shoulder2", GROUND, "crank2", ("theta2",), Placement(("d", 0, 0))),
            Revolute("elbow1", "crank1", "coupler1", ("gamma",), Placement(("a1", 0, 0))),
        ),
        loops=(
            Spherical("tool", "coupler1", "coupler2", at=Placement(("b1", 0, 0))),
            Spherical("elbow2", "crank2", "coupler2", at=Placement(("a2", 0, 0)), on=Placement(("-b2", 0, 0))),
        ),
        actuators=(Actuator("tau1", "theta1"), Actuator("tau2", "theta2")),
        parameters=_PARAMETERS,
        gravity=(0, "-g", 0),
        end_effector="coupler2",
    ).with_parameters(**values)
    return replace(mechanism, home=_home(mechanism.values()))


def _bar(name: str, bar: str, sign: str = "") -> Body:
    """A thin rod along x, or -x, from its frame's origin."""
    return Body(name, f"m{bar}", (f"{sign}{bar}/2", 0, 0), (0, f"I{bar}", f"I{bar}"))


def _home(p: Mapping[str, float]) -> dict[str, float]:
    """Cranks spread alike, the tool above; if the couplers cannot meet, all bars up."""
    for angle in _HOME:
        found = forward(p, angle, pi - angle)
        if found:
            return found[0]
    return {"theta1": pi / 2, "theta2": pi / 2, "phi": pi / 2, "x": p["d"] / 2, "y": p["a1"] + p["b1"]}
