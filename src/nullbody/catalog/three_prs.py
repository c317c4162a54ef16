"""The 3-PRS parallel robot (theory 2): three vertical legs that slide on the ground and carry a platform.

    q = [x y z | psi theta phi | alpha1 alpha2 alpha3 | s1 s2 s3]

The frame has y up; slide i runs in the x-z plane along e_i, the z axis turned by 0, 120 and -120 degrees about y.
s_i grows towards the centre; alpha_i is the link's elevation, 90 degrees when it points straight up.
"""

from __future__ import annotations

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

__all__ = ["three_prs"]

_LEG_DEGREES = (0, 120, -120)
_PLATFORM_POINTS: tuple[Triple, ...] = ((0, 0, "b"), ("sqrt(3)/2*b", 0, "-b/2"), ("-sqrt(3)/2*b", 0, "-b/2"))  # b e_i

_PARAMETERS = (
    Parameter("a", 0.8, "m", "distance from the centre at which s = 0"),
    Parameter("b", 0.2, "m", "radius of the platform's joints"),
    Parameter("l", 0.5, "m", "length of the links"),
    Parameter("M", 1.0, "kg", "mass of the platform"),
    Parameter("m", 0.1, "kg", "mass of each link"),
    Parameter("g", 9.8, "m/s^2", "gravity, along -y", "any"),
    Parameter("Ixx", "M*b^2/4", "kg m^2", "platform's moment of inertia about its x axis"),
    Parameter("Iyy", "M*b^2/2", "kg m^2", "platform's moment of inertia about its normal"),
    Parameter("Izz", "M*b^2/4", "kg m^2", "platform's moment of inertia about its z axis"),
    Parameter("ms", 0.0, "kg", "mass of each slider", "non-negative"),
)


def three_prs(**values: float) -> Mechanism:
    """The 3-PRS robot of the paper (Table 2 by default), inputs F1, F2, F3 along s1, s2, s3.

    Loop i: B_i(leg) - B_i(platform) = 0 with B_i(leg) = (a - s_i) e_i + l (sin(alpha_i) y - cos(alpha_i) e_i)
    and B_i(platform) = p + R b e_i [26]. Links are uniform thin rods, the platform a uniform disc unless
    Ixx, Iyy, Izz are given, sliders are point masses ms.

    Args:
        values: parameters that differ from the paper's: a, b, l [m], M, m, ms [kg], g [m/s^2],
            Ixx, Iyy, Izz [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    rod = ("m*l^2/12", "m*l^2/12", 0)
    legs = range(1, 4)
    platform = Body("platform", "M", (0, 0, 0), ("Ixx", "Iyy", "Izz"))
    links = [Body(f"link{i}", "m", (0, 0, "-l/2"), rod) for i in legs]
    sliders = [Body(f"slider{i}", "ms") for i in legs]
    joints = [
        Free("platform", GROUND, "platform", ("x", "y", "z", "psi", "theta", "phi")),
        *(Revolute(f"hinge{i}", f"slider{i}", f"link{i}", (f"alpha{i}",), axis="x") for i in legs),
        *(
            Prismatic(f"slide{i}", GROUND, f"slider{i}", (f"s{i}",), _rail(degrees), axis="-z")
            for i, degrees in zip(legs, _LEG_DEGREES, strict=True)
        ),
    ]
    loops = [
        Spherical(f"leg{i}", f"link{i}", "platform", at=Placement((0, 0, "-l")), on=Placement(point))
        for i, point in zip(legs, _PLATFORM_POINTS, strict=True)
    ]
    mechanism = Mechanism(
        name="three_prs",
        bodies=(platform, *links, *sliders),
        joints=tuple(joints),
        loops=tuple(loops),
        actuators=tuple(Actuator(f"F{i}", f"s{i}") for i in legs),
        parameters=_PARAMETERS,
        gravity=(0, "-g", 0),
        home={"y": "l"} | {f"alpha{i}": "pi/2" for i in legs} | {f"s{i}": "a - b" for i in legs},
        end_effector="platform",
    )
    return mechanism.with_parameters(**values)


def _rail(degrees: int) -> Placement:
    """The frame of a slide: its z axis points outwards along e_i, its origin is where s = 0."""
    e: dict[int, Triple] = {0: (0, 0, "a"), 120: ("sqrt(3)/2*a", 0, "-a/2"), -120: ("-sqrt(3)/2*a", 0, "-a/2")}
    return Placement(e[degrees], (Rotation("y", degrees=degrees),))
