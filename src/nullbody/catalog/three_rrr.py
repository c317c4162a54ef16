"""The planar 3-RRR robot: three driven cranks move and turn a platform in its plane.

    q = [x y phi | theta1 theta2 theta3 | gamma1 gamma2 gamma3]

The frame has y up. Crank i turns by theta_i about the pivot a e_i, where e_1, e_2, e_3 point to -150, -30 and 90
degrees; the coupler hangs at its tip, turned by gamma_i against it, and holds the platform's joint b e_i. x, y is the
platform's centre, phi its turn. Angles are counter-clockwise, 0 along x.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from nullbody.catalog.three_rrr_kinematics import cranks
from nullbody.mechanism import GROUND, Actuator, Body, Mechanism, Parameter, Placement, Planar, Revolute, Spherical
from nullbody.typing import Triple

__all__ = ["three_rrr"]

_LEGS = (1, 2, 3)

_PARAMETERS = (
    Parameter("a", 0.35, "m", "distance of the pivots on the ground from the centre"),
    Parameter("b", 0.1, "m", "distance of the platform's joints from its centre"),
    Parameter("l1", 0.2, "m", "length of the cranks"),
    Parameter("l2", 0.2, "m", "length of the couplers"),
    Parameter("M", 0.5, "kg", "mass of the platform"),
    Parameter("m1", 0.2, "kg", "mass of each crank"),
    Parameter("m2", 0.2, "kg", "mass of each coupler"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -y; 0 for a robot that lies flat", "any"),
    Parameter("Ip", "M*b^2/4", "kg m^2", "platform's moment of inertia about its centre, by default of a triangle"),
    Parameter("I1", "m1*l1^2/12", "kg m^2", "crank's moment of inertia about its centre"),
    Parameter("I2", "m2*l2^2/12", "kg m^2", "coupler's moment of inertia about its centre"),
)


def three_rrr(**values: float) -> Mechanism:
    """The 3-RRR robot, inputs tau1, tau2, tau3 turn the cranks.

    Loop i: a e_i + l1 (cos(theta_i), sin(theta_i)) + l2 (cos(theta_i + gamma_i), sin(theta_i + gamma_i))
    - (x, y) - R(phi) b e_i = 0. Three degrees of freedom x, y, phi. By default bars are uniform thin rods and the
    platform a uniform triangle with its joints in the corners.

    Home has the platform in the middle, not turned, and all elbows on the same side: right of the way from the pivot to
    the platform.

    Source: C. Gosselin, J. Angeles, J. Mech. Trans. Autom. Design 110 (1988) 35-41.

    Args:
        values: parameters that differ from the defaults: a, b, l1, l2 [m], M, m1, m2 [kg], g [m/s^2], Ip, I1, I2
            [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    mechanism = Mechanism(
        name="three_rrr",
        bodies=(
            Body("platform", "M", (0, 0, 0), ("Ip/2", "Ip/2", "Ip")),
            *(Body(f"crank{i}", "m1", ("l1/2", 0, 0), (0, "I1", "I1")) for i in _LEGS),
            *(Body(f"coupler{i}", "m2", ("l2/2", 0, 0), (0, "I2", "I2")) for i in _LEGS),
        ),
        joints=(
            Planar("plane", GROUND, "platform", ("x", "y", "phi")),
            *(Revolute(f"pivot{i}", GROUND, f"crank{i}", (f"theta{i}",), Placement(_corner(i, "a"))) for i in _LEGS),
            *(
                Revolute(f"elbow{i}", f"crank{i}", f"coupler{i}", (f"gamma{i}",), Placement(("l1", 0, 0)))
                for i in _LEGS
            ),
        ),
        loops=tuple(
            Spherical(f"leg{i}", f"coupler{i}", "platform", at=Placement(("l2", 0, 0)), on=Placement(_corner(i, "b")))
            for i in _LEGS
        ),
        actuators=tuple(Actuator(f"tau{i}", f"theta{i}") for i in _LEGS),
        parameters=_PARAMETERS,
        gravity=(0, "-g", 0),
        end_effector="platform",
    ).with_parameters(**values)
    return replace(mechanism, home=_home(mechanism.values()))


def _corner(leg: int, radius: str) -> Triple:
    """radius e_i"""
    corners: tuple[Triple, ...] = (
        (f"-sqrt(3)/2*{radius}", f"-{radius}/2", 0),
        (f"sqrt(3)/2*{radius}", f"-{radius}/2", 0),
        (0, radius, 0),
    )
    return corners[leg - 1]


def _home(p: Mapping[str, float]) -> dict[str, float]:
    """The platform in the middle; bars that cannot meet are stretched out."""
    return cranks(p, {"x": 0.0, "y": 0.0, "phi": 0.0}, (-1, -1, -1))
