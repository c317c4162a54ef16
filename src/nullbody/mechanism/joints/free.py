"""Free joints: position and orientation of a body that only loops and loads hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.expr.matrix import matmul
from nullbody.mechanism.joints.base import AbstractTreeJoint, Motion, Pose, Trig, elementary_rotation
from nullbody.mechanism.joints.spherical import euler_parameter_motion, norm_residual

__all__ = ["Free", "FreeQuaternion"]

_NONE = [0, 0, 0]
_ALONG = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


@dataclass(frozen=True)
class Free(AbstractTreeJoint):
    """Six coordinates x, y, z [m], psi, theta, phi [rad]: R = Rz(phi) Ry(theta) Rx(psi) [24].

    The angles are singular at theta = +-90 degrees; `FreeQuaternion` has no such pose.
    """

    units: ClassVar[tuple[str, ...]] = ("m", "m", "m", "rad", "rad", "rad")
    zero: ClassVar[tuple[float, ...]] = (0, 0, 0, 0, 0, 0)

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """p = (x, y, z); the angular velocity in the body's axes is E (psi', theta', phi')."""
        psi, theta, phi = q[3:]
        s_psi, c_psi, s_theta, c_theta = sin(psi), cos(psi), sin(theta), cos(theta)
        rotation = matmul(
            matmul(elementary_rotation("z", sin(phi), cos(phi)), elementary_rotation("y", s_theta, c_theta)),
            elementary_rotation("x", s_psi, c_psi),
        )
        angular = [_NONE, _NONE, _NONE, [1, 0, 0], [0, c_psi, -s_psi], [-s_theta, s_psi * c_theta, c_psi * c_theta]]
        return Motion(Pose(rotation, list(q[:3])), angular, [*_ALONG, _NONE, _NONE, _NONE])


@dataclass(frozen=True)
class FreeQuaternion(AbstractTreeJoint):
    """Seven coordinates x, y, z [m] and Euler parameters e0, e1, e2, e3 with |e| = 1: no singular pose."""

    units: ClassVar[tuple[str, ...]] = ("m", "m", "m", "", "", "", "")
    zero: ClassVar[tuple[float, ...]] = (0, 0, 0, 1, 0, 0, 0)
    own_rows: ClassVar[tuple[str, ...]] = ("norm",)

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """p = (x, y, z), R(e), omega = 2 G(e) e'."""
        rotation, angular = euler_parameter_motion(q[3:])
        return Motion(
            Pose(rotation, list(q[:3])), [_NONE, _NONE, _NONE, *angular], [*_ALONG, _NONE, _NONE, _NONE, _NONE]
        )

    def own_closure(self, q: Sequence[Any]) -> list[Any]:
        """(e . e - 1) / 2"""
        return [norm_residual(q[3:])]
