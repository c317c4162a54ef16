"""Andrews' squeezing mechanism (IFToMM benchmark A03; Test Set for IVP Solvers): seven bodies, three loops, one motor.

    q = [beta theta gamma phi delta omega epsilon]

Plane motion, z is the axis of all angles. K1 turns about the origin by beta and carries K2 at F, turned by theta
against it. K3, K5 and K7 turn about B, A and A by gamma, delta and epsilon. K4 hangs at G on K5, turned by phi against
it; K6 hangs at H on K7, turned by omega against it. K2, K3, K4 and K6 meet at E.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import atan2, cos, hypot, pi, sin, sqrt

from nullbody.catalog.dyad import Point, dyad, meets
from nullbody.catalog.start import Start
from nullbody.mechanism import (
    GROUND,
    Actuator,
    Body,
    Mechanism,
    Parameter,
    Placement,
    Revolute,
    Spherical,
    Spring,
    Wrench,
)
from nullbody.typing import Triple

__all__ = ["andrews", "starts"]

_STEPS = 180  # of theta tried where bars of these lengths cannot meet at theta = 0
_ROUNDING = 1e-12  # relative

_MASSES = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
_MOMENTS = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)

_PARAMETERS = (
    *(Parameter(f"m{k}", mass, "kg", f"mass of K{k}") for k, mass in enumerate(_MASSES, 1)),
    *(
        Parameter(f"I{k}", moment, "kg m^2", f"moment of inertia of K{k} about its centre of mass")
        for k, moment in enumerate(_MOMENTS, 1)
    ),
    Parameter("xa", -0.06934, "m", "A, the pivot of K5 and K7, along x", "any"),
    Parameter("ya", -0.00227, "m", "A along y", "any"),
    Parameter("xb", -0.03635, "m", "B, the pivot of K3, along x", "any"),
    Parameter("yb", 0.03273, "m", "B along y", "any"),
    Parameter("xc", 0.014, "m", "C, the spring's end on the ground, along x", "any"),
    Parameter("yc", 0.072, "m", "C along y", "any"),
    Parameter("rr", 0.007, "m", "O to F on K1"),
    Parameter("ra", 0.00092, "m", "O to the centre of mass of K1", "any"),
    Parameter("d", 0.028, "m", "F to E on K2"),
    Parameter("da", 0.0115, "m", "F to the centre of mass of K2", "any"),
    Parameter("ss", 0.035, "m", "B to E on K3"),
    Parameter("sa", 0.01874, "m", "centre of mass of K3 towards E", "any"),
    Parameter("sb", 0.01043, "m", "centre of mass of K3 across", "any"),
    Parameter("sc", 0.018, "m", "the spring's end on K3 towards E", "any"),
    Parameter("sd", 0.02, "m", "the spring's end on K3 across", "any"),
    Parameter("e", 0.02, "m", "E to G on K4"),
    Parameter("ea", 0.01421, "m", "E to the centre of mass of K4", "any"),
    Parameter("zt", 0.04, "m", "A to G on K5"),
    Parameter("ta", 0.02308, "m", "centre of mass of K5 towards G", "any"),
    Parameter("tb", 0.00916, "m", "centre of mass of K5 across", "any"),
    Parameter("zf", 0.02, "m", "E to H on K6"),
    Parameter("fa", 0.01421, "m", "E to the centre of mass of K6", "any"),
    Parameter("u", 0.04, "m", "A to H on K7"),
    Parameter("ua", 0.01228, "m", "centre of mass of K7 towards H", "any"),
    Parameter("ub", 0.00449, "m", "centre of mass of K7 across", "any"),
    Parameter("c0", 4530.0, "N/m", "stiffness of the spring", "non-negative"),
    Parameter("l0", 0.07785, "m", "free length of the spring", "non-negative"),
    Parameter("mom", 0.033, "N m", "constant torque of the motor on K1", "any"),
)

_CENTRES: tuple[Triple, ...] = (
    ("ra", 0, 0),
    ("-da", 0, 0),
    ("sb", "-sa", 0),
    (0, "ea - e", 0),
    ("ta", "tb", 0),
    ("zf - fa", 0, 0),
    ("-ub", "-ua", 0),
)


def andrews(**values: float) -> Mechanism:
    """Andrews' mechanism with the coordinates, constraints and multipliers of the Test Set; input: more torque on K1.

    Loops, each E on K2 minus E on another body, R(a) the rotation by a:
    F + R(beta + theta) (-d, 0) - (B + R(gamma) (0, -ss)) = 0, the same with A + R(delta) (zt, 0) + R(phi + delta)
    (0, -e) of K4, and with A + R(epsilon) (0, -u) + R(omega + epsilon) (zf, 0) of K6. The motor's constant torque `mom`
    is a load; the input adds to it. No gravity.

    Home is the start of the Test Set, theta = 0 (K1 and K2 in line), or the theta nearest to it that the lengths allow.

    Source: Test Set for IVP Solvers, release 2.4, section II-13; W. Schiehlen (ed.), Multibody Systems Handbook (1990).

    Args:
        values: parameters that differ from the Test Set's.

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
    """
    a, b = Placement(("xa", "ya", 0)), Placement(("xb", "yb", 0))
    mechanism = Mechanism(
        name="andrews",
        bodies=tuple(
            Body(f"K{k}", f"m{k}", centre, (f"I{k}/2", f"I{k}/2", f"I{k}")) for k, centre in enumerate(_CENTRES, 1)
        ),
        joints=(
            Revolute("O", GROUND, "K1", ("beta",)),
            Revolute("F", "K1", "K2", ("theta",), Placement(("rr", 0, 0))),
            Revolute("B", GROUND, "K3", ("gamma",), b),
            Revolute("G", "K5", "K4", ("phi",), Placement(("zt", 0, 0))),
            Revolute("A5", GROUND, "K5", ("delta",), a),
            Revolute("H", "K7", "K6", ("omega",), Placement((0, "-u", 0))),
            Revolute("A7", GROUND, "K7", ("epsilon",), a),
        ),
        loops=(
            Spherical("E3", "K2", "K3", at=Placement(("-d", 0, 0)), on=Placement((0, "-ss", 0))),
            Spherical("E4", "K2", "K4", at=Placement(("-d", 0, 0)), on=Placement((0, "-e", 0))),
            Spherical("E6", "K2", "K6", at=Placement(("-d", 0, 0)), on=Placement(("zf", 0, 0))),
        ),
        loads=(
            Spring("spring", GROUND, ("xc", "yc", 0), "K3", ("sd", "-sc", 0), stiffness="c0", length="l0"),
            Wrench("motor", "K1", torque=(0, 0, "mom")),
        ),
        actuators=(Actuator("torque", "beta"),),
        parameters=_PARAMETERS,
        end_effector="K3",
    ).with_parameters(**values)
    return replace(mechanism, home=_home(mechanism.values()))


def _home(p: Mapping[str, float]) -> dict[str, float]:
    """All angles for the theta nearest to 0 at which all bars meet."""
    turns = (sign * pi * k / _STEPS for k in range(_STEPS) for sign in (1, -1))
    return _angles(p, next((theta for theta in turns if _closes(p, theta)), 0.0))


def _joint(p: Mapping[str, float], theta: float) -> Point:
    """E: on the circle about B, at the distance from O that K1 and K2 make."""
    reach = sqrt(p["rr"] ** 2 + p["d"] ** 2 - 2 * p["rr"] * p["d"] * cos(theta))
    return dyad((0.0, 0.0), (p["xb"], p["yb"]), reach, p["ss"])


def _closes(p: Mapping[str, float], theta: float) -> bool:
    a, b, E = (p["xa"], p["ya"]), (p["xb"], p["yb"]), _joint(p, theta)
    on_circle = abs(hypot(E[0] - b[0], E[1] - b[1]) - p["ss"]) < _ROUNDING * p["ss"]
    return on_circle and meets(a, E, p["zt"], p["e"]) and meets(E, a, p["zf"], p["u"])


def _angles(p: Mapping[str, float], theta: float) -> dict[str, float]:
    """All angles for a given theta: G and H are where two bars each meet."""
    a, b = (p["xa"], p["ya"]), (p["xb"], p["yb"])
    x, y = E = _joint(p, theta)
    (gx, gy), (hx, hy) = dyad(a, E, p["zt"], p["e"]), dyad(E, a, p["zf"], p["u"])
    delta, epsilon = atan2(gy - a[1], gx - a[0]), atan2(hx - a[0], a[1] - hy)
    return {
        "beta": atan2(-y, -x) - atan2(p["d"] * sin(theta), p["d"] * cos(theta) - p["rr"]),
        "theta": theta,
        "gamma": atan2(x - b[0], b[1] - y),
        "phi": atan2(x - gx, gy - y) - delta,
        "delta": delta,
        "omega": atan2(y - hy, x - hx) - epsilon,
        "epsilon": epsilon,
    }


def starts(**values: float) -> dict[str, Start]:
    """`test_set`: at rest at home, theta = 0."""
    return {"test_set": Start(andrews(**values), duration=0.05, source="Test Set for IVP Solvers, II-13; IFToMM A03")}
