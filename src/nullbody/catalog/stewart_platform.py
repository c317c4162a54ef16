"""The Stewart platform (Gough-Stewart, 6-UPS): six telescopic legs move a platform in all six ways.

    q = [x y z | psi theta phi | alpha1 beta1 .. alpha6 beta6 | s1 .. s6]

The frame has z up. The joints on the ground lie in pairs on a circle of radius a, at -+ga, 120 -+ ga and 240 -+ ga
degrees; those of the platform on one of radius b, at 60 -+ gb, 180 -+ gb and 300 -+ gb degrees in its own axes. Leg i
joins neighbours, so that the legs form six triangles; s_i is its length.

alpha_i and beta_i turn a leg from the vertical, about the radial line through the middle of its pair and then about
the axis across: its direction is (sin(beta), -sin(alpha) cos(beta), cos(alpha) cos(beta)) in the pair's axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import pi

from nullbody.catalog.stewart_platform_kinematics import legs
from nullbody.mechanism import (
    GROUND,
    Actuator,
    Body,
    Free,
    Mechanism,
    Parameter,
    Placement,
    Prismatic,
    Rotation,
    Spherical,
    Universal,
)
from nullbody.typing import Triple

__all__ = ["stewart_platform"]

_LEGS = (1, 2, 3, 4, 5, 6)
_GROUND_PAIRS = (0, 0, 120, 120, 240, 240)  # degrees of the pair's middle, leg by leg
_PLATFORM_PAIRS = (300, 60, 60, 180, 180, 300)

_PARAMETERS = (
    Parameter("a", 0.5, "m", "radius of the joints on the ground"),
    Parameter("b", 0.3, "m", "radius of the platform's joints"),
    Parameter("ga", pi / 12, "rad", "half the angle between the two joints of a pair on the ground", "any"),
    Parameter("gb", pi / 12, "rad", "half the angle between the two joints of a pair on the platform", "any"),
    Parameter("M", 10.0, "kg", "mass of the platform"),
    Parameter("mc", 1.5, "kg", "mass of each cylinder"),
    Parameter("mr", 0.8, "kg", "mass of each rod"),
    Parameter("lc", 0.4, "m", "length of the cylinders: the centre of mass is half of it from the ground's joint"),
    Parameter("lr", 0.4, "m", "length of the rods: the centre of mass is half of it from the platform's joint"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -z", "any"),
    Parameter("Ixx", "M*b^2/4", "kg m^2", "platform's moment of inertia about its x axis"),
    Parameter("Iyy", "M*b^2/4", "kg m^2", "platform's moment of inertia about its y axis"),
    Parameter("Izz", "M*b^2/2", "kg m^2", "platform's moment of inertia about its normal"),
    Parameter("Ic", "mc*lc^2/12", "kg m^2", "cylinder's moment of inertia across, about its centre", "non-negative"),
    Parameter("Ir", "mr*lr^2/12", "kg m^2", "rod's moment of inertia across, about its centre", "non-negative"),
)

_LIFT = 1.2  # height of the platform at home in radii a


def stewart_platform(**values: float) -> Mechanism:
    """The Stewart platform, inputs F1 .. F6 extend the legs.

    Loop i: A_i + s_i d(alpha_i, beta_i) - p - R B_i = 0 with p = (x, y, z) and R = Rz(phi) Ry(theta) Rx(psi). Six
    degrees of freedom. Roll-pitch-yaw angles are singular at theta = 90 degrees, which the legs do not reach. A leg is
    a cylinder in a universal joint and a rod that slides in it, two bodies; by default uniform thin bars, and the
    platform a uniform disc. Thin bars have no inertia about themselves; the universal joint holds them.

    Home has the platform level at the height 1.2 a.

    Source: V. E. Gough, S. G. Whitehall, Proc. 9th FISITA Congress (1962) 117-137; D. Stewart, Proc. Inst. Mech. Eng.
    180 (1965) 371-386.

    Args:
        values: parameters that differ from the defaults: a, b, lc, lr [m], ga, gb [rad], M, mc, mr [kg], g [m/s^2],
            Ixx, Iyy, Izz, Ic, Ir [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    platform = Body("platform", "M", (0, 0, 0), ("Ixx", "Iyy", "Izz"))
    cylinders = [Body(f"cylinder{i}", "mc", (0, 0, "lc/2"), ("Ic", "Ic", 0)) for i in _LEGS]
    rods = [Body(f"rod{i}", "mr", (0, 0, "-lr/2"), ("Ir", "Ir", 0)) for i in _LEGS]
    mechanism = Mechanism(
        name="stewart_platform",
        bodies=(platform, *cylinders, *rods),
        joints=(
            Free("platform", GROUND, "platform", ("x", "y", "z", "psi", "theta", "phi")),
            *(
                Universal(f"base{i}", GROUND, f"cylinder{i}", (f"alpha{i}", f"beta{i}"), _ground_joint(i), axis="x")
                for i in _LEGS
            ),
            *(Prismatic(f"slide{i}", f"cylinder{i}", f"rod{i}", (f"s{i}",), axis="z") for i in _LEGS),
        ),
        loops=tuple(Spherical(f"leg{i}", f"rod{i}", "platform", on=Placement(_platform_point(i))) for i in _LEGS),
        actuators=tuple(Actuator(f"F{i}", f"s{i}") for i in _LEGS),
        parameters=_PARAMETERS,
        gravity=(0, 0, "-g"),
        end_effector="platform",
    ).with_parameters(**values)
    return replace(mechanism, home=_home(mechanism.values()))


def _ground_joint(leg: int) -> Placement:
    """A_i, its x axis through the middle of the pair; legs 1, 3, 5 are at -ga, legs 2, 4, 6 at +ga."""
    middle, sign = _GROUND_PAIRS[leg - 1], "-" if leg % 2 else ""
    return Placement(_turned("a*cos(ga)", f"{sign}a*sin(ga)", middle), (Rotation("z", degrees=middle),))


def _platform_point(leg: int) -> Triple:
    """B_i in the platform's axes; legs 1, 3, 5 are at +gb, legs 2, 4, 6 at -gb."""
    return _turned("b*cos(gb)", f"{'' if leg % 2 else '-'}b*sin(gb)", _PLATFORM_PAIRS[leg - 1])


def _turned(x: str, y: str, degrees: int) -> Triple:
    """(x, y) turned about z by a multiple of 60 degrees, exactly."""
    c = {0: "1", 60: "1/2", 120: "-1/2", 180: "-1", 240: "-1/2", 300: "1/2"}[degrees]
    s = {0: "0", 60: "sqrt(3)/2", 120: "sqrt(3)/2", 180: "0", 240: "-sqrt(3)/2", 300: "-sqrt(3)/2"}[degrees]
    return (f"{c}*({x}) - {s}*({y})", f"{s}*({x}) + {c}*({y})", 0)


def _home(p: Mapping[str, float]) -> dict[str, float]:
    """The level platform."""
    return legs(p, {"x": 0.0, "y": 0.0, "z": _LIFT * p["a"], "psi": 0.0, "theta": 0.0, "phi": 0.0})
