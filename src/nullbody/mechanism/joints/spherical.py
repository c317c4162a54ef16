"""Spherical joint: two points coincide, and the child turns freely about them, without a singular pose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.mechanism.joints.base import (
    AbstractLoopJoint,
    AbstractTreeJoint,
    Motion,
    Pose,
    ScalarReader,
    Trig,
    difference,
)

__all__ = ["Spherical", "euler_parameter_motion", "norm_residual"]


@dataclass(frozen=True)
class Spherical(AbstractTreeJoint, AbstractLoopJoint):
    """Point a of the parent and point b of the child coincide.

    Closing a loop: Phi = a - b = 0, three equations [26]. In a planar mechanism this is the loop's revolute joint: the
    equation across the plane repeats 0 = 0 and is left out by `derive`.

    In the spanning tree: four Euler parameters e0, e1, e2, e3 with |e| = 1 (a closure "norm"), no gimbal lock.
    """

    units: ClassVar[tuple[str, ...]] = ("", "", "", "")
    zero: ClassVar[tuple[float, ...]] = (1, 0, 0, 0)
    own_rows: ClassVar[tuple[str, ...]] = ("norm",)
    rows: ClassVar[tuple[str, ...]] = ("x", "y", "z")
    row_units: ClassVar[tuple[str, ...]] = ("m", "m", "m")

    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """R(e), omega = 2 G(e) e'."""
        rotation, angular = euler_parameter_motion(q)
        return Motion(Pose(rotation, [0, 0, 0]), angular, [[0, 0, 0]] * 4)

    def own_closure(self, q: Sequence[Any]) -> list[Any]:
        """(e . e - 1) / 2"""
        return [norm_residual(q)]

    def closure(self, a: Pose, b: Pose, scalar: ScalarReader) -> list[Any]:
        """Phi = a - b [m]."""
        return difference(a, b)


def euler_parameter_motion(e: Sequence[Any]) -> tuple[list[list[Any]], list[list[Any]]]:
    """R(e) of Euler parameters e0 + i e1 + j e2 + k e3 with |e| = 1, and the columns of 2 G(e), omega = 2 G e'.

    omega in the child's axes. Source: Nikravesh, Computer-Aided Analysis of Mechanical Systems (1988), chapter 6.
    """
    e0, e1, e2, e3 = e
    rotation = [
        [1 - 2 * (e2 * e2 + e3 * e3), 2 * (e1 * e2 - e0 * e3), 2 * (e1 * e3 + e0 * e2)],
        [2 * (e1 * e2 + e0 * e3), 1 - 2 * (e1 * e1 + e3 * e3), 2 * (e2 * e3 - e0 * e1)],
        [2 * (e1 * e3 - e0 * e2), 2 * (e2 * e3 + e0 * e1), 1 - 2 * (e1 * e1 + e2 * e2)],
    ]
    angular = [
        [-2 * e1, -2 * e2, -2 * e3],
        [2 * e0, -2 * e3, 2 * e2],
        [2 * e3, 2 * e0, -2 * e1],
        [-2 * e2, 2 * e1, 2 * e0],
    ]
    return rotation, angular


def norm_residual(e: Sequence[Any]) -> Any:
    """(e . e - 1) / 2, whose gradient is e."""
    e0, e1, e2, e3 = e
    return (e0 * e0 + e1 * e1 + e2 * e2 + e3 * e3 - 1) * 0.5
