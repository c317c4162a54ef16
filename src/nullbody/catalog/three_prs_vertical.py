"""The 3-PRS with vertical rails: three columns at 120 degrees whose sliders tilt and lift one plate.

    q = [x y z | psi theta phi | alpha1 alpha2 alpha3 | s1 s2 s3]

The frame has y up, as that of `three_prs`. Column i stands at a e_i with e_i the z axis turned by 0, 120 and -120
degrees about y; s_i is the height of its slider. alpha_i is the link's elevation: 0 points inwards, 90 degrees up.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import acos, sin

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

__all__ = ["three_prs_vertical"]

_LEGS = (1, 2, 3)
_COLUMNS = (
    Placement((0, 0, "a")),
    Placement(("sqrt(3)/2*a", 0, "-a/2"), (Rotation("y", degrees=120),)),
    Placement(("-sqrt(3)/2*a", 0, "-a/2"), (Rotation("y", degrees=-120),)),
)
_PLATE_POINTS: tuple[Triple, ...] = ((0, 0, "b"), ("sqrt(3)/2*b", 0, "-b/2"), ("-sqrt(3)/2*b", 0, "-b/2"))  # b e_i

_PARAMETERS = (
    Parameter("a", 0.35, "m", "distance of the columns from the centre"),
    Parameter("b", 0.2, "m", "radius of the plate's joints"),
    Parameter("l", 0.3, "m", "length of the links"),
    Parameter("M", 2.0, "kg", "mass of the plate"),
    Parameter("m", 0.2, "kg", "mass of each link"),
    Parameter("ms", 0.4, "kg", "mass of each slider", "non-negative"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -y", "any"),
    Parameter("Ixx", "M*b^2/4", "kg m^2", "plate's moment of inertia about its x axis"),
    Parameter("Iyy", "M*b^2/2", "kg m^2", "plate's moment of inertia about its normal"),
    Parameter("Izz", "M*b^2/4", "kg m^2", "plate's moment of inertia about its z axis"),
    Parameter("Il", "m*l^2/12", "kg m^2", "link's moment of inertia across, about its centre", "non-negative"),
)


def three_prs_vertical(**values: float) -> Mechanism:
    """The 3-PRS robot on three vertical columns, inputs F1, F2, F3 lift the sliders.

    Loop i: a e_i + s_i y + l (sin(alpha_i) y - cos(alpha_i) e_i) - p - R b e_i = 0 with p = (x, y, z) and
    R = Rz(phi) Ry(theta) Rx(psi). Three degrees of freedom: height y and two tilts, say psi and phi; x, z and theta
    follow. Roll-pitch-yaw angles are singular where the plate is turned by 90 degrees about the vertical, far from
    where its joints can be. By default links are uniform thin rods, the plate a uniform disc, sliders point masses.

    Home has the plate level above the sliders, which stand at s = l.

    Source: J. A. Carretero, R. P. Podhorodeski, M. A. Nahon, C. M. Gosselin, J. Mech. Design 122 (2000) 17-24, where
    the rails have any inclination.

    Args:
        values: parameters that differ from the defaults: a, b, l [m], M, m, ms [kg], g [m/s^2], Ixx, Iyy, Izz, Il
            [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    plate = Body("plate", "M", (0, 0, 0), ("Ixx", "Iyy", "Izz"))
    links = [Body(f"link{i}", "m", (0, 0, "-l/2"), ("Il", "Il", 0)) for i in _LEGS]
    sliders = [Body(f"slider{i}", "ms") for i in _LEGS]
    mechanism = Mechanism(
        name="three_prs_vertical",
        bodies=(plate, *links, *sliders),
        joints=(
            Free("plate", GROUND, "plate", ("x", "y", "z", "psi", "theta", "phi")),
            *(Revolute(f"hinge{i}", f"slider{i}", f"link{i}", (f"alpha{i}",), axis="x") for i in _LEGS),
            *(
                Prismatic(f"column{i}", GROUND, f"slider{i}", (f"s{i}",), column, axis="y")
                for i, column in zip(_LEGS, _COLUMNS, strict=True)
            ),
        ),
        loops=tuple(
            Spherical(f"leg{i}", f"link{i}", "plate", at=Placement((0, 0, "-l")), on=Placement(point))
            for i, point in zip(_LEGS, _PLATE_POINTS, strict=True)
        ),
        actuators=tuple(Actuator(f"F{i}", f"s{i}") for i in _LEGS),
        parameters=_PARAMETERS,
        gravity=(0, "-g", 0),
        end_effector="plate",
    ).with_parameters(**values)
    return replace(mechanism, home=_home(mechanism.values()))


def _home(p: Mapping[str, float]) -> dict[str, float]:
    """The level plate: l cos(alpha) = a - b."""
    alpha = acos(max(-1.0, min(1.0, (p["a"] - p["b"]) / p["l"])))
    height = p["l"] * (1 + sin(alpha))
    return {"y": height} | {f"alpha{i}": alpha for i in _LEGS} | {f"s{i}": p["l"] for i in _LEGS}
