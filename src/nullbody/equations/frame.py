"""Frames of all bodies: poses in the ground frame and velocities in the body's own axes.

For a child on a parent with the joint's frame (R_J, p_J) and the motion (R_q, p_q), in the parent's axes:

    R_rel = R_J R_q,  p_rel = p_J + R_J p_q
    omega = R_rel^T omega_parent + (joint's angular rates)                              child's axes [rad/s]
    V     = R_rel^T (V_parent + omega_parent x p_rel) + R_q^T (joint's linear rates)    child's axes [m/s]

Both are linear in q': each body keeps one column (omega, V) for each coordinate that moves it, which is what
keeps M nearly block-diagonal (theory 3: each body in its own coordinates).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from nullbody.equations.scalar import ParameterScalars
from nullbody.expr import Expr, cos, sin
from nullbody.expr.matrix import add, cross, matmul, matvec, transpose
from nullbody.mechanism import GROUND, AbstractTreeJoint, Mechanism, Pose
from nullbody.mechanism.joints.base import elementary_rotation

__all__ = ["Frame", "frames"]

_IDENTITY = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


@dataclass(frozen=True)
class Frame:
    """The frame of one body.

    Attributes:
        pose: in the ground frame.
        columns: for each coordinate that moves the body, the angular velocity and the velocity of the
            frame's origin per unit rate, both in the body's axes.
    """

    pose: Pose
    columns: Mapping[str, tuple[list[Any], list[Any]]]

    def point(self, local: list[Any]) -> list[Any]:
        """A point of the body in the ground frame: p + R local [m]."""
        return add(self.pose.position, matvec(self.pose.rotation, local))


def frames(mechanism: Mechanism, scalars: ParameterScalars, q: Mapping[str, Expr]) -> dict[str, Frame]:
    """The frames of all bodies and the ground, for coordinates q."""
    found = {GROUND: Frame(Pose(_IDENTITY, (0, 0, 0)), {})}
    for joint in mechanism.tree_order():
        found[joint.child] = _child_frame(joint, found[joint.parent], scalars, q)
    return found


def _child_frame(joint: AbstractTreeJoint, parent: Frame, scalars: ParameterScalars, q: Mapping[str, Expr]) -> Frame:
    motion = joint.motion([q[name] for name in joint.coordinates], sin, cos)
    joint_rotation: Any = _IDENTITY
    for fixed in joint.at.rotations:
        joint_rotation = matmul(joint_rotation, elementary_rotation(fixed.axis, *scalars.sine_cosine(fixed)))
    rotation = matmul(joint_rotation, motion.pose.rotation)
    position = add(scalars.triple(joint.at.position), matvec(joint_rotation, motion.pose.position))
    pose = Pose(
        matmul(parent.pose.rotation, rotation),
        add(parent.pose.position, matvec(parent.pose.rotation, position)),
    )
    back = transpose(rotation)
    columns = {}
    for name, (angular, linear) in parent.columns.items():
        columns[name] = (matvec(back, angular), matvec(back, add(linear, cross(angular, position))))
    own = transpose(motion.pose.rotation)
    for name, turn, move in zip(joint.coordinates, motion.angular, motion.linear, strict=True):
        columns[name] = (list(turn), matvec(own, move))
    return Frame(pose, columns)
