"""The 3-RPS parallel robot: three telescopic legs, hinged on the ground, carry a platform on spherical joints.

    q = [x y z | psi theta phi | alpha1 alpha2 alpha3 | s1 s2 s3]

The frame has z up. Hinge i is at a e_i with e_i the x axis turned by 0, 120 and -120 degrees about z; leg i swings in
the vertical plane through e_i. alpha_i is its elevation: 0 points inwards, 90 degrees up. s_i is its length.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import atan2, hypot

from nullbody.mechanism import (
    GROUND,
    Actuator,
    Body,
    Free,
    Mechanism,
    Parameter,
    Placement,
    Prismatic,
    Revolute,
    Rotation,
    Spherical,
)
from nullbody.typing import Triple

__all__ = ["three_rps"]

_LEGS = (1, 2, 3)
_HINGES = (
    Placement(("a", 0, 0)),
    Placement(("-a/2", "sqrt(3)/2*a", 0), (Rotation("z", degrees=120),)),
    Placement(("-a/2", "-sqrt(3)/2*a", 0), (Rotation("z", degrees=-120),)),
)
_PLATFORM_POINTS: tuple[Triple, ...] = (("b", 0, 0), ("-b/2", "sqrt(3)/2*b", 0), ("-b/2", "-sqrt(3)/2*b", 0))  # b e_i

_PARAMETERS = (
    Parameter("a", 0.3, "m", "radius of the hinges on the ground"),
    Parameter("b", 0.2, "m", "radius of the platform's joints"),
    Parameter("M", 2.0, "kg", "mass of the platform"),
    Parameter("mc", 0.5, "kg", "mass of each cylinder"),
    Parameter("mr", 0.3, "kg", "mass of each rod"),
    Parameter("lc", 0.3, "m", "length of the cylinders: the centre of mass is half of it from the hinge"),
    Parameter("lr", 0.3, "m", "length of the rods: the centre of mass is half of it from the platform's joint"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -z", "any"),
    Parameter("Ixx", "M*b^2/4", "kg m^2", "platform's moment of inertia about its x axis"),
    Parameter("Iyy", "M*b^2/4", "kg m^2", "platform's moment of inertia about its y axis"),
    Parameter("Izz", "M*b^2/2", "kg m^2", "platform's moment of inertia about its normal"),
    Parameter("Ic", "mc*lc^2/12", "kg m^2", "cylinder's moment of inertia across, about its centre", "non-negative"),
    Parameter("Ir", "mr*lr^2/12", "kg m^2", "rod's moment of inertia across, about its centre", "non-negative"),
)

_LEAN = 1.5  # height of the platform at home in radii a


def three_rps(**values: float) -> Mechanism:
    """The 3-RPS robot, inputs F1, F2, F3 extend the legs.

    Loop i: a e_i + s_i (sin(alpha_i) z - cos(alpha_i) e_i) - p - R b e_i = 0 with p = (x, y, z) and
    R = Rz(phi) Ry(theta) Rx(psi). Three degrees of freedom: height z and the tilts psi, theta; x, y and phi follow.
    Roll-pitch-yaw angles are singular where the platform stands upright, theta = 90 degrees. Cylinder and rod are two
    bodies, uniform thin bars by default, the platform a uniform disc.

    Home has the platform level at the height 1.5 a.

    Source: K.-M. Lee, D. K. Shah, IEEE J. Robotics Automation 4 (1988) 354-360.

    Args:
        values: parameters that differ from the defaults: a, b, lc, lr [m], M, mc, mr [kg], g [m/s^2], Ixx, Iyy, Izz,
            Ic, Ir [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    platform = Body("platform", "M", (0, 0, 0), ("Ixx", "Iyy", "Izz"))
    cylinders = [Body(f"cylinder{i}", "mc", ("-lc/2", 0, 0), (0, "Ic", "Ic")) for i in _LEGS]
    rods = [Body(f"rod{i}", "mr", ("lr/2", 0, 0), (0, "Ir", "Ir")) for i in _LEGS]
    mechanism = Mechanism(
        name="three_rps",
        bodies=(platform, *cylinders, *rods),
        joints=(
            Free("platform", GROUND, "platform", ("x", "y", "z", "psi", "theta", "phi")),
            *(
                Revolute(f"hinge{i}", GROUND, f"cylinder{i}", (f"alpha{i}",), hinge, axis="y")
                for i, hinge in zip(_LEGS, _HINGES, strict=True)
            ),
            *(Prismatic(f"slide{i}", f"cylinder{i}", f"rod{i}", (f"s{i}",), axis="-x") for i in _LEGS),
        ),
        loops=tuple(
            Spherical(f"leg{i}", f"rod{i}", "platform", on=Placement(point))
            for i, point in zip(_LEGS, _PLATFORM_POINTS, strict=True)
        ),
        actuators=tuple(Actuator(f"F{i}", f"s{i}") for i in _LEGS),
        parameters=_PARAMETERS,
        gravity=(0, 0, "-g"),
        end_effector="platform",
    ).with_parameters(**values)
    return replace(mechanism, home=_home(mechanism.values()))


def _home(p: Mapping[str, float]) -> dict[str, float]:
    """The level platform."""
    height, inwards = _LEAN * p["a"], p["a"] - p["b"]
    angles = {f"alpha{i}": atan2(height, inwards) for i in _LEGS}
    return {"z": height} | angles | {f"s{i}": hypot(height, inwards) for i in _LEGS}
