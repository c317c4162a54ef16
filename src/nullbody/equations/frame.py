"""Frames of all bodies: poses in the ground frame and velocities in the body's own axes.

For a child on a parent with the joint's frame (R_J, p_J) and the motion (R_q, p_q), in the parent's axes:

    R_rel = R_J R_q,  p_rel = p_J + R_J p_q
    omega = R_rel^T omega_parent + (joint's angular rates)                              child's axes [rad/s]
    V     = R_rel^T (V_parent + omega_parent x p_rel) + R_q^T (joint's linear rates)    child's axes [m/s]

The child's frame is that of the joint, moved back by the joint's placement on the child (R_on, p_on):

    R_child = R R_on^T,  p_child = p - R_child p_on,  omega_child = R_on omega,  V_child = R_on V + p_on x omega_child

Both are linear in q': each body keeps one column (omega, V) for each coordinate that moves it, which is what
keeps M nearly block-diagonal (theory 3: each body in its own coordinates).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from nullbody.equations.scalar import ParameterScalars
from nullbody.expr import Expr, cos, sin
from nullbody.expr.matrix import add, cross, matmul, matvec, scale, transpose
from nullbody.mechanism import GROUND, AbstractTreeJoint, Mechanism, Placement, Pose

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
    """The frame of the child: that of the joint on it, and back by the placement `on`."""
    moving = _joint_frame(joint, parent, scalars, q)
    if joint.on == Placement():
        return moving
    turn, shift = scalars.rotation(joint.on), scalars.triple(joint.on.position)
    rotation = matmul(moving.pose.rotation, transpose(turn))
    position = add(moving.pose.position, scale(-1, matvec(rotation, shift)))
    columns = {}
    for name, (angular, linear) in moving.columns.items():
        turned = matvec(turn, angular)
        columns[name] = (turned, add(matvec(turn, linear), cross(shift, turned)))
    return Frame(Pose(rotation, position), columns)


def _joint_frame(joint: AbstractTreeJoint, parent: Frame, scalars: ParameterScalars, q: Mapping[str, Expr]) -> Frame:
    """The frame of the joint on the child."""
    motion = joint.motion([q[name] for name in joint.coordinates], sin, cos)
    joint_rotation = scalars.rotation(joint.at)
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
