"""The joints, one file each."""

from nullbody.mechanism.joints.base import AbstractLoopJoint, AbstractTreeJoint, Motion, Pose
from nullbody.mechanism.joints.free import Free
from nullbody.mechanism.joints.prismatic import Prismatic
from nullbody.mechanism.joints.revolute import Revolute
from nullbody.mechanism.joints.spherical import Spherical

__all__ = ["AbstractLoopJoint", "AbstractTreeJoint", "Free", "Motion", "Pose", "Prismatic", "Revolute", "Spherical"]
