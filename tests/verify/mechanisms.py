"""Small mechanisms, one for each joint in both roles, each constraint and each load; the parameter p is in all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from nullbody.formats import RigidFrame, frame
from nullbody.mechanism import (
    GROUND,
    AbstractConstraint,
    AbstractLoad,
    AbstractLoopJoint,
    AbstractTreeJoint,
    Actuator,
    Body,
    CoordinateSpring,
    Coupling,
    Cylindrical,
    Distance,
    Driver,
    Energy,
    Free,
    FreeQuaternion,
    Friction,
    Holonomic,
    Kinematics,
    KnifeEdge,
    Mechanism,
    Nonholonomic,
    Parameter,
    Placement,
    Planar,
    PointOnLine,
    PointOnPlane,
    Prismatic,
    Revolute,
    RollingDisc,
    Rotation,
    Spherical,
    Spring,
    Universal,
    Weld,
    Wrench,
)

__all__ = [
    "AT",
    "CONSTRAINTS",
    "GRAVITY",
    "LOADS",
    "LOOP_JOINTS",
    "ON",
    "PARAMETERS",
    "QUATERNION",
    "TILTED",
    "TREE_JOINTS",
    "VALUES",
    "body_of",
    "constrained",
    "loaded",
    "loop",
    "quaternion_loop",
    "roll_pitch_yaw",
    "tree",
    "twin",
    "twin_coordinates",
]

AT = Placement((0.1, "p", -0.05), (Rotation("y", degrees=40), Rotation("-x", radians="p")))
ON = Placement((-0.07, 0.04, "p/2"), (Rotation("z", degrees=25), Rotation("x", degrees=-35)))
PARAMETERS = (Parameter("p", 0.2),)
GRAVITY = (0.5, -9.81, 1)
VALUES = {"p": 0.2}

#: Tree joints with other axes than those by default.
TREE_JOINTS: Mapping[str, tuple[type[AbstractTreeJoint], Mapping[str, str]]] = {
    "Revolute": (Revolute, {"axis": "-x"}),
    "Prismatic": (Prismatic, {"axis": "-y"}),
    "Cylindrical": (Cylindrical, {"axis": "y"}),
    "Universal": (Universal, {"axis": "-z", "axis2": "x"}),
    "Planar": (Planar, {"axis": "-x"}),
    "Spherical": (Spherical, {}),
    "Weld": (Weld, {}),
    "Free": (Free, {}),
    "FreeQuaternion": (FreeQuaternion, {}),
}

#: Loop joints, each with a pose of the child's frame in the parent's that closes it: what the joint lets free.
LOOP_JOINTS: Mapping[str, tuple[type[AbstractLoopJoint], Mapping[str, Any], Sequence[float]]] = {
    "Revolute": (Revolute, {"axis": "-x"}, (0.4,)),
    "Prismatic": (Prismatic, {"axis": "-y"}, (0.3,)),
    "Cylindrical": (Cylindrical, {"axis": "y"}, (0.2, -0.5)),
    "Universal": (Universal, {"axis": "-z", "axis2": "x"}, (0.3, 0.5)),
    "Planar": (Planar, {"axis": "-x"}, (0.1, -0.2, 0.4)),
    "Spherical": (Spherical, {}, (0.8, 0.36, -0.48, 0.0)),
    "Weld": (Weld, {}, ()),
    "Distance": (Distance, {"length": "3*p"}, (0.36, 0.48, 0, 0.1, 0.2, 0.3)),
    "PointOnLine": (PointOnLine, {"axis": "-x"}, (0.2, 0, 0, 0.3, -0.2, 0.1)),
    "PointOnPlane": (PointOnPlane, {"axis": "y"}, (0.2, 0, 0.1, 0.1, 0.3, -0.2)),
}


def body_of(name: str, mass: float = 1.3) -> Body:
    """A body without any symmetry."""
    return Body(name, mass, (0.03, -0.02, "p/4"), (0.03, 0.04, 0.05, 0.002, -0.003, 0.004))


def _names(kind: type[AbstractTreeJoint], prefix: str) -> tuple[str, ...]:
    return tuple(f"{prefix}{k}" for k in range(len(kind.units)))


def tree(name: str) -> Mechanism:
    """The joint from the ground and once more at the end of a chain."""
    kind, axes = TREE_JOINTS[name]
    return Mechanism(
        name=f"tree_{name}",
        bodies=(body_of("one"), body_of("two", 0.6), body_of("three", 0.4)),
        joints=(
            kind("first", GROUND, "one", _names(kind, "a"), AT, ON, **axes),
            Revolute("tip", "one", "two", ("tip",), AT, ON, axis="-y"),
            kind("last", "two", "three", _names(kind, "b"), AT, ON, **axes),
        ),
        actuators=(Actuator("motor", "tip"),),
        parameters=PARAMETERS,
        gravity=GRAVITY,
    )


@dataclass(frozen=True)
class _Chain:
    """An arm on the ground and a body behind it, which a joint holds."""

    joints: tuple[AbstractTreeJoint, ...]
    loops: tuple[AbstractLoopJoint, ...]
    home: Mapping[str, float]

    def mechanism(self, name: str) -> Mechanism:
        return Mechanism(
            name=name,
            bodies=(body_of("arm"), body_of("body", 0.7)),
            joints=self.joints,
            loops=self.loops,
            actuators=(Actuator("motor", "arm"),),
            parameters=PARAMETERS,
            gravity=GRAVITY,
            home=self.home,
        )


_ARM = Revolute("shoulder", GROUND, "arm", ("arm",), ON, axis="z")
_FREE = ("x", "y", "z", "psi", "theta", "phi")
QUATERNION = ("x", "y", "z", "e0", "e1", "e2", "e3")


def loop(name: str) -> Mechanism:
    """The joint closes a loop between an arm and a free body."""
    kind, settings, free = LOOP_JOINTS[name]
    joint = kind("loop", "arm", "body", at=AT, on=ON, **settings)
    home = {"arm": 0.3, **dict(zip(_FREE, _free_coordinates(kind, settings, free), strict=True))}
    chain = _Chain((_ARM, Free("free", GROUND, "body", _FREE)), (joint,), home)
    return chain.mechanism(f"loop_{name}")


def quaternion_loop(name: str) -> Mechanism:
    """The same with Euler parameters."""
    kind, settings, free = LOOP_JOINTS[name]
    plain = loop(name)
    position, (psi, theta, phi) = np.split(_free_coordinates(kind, settings, free), [3])
    c, s = np.cos(np.array([psi, theta, phi]) / 2), np.sin(np.array([psi, theta, phi]) / 2)
    e = (
        c[0] * c[1] * c[2] + s[0] * s[1] * s[2],
        s[0] * c[1] * c[2] - c[0] * s[1] * s[2],
        c[0] * s[1] * c[2] + s[0] * c[1] * s[2],
        c[0] * c[1] * s[2] - s[0] * s[1] * c[2],
    )
    home = {"arm": 0.3, **dict(zip(QUATERNION, map(float, (*position, *e)), strict=True))}
    joints = (_ARM, FreeQuaternion("free", GROUND, "body", QUATERNION))
    return replace(plain, name=f"quaternion_loop_{name}", joints=joints, home=home)


def twin(name: str) -> Mechanism:
    """The same with the joint in the tree instead; its loop counterpart must move alike."""
    kind, settings, free = LOOP_JOINTS[name]
    assert issubclass(kind, AbstractTreeJoint)
    names = _names(kind, "b")
    joint = kind("held", "arm", "body", names, AT, ON, **settings)
    chain = _Chain((_ARM, joint), (), {"arm": 0.3, **dict(zip(names, free, strict=True))})
    return chain.mechanism(f"twin_{name}")


def _free_coordinates(kind: type[AbstractLoopJoint], settings: Mapping[str, Any], free: Sequence[float]) -> list[float]:
    """Those of the free body that close the loop, for an arm at 0.3 rad."""
    in_tree = issubclass(kind, AbstractTreeJoint)
    joint = kind("j", "a", "b", **settings) if in_tree else Free("j", "a", "b")
    pose = joint.motion(list(free), np.sin, np.cos).pose  # type: ignore[attr-defined]
    moved = RigidFrame(np.array(pose.rotation, dtype=float), np.array(pose.position, dtype=float))
    arm = RigidFrame(np.array(_ARM.motion([0.3], np.sin, np.cos).pose.rotation, dtype=float), np.zeros(3))
    body = frame(ON, VALUES) @ arm @ frame(AT, VALUES) @ moved @ frame(ON, VALUES).inverse()
    return [*body.position, *roll_pitch_yaw(body.rotation)]


def roll_pitch_yaw(R: Any) -> list[float]:
    """psi, theta, phi with R = Rz(phi) Ry(theta) Rx(psi)."""
    return [float(np.arctan2(R[2, 1], R[2, 2])), float(-np.arcsin(R[2, 0])), float(np.arctan2(R[1, 0], R[0, 0]))]


def twin_coordinates(R: Any, p: Any, omega: Any, velocity: Any) -> tuple[list[float], list[float]]:
    """Coordinates of the free body and their rates, from its pose and velocities in the ground frame."""
    psi, theta, phi = roll_pitch_yaw(R)
    axes = np.array(
        [
            [np.cos(theta) * np.cos(phi), -np.sin(phi), 0],
            [np.cos(theta) * np.sin(phi), np.cos(phi), 0],
            [-np.sin(theta), 0, 1],
        ]
    )
    return [*p, psi, theta, phi], [*velocity, *np.linalg.solve(axes, omega)]


# -- constraints ------------------------------------------------------------------------------------------------

_PLANE = ("x", "y", "phi")
TILTED = Placement((0.1, -0.2, 0.3), (Rotation("x", degrees=20), Rotation("y", degrees=-10)))

#: Constraints with the joints that they need: "pair" two hinges in a row, "plane" a planar joint, "quaternion" a
#: body with Euler parameters; and a home.
CONSTRAINTS: Mapping[str, tuple[AbstractConstraint, str, Mapping[str, Any]]] = {
    "Coupling": (Coupling("gear", "b", "a", "-3*p", 0.1), "pair", {"b": 0.1}),
    "Driver": (Driver("drive", "a", "p*sin(2*t) + t^2/3"), "pair", {}),
    "Holonomic": (Holonomic("track", ("x*cos(phi) + y - p + 0.1*sin(3*t)",)), "plane", {"y": "p"}),
    "Nonholonomic": (Nonholonomic("slip", ("x_dot*sin(phi) - (2 + t)*y_dot + p*phi_dot - 0.3*cos(t)",)), "plane", {}),
    "RollingDisc": (RollingDisc("rolling", "body", "p", ON, "x", TILTED), "quaternion", {"z": "p"}),
    "KnifeEdge": (KnifeEdge("blade", "body", ON, "-y"), "quaternion", {}),
    "KnifeEdge in a plane": (KnifeEdge("blade", "body", ON, "x"), "plane", {}),
}


def _base(kind: str) -> tuple[AbstractTreeJoint, ...]:
    """Tree joints that hold "body", and "arm" on it."""
    arm = Revolute("tip", "body", "arm", ("b",), AT, axis="y")
    return {
        "pair": (Revolute("root", GROUND, "body", ("a",), AT, axis="-x"), arm),
        "plane": (Planar("table", GROUND, "body", _PLANE, AT), arm),
        "quaternion": (FreeQuaternion("free", GROUND, "body", QUATERNION), arm),
    }[kind]


def constrained(name: str) -> Mechanism:
    """Two bodies and one constraint."""
    constraint, base, home = CONSTRAINTS[name]
    return Mechanism(
        name=f"constraint_{name.replace(' ', '_')}",
        bodies=(body_of("body"), body_of("arm", 0.5)),
        joints=_base(base),
        constraints=(constraint,),
        actuators=(Actuator("motor", "b"),),
        parameters=PARAMETERS,
        gravity=GRAVITY,
        home=home,
    )


# -- loads ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Flywheel(AbstractLoad):
    """A load of somebody's own: kinetic energy of a fast rotor on a body and of a point mass there."""

    body: str = "body"

    def kinetic(self, motion: Kinematics) -> Any:
        """p (omega_y + 2 z')^2 / 2 + p |v|^2 / 3, with v of a point of the body."""
        turning = motion.spin(self.body)[1] + 2 * motion.rate("z")
        v = motion.velocity(self.body, motion.triple((0.1, "p", 0)))
        p = motion.scalar("p")
        return p * (turning * turning) / 2 + p * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 3


_ENDS = (GROUND, (0.5, "p", 0.1), "arm", (0.05, 0.1, 0.2))

#: Loads on a body with Euler parameters and an arm.
LOADS: Mapping[str, AbstractLoad] = {
    "Spring": Spring("spring", *_ENDS, stiffness="300*p", length=0.25, damping="10*p"),
    "Spring without length": Spring("spring", *_ENDS, stiffness="300*p"),
    "Spring between bodies": Spring("spring", "body", (0.3, 0, 0), "arm", (0.1, 0.2, 0), "40*p", 0.1, "p"),
    "CoordinateSpring": CoordinateSpring("hinge", "b", "30*p", -0.4, "5*p"),
    "Friction": Friction("friction", "b", "2*p", "p", 0.3),
    "Wrench": Wrench("wind", "arm", (0.1, "p", 0), ("20*p*sin(3*t)", "x_dot*e2", 1), ("b", -2, "z")),
    "Wrench in body axes": Wrench("jet", "arm", (0.1, "p", 0), (3, "30*p", "cos(t)"), (0, "b_dot", 0.5), "body"),
    "Energy": Energy("own", "20*p*x^2*cos(b) + sqrt(2 + e1)", "p*(b_dot + y_dot*sin(b) + e1*z_dot)^2/2 + x_dot^2/5"),
    "Flywheel": Flywheel("rotor"),
}


def loaded(name: str) -> Mechanism:
    """Two bodies and one load."""
    return Mechanism(
        name=f"load_{name.replace(' ', '_')}",
        bodies=(body_of("body"), body_of("arm", 0.5)),
        joints=_base("quaternion"),
        loads=(LOADS[name],),
        actuators=(Actuator("motor", "b"),),
        parameters=PARAMETERS,
        gravity=GRAVITY,
    )
