"""The spatial slider-crank: the crank's plane is across the rail, so the rod moves in all three directions.

    q = [theta | alpha beta | s]

The frame has z up. The crank turns by theta about the line through (0, ya, za) along x; its pin is straight above at
theta = 0. The slider runs along the x axis, s is its place. The rod is held by the slider in a universal joint and by
the crank's pin in a spherical one: alpha turns it about x, the slider's axis, and beta about the rod's own y axis; at
alpha = beta = 0 it points straight up from the slider.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import pi

from nullbody.catalog.spatial_slider_crank_kinematics import forward
from nullbody.mechanism import (
    GROUND,
    Actuator,
    Body,
    Mechanism,
    Parameter,
    Placement,
    Prismatic,
    Revolute,
    Spherical,
    Universal,
)

__all__ = ["spatial_slider_crank"]

_PARAMETERS = (
    Parameter("r", 0.08, "m", "length of the crank"),
    Parameter("l", 0.3, "m", "length of the rod"),
    Parameter("ya", 0.1, "m", "the crank's axis beside the rail, along y", "any"),
    Parameter("za", 0.12, "m", "the crank's axis above the rail", "any"),
    Parameter("rc", 0.0, "m", "centre of mass of the crank, from its axis towards the pin", "any"),
    Parameter("mc", 0.12, "kg", "mass of the crank"),
    Parameter("mr", 0.5, "kg", "mass of the rod, its centre in the middle"),
    Parameter("ms", 2.0, "kg", "mass of the slider"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -z", "any"),
    Parameter("Ic", 1e-4, "kg m^2", "crank's moment of inertia about x, through its centre of mass"),
    Parameter("Ir", 4e-3, "kg m^2", "rod's moment of inertia across"),
    Parameter("Ira", 4e-4, "kg m^2", "rod's moment of inertia about its axis", "non-negative"),
)

_TRIES = tuple(sign * pi * k / 180 for k in range(181) for sign in (1, -1))


def spatial_slider_crank(**values: float) -> Mechanism:
    """Haug's spatial slider-crank, input: a torque on the crank.

    Loop: (s, 0, 0) + l f(alpha, beta) - (0, ya - r sin(theta), za + r cos(theta)) = 0 with the rod's direction
    f = (sin(beta), -sin(alpha) cos(beta), cos(alpha) cos(beta)). One degree of freedom. With a spherical joint at both
    ends (RSSP) the rod could spin about itself, a second degree of freedom that moves nothing else; the universal joint
    holds that, so the rod's inertia about its axis counts. It is singular where the rod lies along the rail.

    Home has the crank at theta = 0, or as near to that as the lengths allow, and s > 0.

    Source: E. J. Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), section 12.2; the numbers
    are those of the benchmark "spatial rigid slider-crank mechanism" of the IFToMM library, which starts at theta = 0
    with theta' = 6 rad/s. There the crank's centre of mass is on its axis.

    Args:
        values: parameters that differ from the benchmark's: r, l, ya, za, rc [m], mc, mr, ms [kg], g [m/s^2], Ic, Ir,
            Ira [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    mechanism = Mechanism(
        name="spatial_slider_crank",
        bodies=(
            Body("crank", "mc", (0, 0, "rc"), ("Ic", "Ic/2", "Ic/2")),
            Body("rod", "mr", (0, 0, "l/2"), ("Ir", "Ir", "Ira")),
            Body("slider", "ms"),
        ),
        joints=(
            Revolute("shaft", GROUND, "crank", ("theta",), Placement((0, "ya", "za")), axis="x"),
            Universal("wrist", "slider", "rod", ("alpha", "beta"), axis="x", axis2="y"),
            Prismatic("rail", GROUND, "slider", ("s",), axis="x"),
        ),
        loops=(Spherical("crankpin", "rod", "crank", at=Placement((0, 0, "l")), on=Placement((0, 0, "r"))),),
        actuators=(Actuator("torque", "theta"),),
        parameters=_PARAMETERS,
        gravity=(0, 0, "-g"),
        end_effector="slider",
    ).with_parameters(**values)
    return replace(mechanism, home=_home(mechanism.values()))


def _home(p: Mapping[str, float]) -> dict[str, float]:
    """The crank as near to theta = 0 as the rod reaches the rail."""
    for theta in _TRIES:
        found = forward(p, theta)
        if found:
            return found[0]
    return {}
