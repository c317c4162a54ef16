"""Small mechanisms that are hard: redundant rows, bodies without mass, loops that hold little or nothing."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from nullbody.formats import RigidFrame, frame
from nullbody.mechanism import (
    GROUND,
    AbstractLoopJoint,
    AbstractTreeJoint,
    Actuator,
    Body,
    Driver,
    Mechanism,
    Placement,
    Prismatic,
    Revolute,
    Rotation,
    Spherical,
    Universal,
    Weld,
)
from tests.verify.mechanisms import (
    AT,
    GRAVITY,
    LOOP_JOINTS,
    ON,
    PARAMETERS,
    QUATERNION,
    TILTED,
    VALUES,
    body_of,
    constrained,
    quaternion_loop,
    roll_pitch_yaw,
)

__all__ = ["SPECIAL"]


def spatial_four_bar() -> Mechanism:
    """A planar four-bar between revolute joints in space: three of the five equations of its loop are redundant."""
    lengths = {"crank": 0.2, "coupler": 0.5, "rocker": 0.4}
    rods = tuple(Body(name, "5*p", (size / 2, 0, 0), (0.001, 0.02, 0.02)) for name, size in lengths.items())
    return Mechanism(
        name="spatial_four_bar",
        bodies=rods,
        joints=(
            Revolute("crank", GROUND, "crank", ("q1",), TILTED),
            Revolute("coupler", "crank", "coupler", ("q2",), Placement((0.2, 0, 0))),
            Revolute("rocker", GROUND, "rocker", ("q3",), Placement((0.6, 0, 0), ())),
        ),
        loops=(Revolute("pin", "coupler", "rocker", at=Placement((0.5, 0, 0)), on=Placement((0.4, 0, 0))),),
        actuators=(Actuator("torque", "q1"),),
        parameters=PARAMETERS,
        gravity=GRAVITY,
        home={"q1": 1.3, "q2": -1.0, "q3": 1.7},
    )


def flat_four_bar() -> Mechanism:
    """The same with both hinges of the ground in one plane, as it must be for the loop to close."""
    tilted = spatial_four_bar()
    crank, coupler, rocker = tilted.joints
    return replace(tilted, joints=(replace(crank, at=Placement()), coupler, rocker))


def doubled() -> Mechanism:
    """A loop that is there twice, of a body with Euler parameters and a massless link."""
    kind, settings, _ = LOOP_JOINTS["Distance"]
    rods = tuple(kind(name, GROUND, "body", at=AT, on=ON, **settings) for name in ("rod", "again"))
    single = constrained("KnifeEdge")
    return replace(single, name="doubled", constraints=(), loops=rods, home={"x": 0.5, "y": 0.4, "z": 0.2})


def welded_twice() -> Mechanism:
    """A weld and a hinge hold a body with Euler parameters: 11 equations and the norm, 7 of them independent."""
    single = quaternion_loop("Weld")
    hinge = Revolute("hinge", "arm", "body", at=AT, on=ON, axis="y")
    return replace(single, name="welded_twice", loops=(hinge, *single.loops))


def massless_links() -> Mechanism:
    """A ball on a carriage on a rail, all without mass, hold a body; a rod without mass ends at the ground."""
    return Mechanism(
        name="massless_links",
        bodies=(Body("carriage"), Body("knee"), body_of("body"), Body("strut")),
        joints=(
            Prismatic("rail", GROUND, "carriage", ("s",), AT, axis="x"),
            Spherical("ball", "carriage", "knee", ("e0", "e1", "e2", "e3"), ON),
            Revolute("hinge", "knee", "body", ("h",), AT, ON, axis="y"),
            Universal("cross", "body", "strut", ("u1", "u2"), AT),
        ),
        loops=(Spherical("foot", "strut", GROUND, at=Placement((0.3, 0, 0)), on=Placement((0.2, 0.5, "p"))),),
        actuators=(Actuator("push", "s"), Actuator("motor", "h")),
        parameters=PARAMETERS,
        gravity=GRAVITY,
    )


def _meeting(joint: AbstractLoopJoint, free: Sequence[float], parent: RigidFrame, child: RigidFrame) -> Placement:
    """Where on the parent the frame of a loop joint must be for the loop to close."""
    motion = joint.motion(list(free), np.sin, np.cos)  # type: ignore[attr-defined]
    moved = RigidFrame(np.array(motion.pose.rotation, dtype=float), np.array(motion.pose.position, dtype=float))
    met = parent.inverse() @ child @ frame(joint.on, VALUES) @ moved.inverse()
    psi, theta, phi = roll_pitch_yaw(met.rotation)
    turns = (Rotation("z", radians=phi), Rotation("y", radians=theta), Rotation("x", radians=psi))
    return Placement(tuple(map(float, met.position)), turns)  # type: ignore[arg-type]


def _closed_chain(
    name: str, first: AbstractTreeJoint, q: Sequence[float], loop: AbstractLoopJoint, free: Sequence[float], **more: Any
) -> Mechanism:
    """A joint that holds "body" on "base" or the ground, a loop between the same two bodies, and an arm on the body."""
    pose = first.motion(list(q), np.sin, np.cos).pose
    moved = RigidFrame(np.array(pose.rotation, dtype=float), np.array(pose.position, dtype=float))
    body = frame(first.at, VALUES) @ moved @ frame(first.on, VALUES).inverse()
    met = replace(loop, at=_meeting(loop, free, RigidFrame(np.eye(3), np.zeros(3)), body))
    arm = Revolute("tip", "body", "arm", ("b",), AT, axis="y")
    base = (Revolute("root", GROUND, "base", ("a",), ON),) if first.parent == "base" else ()
    bodies = (body_of("body"), body_of("arm", 0.5), *(body_of("base") for _ in base))
    home = dict(zip(first.coordinates, q, strict=True))
    given = {"parameters": PARAMETERS, "gravity": GRAVITY, "home": home, **more}
    return Mechanism(name, bodies, (*base, first, arm), (met,), **given)


def locked_ball() -> Mechanism:
    """Four equations of a loop and the norm lock a ball; three of the four are independent where |e| = 1."""
    kind, settings, free = LOOP_JOINTS["Universal"]
    ball = Spherical("ball", GROUND, "body", QUATERNION[3:], AT)
    return _closed_chain(
        "locked_ball", ball, (0.8, 0.36, -0.48, 0.0), kind("lock", GROUND, "body", on=ON, **settings), free
    )


def same_pair() -> Mechanism:
    """A cross and a point hold a body: the point's three equations are independent only where it is off its place."""
    cross = Universal("cross", "base", "body", ("u", "w"), AT, ON)
    drive = (Driver("drive", "a", "p*t + sin(t)/5"),)
    point = Spherical("point", "base", "body", on=Placement((0.2, 0.1, -0.1)))
    return _closed_chain("same_pair", cross, (0.3, 0.5), point, (1, 0, 0, 0), constraints=drive)


def rigid_pair() -> Mechanism:
    """A loop between two bodies that cannot move against each other holds nothing but what rounding leaves."""
    weld = Weld("weld", "base", "body", (), AT, ON)
    return _closed_chain("rigid_pair", weld, (), Spherical("point", "base", "body", on=AT), (1, 0, 0, 0))


SPECIAL: Mapping[str, Callable[[], Mechanism]] = {
    "flat_four_bar": flat_four_bar,
    "doubled": doubled,
    "welded_twice": welded_twice,
    "massless_links": massless_links,
    "locked_ball": locked_ball,
    "same_pair": same_pair,
    "rigid_pair": rigid_pair,
}
