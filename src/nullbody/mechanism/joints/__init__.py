"""The joints, one file each."""

from nullbody.mechanism.joints.base import AbstractJoint, AbstractLoopJoint, AbstractTreeJoint, Motion, Pose
from nullbody.mechanism.joints.cylindrical import Cylindrical
from nullbody.mechanism.joints.free import Free, FreeQuaternion
from nullbody.mechanism.joints.planar import Planar
from nullbody.mechanism.joints.point import Distance, PointOnLine, PointOnPlane
from nullbody.mechanism.joints.prismatic import Prismatic
from nullbody.mechanism.joints.revolute import Revolute
from nullbody.mechanism.joints.spherical import Spherical
from nullbody.mechanism.joints.universal import Universal
from nullbody.mechanism.joints.weld import Weld

__all__ = [
    "AbstractJoint",
    "AbstractLoopJoint",
    "AbstractTreeJoint",
    "Cylindrical",
    "Distance",
    "Free",
    "FreeQuaternion",
    "Motion",
    "Planar",
    "PointOnLine",
    "PointOnPlane",
    "Pose",
    "Prismatic",
    "Revolute",
    "Spherical",
    "Universal",
    "Weld",
]
