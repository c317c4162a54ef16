"""Layer 3: mechanisms as data: bodies, joints, loops, constraints, loads, actuators, parameters."""

from nullbody.mechanism.body import GROUND, Body, Placement, Rotation
from nullbody.mechanism.builder import MechanismBuilder
from nullbody.mechanism.constraints import (
    AbstractConstraint,
    Coupling,
    Driver,
    Holonomic,
    KnifeEdge,
    Nonholonomic,
    RollingDisc,
)
from nullbody.mechanism.fingerprint import fingerprint
from nullbody.mechanism.joints import (
    AbstractJoint,
    AbstractLoopJoint,
    AbstractTreeJoint,
    Cylindrical,
    Distance,
    Free,
    FreeQuaternion,
    Motion,
    Planar,
    PointOnLine,
    PointOnPlane,
    Pose,
    Prismatic,
    Revolute,
    Spherical,
    Universal,
    Weld,
)
from nullbody.mechanism.kinematics import Kinematics
from nullbody.mechanism.loads import AbstractLoad, CoordinateSpring, Energy, Friction, Spring, Wrench
from nullbody.mechanism.mechanism import Actuator, Mechanism
from nullbody.mechanism.parameter import Parameter

__all__ = [
    "GROUND",
    "AbstractConstraint",
    "AbstractJoint",
    "AbstractLoad",
    "AbstractLoopJoint",
    "AbstractTreeJoint",
    "Actuator",
    "Body",
    "CoordinateSpring",
    "Coupling",
    "Cylindrical",
    "Distance",
    "Driver",
    "Energy",
    "Free",
    "FreeQuaternion",
    "Friction",
    "Holonomic",
    "Kinematics",
    "KnifeEdge",
    "Mechanism",
    "MechanismBuilder",
    "Motion",
    "Nonholonomic",
    "Parameter",
    "Placement",
    "Planar",
    "PointOnLine",
    "PointOnPlane",
    "Pose",
    "Prismatic",
    "Revolute",
    "RollingDisc",
    "Rotation",
    "Spherical",
    "Spring",
    "Universal",
    "Weld",
    "Wrench",
    "fingerprint",
]
