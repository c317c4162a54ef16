"""The spatial four-bar RSSR: a coupler on ball joints between a crank and a rocker whose axes are skew.

    q = [theta | alpha beta | psi]

The frame has y up. The crank turns by theta about the z axis: its pin is at (a cos(theta), a sin(theta), 0). The
rocker's frame is at (d, 0, 0), turned about x by the twist w; the rocker turns by psi about its z axis, its pin is at
(c cos(psi), c sin(psi), f) there. alpha and beta are azimuth and, negative, elevation of the coupler against the crank.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import pi

from nullbody.catalog.rssr_kinematics import forward
from nullbody.mechanism import (
    GROUND,
    Actuator,
    Body,
    Mechanism,
    Parameter,
    Placement,
    Revolute,
    Rotation,
    Spherical,
    Universal,
)

__all__ = ["rssr"]

_PARAMETERS = (
    Parameter("a", 0.1, "m", "length of the crank"),
    Parameter("b", 0.4, "m", "length of the coupler"),
    Parameter("c", 0.25, "m", "length of the rocker"),
    Parameter("d", 0.3, "m", "distance between the two axes, along x", "any"),
    Parameter("f", 0.1, "m", "the rocker's plane along its axis", "any"),
    Parameter("w", pi / 3, "rad", "twist of the rocker's axis against the crank's, about x", "any"),
    Parameter("ma", 0.3, "kg", "mass of the crank"),
    Parameter("mb", 0.5, "kg", "mass of the coupler"),
    Parameter("mc", 0.4, "kg", "mass of the rocker"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -y", "any"),
    Parameter("Ia", "ma*a^2/12", "kg m^2", "crank's moment of inertia across, about its centre"),
    Parameter("Ib", "mb*b^2/12", "kg m^2", "coupler's moment of inertia across, about its centre"),
    Parameter("Ic", "mc*c^2/12", "kg m^2", "rocker's moment of inertia across, about its centre"),
)

_TRIES = tuple(pi / 3 + sign * pi * k / 180 for k in range(180) for sign in (1, -1))


def rssr(**values: float) -> Mechanism:
    """The RSSR linkage, input: a torque on the crank.

    Loop: (a cos(theta), a sin(theta), 0) + b Rz(theta + alpha) Ry(beta) x - (d, 0, 0) - Rx(w) (c cos(psi), c sin(psi),
    f) = 0. With a ball joint at either end the coupler can spin about itself: mobility 2, one of them idle, and a thin
    rod has no inertia against it, so its acceleration would not be determined. Here the ball on the crank is a
    universal joint (RUSR), which leaves every other motion as it is: mobility 1, and the coupler keeps its mass. It is
    singular where the coupler is parallel to the crank's axis. By default all bars are uniform thin rods.

    Home has the crank at 60 degrees, or as near to that as the lengths allow, and the rocker's pin on the side to which
    psi grows. With the default lengths the crank turns all the way round.

    Source: R. S. Hartenberg, J. Denavit, Kinematic Synthesis of Linkages (1964), chapter 12.

    Args:
        values: parameters that differ from the defaults: a, b, c, d, f [m], w [rad], ma, mb, mc [kg], g [m/s^2],
            Ia, Ib, Ic [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    mechanism = Mechanism(
        name="rssr",
        bodies=tuple(
            Body(name, f"m{bar}", (f"{bar}/2", 0, 0), (0, f"I{bar}", f"I{bar}"))
            for name, bar in (("crank", "a"), ("coupler", "b"), ("rocker", "c"))
        ),
        joints=(
            Revolute("crank", GROUND, "crank", ("theta",)),
            Universal("knuckle", "crank", "coupler", ("alpha", "beta"), Placement(("a", 0, 0)), axis="z", axis2="y"),
            Revolute("rocker", GROUND, "rocker", ("psi",), Placement(("d", 0, 0), (Rotation("x", radians="w"),))),
        ),
        loops=(Spherical("ball", "coupler", "rocker", at=Placement(("b", 0, 0)), on=Placement(("c", 0, "f"))),),
        actuators=(Actuator("torque", "theta"),),
        parameters=_PARAMETERS,
        gravity=(0, "-g", 0),
        end_effector="rocker",
    ).with_parameters(**values)
    return replace(mechanism, home=_home(mechanism.values()))


def _home(p: Mapping[str, float]) -> dict[str, float]:
    """The crank as near to 60 degrees as coupler and rocker meet."""
    for theta in _TRIES:
        found = forward(p, theta)
        if found:
            return found[0]
    return {"theta": _TRIES[0], "psi": pi / 2}
