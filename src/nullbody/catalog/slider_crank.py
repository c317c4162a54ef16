"""The planar slider-crank: crank, rod, and a slider on a rail that may miss the shaft.

    q = [theta | beta | s]

The frame has y up. The crank turns about (0, 0) by theta, 0 along x; the rod hangs at its tip, turned by beta against
it; the slider is at (s, e), on a rail along x.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import pi

from nullbody.catalog.slider_crank_kinematics import forward
from nullbody.mechanism import GROUND, Actuator, Body, Mechanism, Parameter, Placement, Prismatic, Revolute, Spherical

__all__ = ["slider_crank"]

_PARAMETERS = (
    Parameter("r", 0.1, "m", "length of the crank"),
    Parameter("l", 0.35, "m", "length of the rod"),
    Parameter("e", 0.0, "m", "height of the rail above the shaft", "any"),
    Parameter("mc", 0.6, "kg", "mass of the crank"),
    Parameter("mr", 0.4, "kg", "mass of the rod"),
    Parameter("ms", 0.8, "kg", "mass of the slider"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -y", "any"),
    Parameter("Ic", "mc*r^2/12", "kg m^2", "crank's moment of inertia about its centre"),
    Parameter("Ir", "mr*l^2/12", "kg m^2", "rod's moment of inertia about its centre"),
)

_TRIES = tuple(pi / 3 + sign * pi * k / 180 for k in range(180) for sign in (1, -1))


def slider_crank(**values: float) -> Mechanism:
    """The slider-crank, input: a torque on the crank.

    Loop: r (cos(theta), sin(theta)) + l (cos(theta + beta), sin(theta + beta)) - (s, e) = 0. One degree of freedom; s
    does not determine the motion at its dead points, theta does all the way round if l > r + |e|. By default crank and
    rod are uniform thin rods.

    Home has the crank at 60 degrees, or as near to that as the lengths allow, and the slider on the right.

    Source: R. S. Hartenberg, J. Denavit, Kinematic Synthesis of Linkages (1964).

    Args:
        values: parameters that differ from the defaults: r, l, e [m], mc, mr, ms [kg], g [m/s^2], Ic, Ir [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    mechanism = Mechanism(
        name="slider_crank",
        bodies=(
            Body("crank", "mc", ("r/2", 0, 0), (0, "Ic", "Ic")),
            Body("rod", "mr", ("l/2", 0, 0), (0, "Ir", "Ir")),
            Body("slider", "ms"),
        ),
        joints=(
            Revolute("shaft", GROUND, "crank", ("theta",)),
            Revolute("crankpin", "crank", "rod", ("beta",), Placement(("r", 0, 0))),
            Prismatic("rail", GROUND, "slider", ("s",), Placement((0, "e", 0)), axis="x"),
        ),
        loops=(Spherical("wristpin", "rod", "slider", at=Placement(("l", 0, 0))),),
        actuators=(Actuator("torque", "theta"),),
        parameters=_PARAMETERS,
        gravity=(0, "-g", 0),
        end_effector="slider",
    ).with_parameters(**values)
    return replace(mechanism, home=_home(mechanism.values()))


def _home(p: Mapping[str, float]) -> dict[str, float]:
    """The crank as near to 60 degrees as the rod reaches the rail; straight up or down if it never does."""
    for theta in _TRIES:
        found = forward(p, theta)
        if found:
            return found[0]
    return {"theta": pi / 2 if p["e"] > 0 else -pi / 2}
