"""Mechanisms other than the catalog's, for tests that must not know the 3-PRS."""

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

__all__ = ["four_bar", "slider_crank", "tip_mass", "two_bodies"]


def _rod(name: str, length: str) -> Body:
    """A uniform thin rod along x from its joint."""
    moment = f"m*{length}^2/12"
    return Body(name, "m", (f"{length}/2", 0, 0), (0, moment, moment))


def four_bar() -> Mechanism:
    """Crank a, coupler b, rocker c, ground d in the x-y plane; the loop's z equation repeats 0 = 0."""
    return Mechanism(
        name="four_bar",
        bodies=(_rod("crank", "a"), _rod("coupler", "b"), _rod("rocker", "c")),
        joints=(
            Revolute("crank", GROUND, "crank", ("q1",), axis="z"),
            Revolute("coupler", "crank", "coupler", ("q2",), Placement(("a", 0, 0)), axis="z"),
            Revolute("rocker", GROUND, "rocker", ("q3",), Placement(("d", 0, 0)), axis="z"),
        ),
        loops=(Spherical("pin", "coupler", "rocker", at=Placement(("b", 0, 0)), on=Placement(("c", 0, 0))),),
        actuators=(Actuator("torque", "q1"),),
        parameters=(
            Parameter("a", 0.2, "m"),
            Parameter("b", 0.5, "m"),
            Parameter("c", 0.4, "m"),
            Parameter("d", 0.6, "m"),
            Parameter("m", 0.7, "kg"),
        ),
        gravity=(0, -9.81, 0),
        home={"q1": 1.3, "q2": -1.0, "q3": 1.7},
    )


def slider_crank() -> Mechanism:
    """Crank r, rod l and a slider on the x axis, which is driven by a force; everything tilted by 30 degrees."""
    tilted = Placement((0, 0, "r/3"), (Rotation("x", degrees=30),))
    return Mechanism(
        name="slider_crank",
        bodies=(_rod("crank", "r"), _rod("rod", "l"), Body("slider", "m/2")),
        joints=(
            Prismatic("rail", GROUND, "slider", ("s",), tilted, axis="x"),
            Revolute("shaft", GROUND, "crank", ("alpha",), tilted, axis="z"),
            Revolute("pin", "crank", "rod", ("beta",), Placement(("r", 0, 0)), axis="-z"),
        ),
        loops=(Spherical("wrist", "rod", "slider", at=Placement(("l", 0, 0))),),
        actuators=(Actuator("push", "s"),),
        parameters=(Parameter("r", 0.1, "m"), Parameter("l", 0.35, "m"), Parameter("m", 0.4, "kg")),
        gravity=(0, -9.81, 0),
        home={"s": "l", "alpha": "pi/3", "beta": "pi/2 - pi/12"},
    )


def two_bodies() -> Mechanism:
    """No loop at all: a free body with products of inertia carries a massless carriage with a swinging one."""
    turned = Placement((0.1, "r", -0.2), (Rotation("y", radians="r/2"), Rotation("-x", degrees=70)))
    return Mechanism(
        name="two_bodies",
        bodies=(
            Body("base", 2, (0.01, 0.02, "-r/9"), (0.3, 0.4, 0.5, 0.02, -0.03, 0.05)),
            Body("carriage"),
            Body("arm", 0.5, ("r/2", 0.03, 0), (0.02, 0.03, 0.04, 0.001, 0.002, -0.003)),
        ),
        joints=(
            Revolute("swing", "carriage", "arm", ("swing",), Placement((0.05, 0.1, 0.02), turned.rotations), axis="y"),
            Free("base", GROUND, "base", ("x", "y", "z", "psi", "theta", "phi")),
            Prismatic("rail", "base", "carriage", ("slide",), turned, axis="-y"),
        ),
        actuators=(Actuator("motor", "swing"),),
        parameters=(Parameter("r", 0.3, "m"),),
        gravity=(0.5, -9.81, 1),
    )


def tip_mass() -> Mechanism:
    """Two massless arms with a point mass at the tip: stretched out, no rate of q2 moves it along the arms."""
    return Mechanism(
        name="tip_mass",
        bodies=(Body("upper"), Body("lower", 1.5, ("r", 0, 0))),
        joints=(
            Revolute("shoulder", GROUND, "upper", ("q1",), axis="z"),
            Revolute("elbow", "upper", "lower", ("q2",), Placement(("r", 0, 0)), axis="z"),
        ),
        actuators=(Actuator("t1", "q1"), Actuator("t2", "q2")),
        parameters=(Parameter("r", 0.4, "m"),),
        gravity=(0, -9.81, 0),
        home={"q1": 0.3, "q2": 1.1},
    )
