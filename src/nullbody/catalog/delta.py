"""The delta robot: three driven arms on a ceiling, and forearms that let the platform move without turning.

    q = [x y z | psi theta phi | alpha1 alpha2 alpha3 | beta1 gamma1 .. beta3 gamma3]

The frame has z up, the platform hangs below the ground's plate, z < 0. Arm i turns about a horizontal axis at a e_i,
with e_i the x axis turned by 0, 120 and -120 degrees about z; alpha_i = 0 points outwards, 90 degrees straight down.
beta_i and gamma_i turn the forearm against the arm, about the arm's axis and then about the axis across.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from math import pi

from nullbody.catalog.delta_kinematics import forward
from nullbody.errors import SingularityError
from nullbody.mechanism import (
    GROUND,
    Actuator,
    Body,
    Free,
    Mechanism,
    Parameter,
    Placement,
    Revolute,
    Rotation,
    Universal,
)
from nullbody.typing import Triple

__all__ = ["delta"]

_LEGS = (1, 2, 3)
_DEGREES = (0, 120, -120)

_PARAMETERS = (
    Parameter("a", 0.2, "m", "distance of the arms' axes from the centre"),
    Parameter("b", 0.05, "m", "distance of the platform's joints from its centre"),
    Parameter("la", 0.25, "m", "length of the arms"),
    Parameter("lf", 0.55, "m", "length of the forearms"),
    Parameter("M", 0.4, "kg", "mass of the platform and what it carries"),
    Parameter("ma", 0.5, "kg", "mass of each arm"),
    Parameter("mf", 0.15, "kg", "mass of each forearm, both of its rods together"),
    Parameter("g", 9.81, "m/s^2", "gravity, along -z", "any"),
    Parameter("Ip", "M*b^2/2", "kg m^2", "platform's moment of inertia about any axis; no matter, it does not turn"),
    Parameter("Ia", "ma*la^2/12", "kg m^2", "arm's moment of inertia across, about its centre", "non-negative"),
    Parameter("If", "mf*lf^2/12", "kg m^2", "forearm's moment of inertia across, about its centre", "non-negative"),
)

_HOME = tuple(sign * pi * k / 36 for k in range(19) for sign in (1, -1))  # angles of the arms, the first that closes


def delta(**values: float) -> Mechanism:
    """The delta robot, inputs tau1, tau2, tau3 turn the arms downwards.

    Loop i, with the arm's and the forearm's directions d, f and R = Rz(phi) Ry(theta) Rx(psi):
    a e_i + la d(alpha_i) + lf f(alpha_i + beta_i, gamma_i) - p - R b e_i = 0, and the forearm's cross axis at right
    angles to R t_i, t_i the arm's axis. Three degrees of freedom x, y, z.

    A real forearm is a parallelogram of two rods on four ball joints. Here it is one rod between two universal joints
    whose outer axes are parallel to the arm's axis and whose inner axes are parallel to each other, the side and the
    normal of the parallelogram. The three right angles make psi = theta = phi = 0, no equation is redundant, and the
    rod moves as each of the two does: with the mass of both, thin as they are, the dynamics are the same. Other
    solutions, with the platform turned, belong to this model alone.

    Home has the arms level, or as near to that as the lengths allow, and the platform below the middle. Roll-pitch-yaw
    angles do, as the platform never turns. By default arms and forearms are uniform thin rods.

    Source: R. Clavel, Proc. Int. Symp. on Industrial Robots (1988) 91-100; universal joints in place of parallelograms:
    L.-W. Tsai, R. Stamper, ASME DETC96-MECH-1169 (1996).

    Args:
        values: parameters that differ from the defaults: a, b, la, lf [m], M, ma, mf [kg], g [m/s^2], Ip, Ia, If
            [kg m^2].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    platform = Body("platform", "M", (0, 0, 0), ("Ip", "Ip", "Ip"))
    arms = [Body(f"arm{i}", "ma", ("la/2", 0, 0), (0, "Ia", "Ia")) for i in _LEGS]
    forearms = [Body(f"forearm{i}", "mf", (0, 0, "-lf/2"), ("If", "If", 0)) for i in _LEGS]
    elbow, wrist = Placement(("la", 0, 0)), Placement((0, 0, "-lf"))
    mechanism = Mechanism(
        name="delta",
        bodies=(platform, *arms, *forearms),
        joints=(
            Free("platform", GROUND, "platform", ("x", "y", "z", "psi", "theta", "phi")),
            *(
                Revolute(f"shoulder{i}", GROUND, f"arm{i}", (f"alpha{i}",), _around(degrees, "a"), axis="y")
                for i, degrees in zip(_LEGS, _DEGREES, strict=True)
            ),
            *(
                Universal(f"elbow{i}", f"arm{i}", f"forearm{i}", (f"beta{i}", f"gamma{i}"), elbow, axis="y", axis2="x")
                for i in _LEGS
            ),
        ),
        loops=tuple(
            Universal(f"leg{i}", f"forearm{i}", "platform", at=wrist, on=_around(degrees, "b"), axis="x", axis2="y")
            for i, degrees in zip(_LEGS, _DEGREES, strict=True)
        ),
        actuators=tuple(Actuator(f"tau{i}", f"alpha{i}") for i in _LEGS),
        parameters=_PARAMETERS,
        gravity=(0, 0, "-g"),
        end_effector="platform",
    ).with_parameters(**values)
    return replace(mechanism, home=_home(mechanism.values()))


def _around(degrees: int, radius: str) -> Placement:
    """A frame on the circle of a radius, x outwards, y along the arm's axis."""
    positions: dict[int, Triple] = {
        0: (radius, 0, 0),
        120: (f"-{radius}/2", f"sqrt(3)/2*{radius}", 0),
        -120: (f"-{radius}/2", f"-sqrt(3)/2*{radius}", 0),
    }
    return Placement(positions[degrees], (Rotation("z", degrees=degrees),))


def _home(p: Mapping[str, float]) -> dict[str, float]:
    """Three equal arms; straight, if no angle of the arms lets the platform hang below them."""
    for angle in _HOME:
        with suppress(SingularityError):
            found = forward(p, (angle, angle, angle))
            if found:
                return found[0]
    return {f"alpha{i}": 0.0 for i in _LEGS} | {"z": -p["lf"]}
