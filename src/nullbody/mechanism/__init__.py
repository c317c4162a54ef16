"""Layer 3: mechanisms as data: bodies, joints, loops, actuators, parameters."""

from nullbody.mechanism.body import GROUND, Body, Placement, Rotation
from nullbody.mechanism.joints import (
    AbstractLoopJoint,
    AbstractTreeJoint,
    Free,
    Motion,
    Pose,
    Prismatic,
    Revolute,
    Spherical,
)
from nullbody.mechanism.mechanism import Actuator, Mechanism
from nullbody.mechanism.parameter import Parameter

__all__ = [
    "GROUND",
    "AbstractLoopJoint",
    "AbstractTreeJoint",
    "Actuator",
    "Body",
    "Free",
    "Mechanism",
    "Motion",
    "Parameter",
    "Placement",
    "Pose",
    "Prismatic",
    "Revolute",
    "Rotation",
    "Spherical",
]
