"""Free joint: position and roll-pitch-yaw angles of a body that only loops hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.expr.matrix import matmul
from nullbody.mechanism.joints.base import AbstractTreeJoint, Motion, Pose, Trig, elementary_rotation

__all__ = ["Free"]


@dataclass(frozen=True)
class Free(AbstractTreeJoint):
    """Six coordinates x, y, z [m], psi, theta, phi [rad]: R = Rz(phi) Ry(theta) Rx(psi) [24].

    The angles are singular at theta = +-90 degrees.
    """

    size: ClassVar[int] = 6
    units: ClassVar[tuple[str, ...]] = ("m", "m", "m", "rad", "rad", "rad")

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """p = (x, y, z); the angular velocity in the body's axes is E (psi', theta', phi')."""
        psi, theta, phi = q[3:]
        s_psi, c_psi, s_theta, c_theta = sin(psi), cos(psi), sin(theta), cos(theta)
        rotation = matmul(
            matmul(elementary_rotation("z", sin(phi), cos(phi)), elementary_rotation("y", s_theta, c_theta)),
            elementary_rotation("x", s_psi, c_psi),
        )
        none = [0, 0, 0]
        angular = [none, none, none, [1, 0, 0], [0, c_psi, -s_psi], [-s_theta, s_psi * c_theta, c_psi * c_theta]]
        linear = [[1, 0, 0], [0, 1, 0], [0, 0, 1], none, none, none]
        return Motion(Pose(rotation, list(q[:3])), angular, linear)
