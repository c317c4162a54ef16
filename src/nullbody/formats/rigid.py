"""A mechanism in numbers, as other tools want it: frames, masses, and joints as chains of slides, hinges and balls."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import cos, radians, sin
from typing import Any, Literal

import numpy as np

from nullbody.errors import MechanismError
from nullbody.expr.parse import parse
from nullbody.mechanism import (
    AbstractLoopJoint,
    AbstractTreeJoint,
    Body,
    Cylindrical,
    Free,
    FreeQuaternion,
    Placement,
    Planar,
    Prismatic,
    Revolute,
    Spherical,
    Universal,
    Weld,
)
from nullbody.mechanism.joints.base import axis_vector, elementary_rotation, transverse
from nullbody.typing import FloatArray, Scalar, Triple

__all__ = ["RigidFrame", "Step", "frame", "loop_points", "mass_properties", "number", "steps", "triple"]


@dataclass(frozen=True)
class RigidFrame:
    """A frame in another one: x_outer = rotation x_inner + position.

    Attributes:
        rotation: 3 x 3, orthogonal.
        position: of the inner origin [m].
    """

    rotation: FloatArray
    position: FloatArray

    def __matmul__(self, inner: RigidFrame) -> RigidFrame:
        return RigidFrame(self.rotation @ inner.rotation, self.rotation @ inner.position + self.position)

    def inverse(self) -> RigidFrame:
        """The outer frame in the inner one."""
        return RigidFrame(self.rotation.T, -self.rotation.T @ self.position)


@dataclass(frozen=True)
class Step:
    """A joint of one kind of motion: it slides along, or turns about, an axis of the frame that the steps before it
    moved, or it turns freely about the origin of that frame.

    Attributes:
        coordinates: the name of its coordinate; of its four Euler parameters e0, e1, e2, e3 for a ball.
        kind: "slide" [m], "hinge" [rad] or "ball".
        axis: unit vector; of no meaning for a ball.
    """

    coordinates: tuple[str, ...]
    kind: Literal["slide", "hinge", "ball"]
    axis: tuple[int, int, int] = (0, 0, 1)

    @property
    def coordinate(self) -> str:
        """The coordinate; of a ball the first one."""
        return self.coordinates[0]


def number(source: Scalar, values: Mapping[str, float]) -> float:
    """The value of a scalar for given parameter values."""
    return float(parse(source, values.__getitem__))


def triple(source: Triple, values: Mapping[str, float]) -> FloatArray:
    """The values of three components."""
    return np.array([number(component, values) for component in source])


def frame(placement: Placement, values: Mapping[str, float]) -> RigidFrame:
    """A placement in numbers: moved first, then rotated about the new axes."""
    rotation = np.eye(3)
    for turn in placement.rotations:
        angle = radians(float(turn.degrees or 0)) if turn.radians is None else number(turn.radians, values)
        rotation = rotation @ np.array(elementary_rotation(turn.axis, sin(angle), cos(angle)), dtype=float)
    return RigidFrame(rotation, triple(placement.position, values))


def mass_properties(body: Body, values: Mapping[str, float]) -> tuple[float, FloatArray, FloatArray]:
    """Mass [kg], centre of mass in the body's frame [m], inertia about it in the body's axes [kg m^2, 3 x 3]."""
    inertia = np.array([[number(entry, values) for entry in row] for row in body.inertia_matrix])
    return number(body.mass, values), triple(body.centre, values), inertia


def loop_points(loop: AbstractLoopJoint, values: Mapping[str, float]) -> tuple[FloatArray, FloatArray]:
    """The two points that a spherical loop joint keeps together, each in its own body's frame [m].

    Raises:
        MechanismError: a type of loop joint that does more than that.
    """
    if not isinstance(loop, Spherical):
        raise MechanismError(
            f"loop {loop.name!r} is a {type(loop).__name__}, which cannot be written for another engine; "
            "known: Spherical"
        )
    return triple(loop.at.position, values), triple(loop.on.position, values)


def steps(joint: AbstractTreeJoint) -> tuple[Step, ...]:
    """A joint as a chain of slides, hinges and balls with the same coordinates, from the parent to the child.

    The chain begins at the joint's frame on the parent (`at`) and ends at its frame on the child (`on`).

    Raises:
        MechanismError: a type of joint that has no such chain here.
    """
    for kind, made in _STEPS.items():
        if isinstance(joint, kind):
            return made(joint)
    known = ", ".join(kind.__name__ for kind in _STEPS)
    raise MechanismError(
        f"joint {joint.name!r} is a {type(joint).__name__}, which cannot be written for another engine; known: {known}"
    )


_X, _Y, _Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


def _slides(names: Sequence[str]) -> tuple[Step, ...]:
    """p = (x, y, z)"""
    return tuple(Step((name,), "slide", axis) for name, axis in zip(names, (_X, _Y, _Z), strict=True))


def _free_steps(joint: Any) -> tuple[Step, ...]:
    """p = (x, y, z), R = Rz(phi) Ry(theta) Rx(psi): the yaw phi is nearest to the parent."""
    psi, theta, phi = joint.coordinates[3:]
    turns = (Step((phi,), "hinge", _Z), Step((theta,), "hinge", _Y), Step((psi,), "hinge", _X))
    return (*_slides(joint.coordinates[:3]), *turns)


def _planar_steps(joint: Any) -> tuple[Step, ...]:
    """p = u e_u + w e_w, then R_axis(alpha)."""
    along = zip(joint.coordinates[:2], transverse(joint.axis), strict=True)
    slides = tuple(Step((name,), "slide", axis) for name, axis in along)
    return (*slides, Step(joint.coordinates[2:], "hinge", axis_vector(joint.axis)))


def _cylindrical_steps(joint: Any) -> tuple[Step, ...]:
    """p = s axis, then R_axis(alpha)."""
    s, alpha = joint.coordinates
    axis = axis_vector(joint.axis)
    return (Step((s,), "slide", axis), Step((alpha,), "hinge", axis))


def _universal_steps(joint: Any) -> tuple[Step, ...]:
    """R_axis(alpha), then R_axis2(beta)."""
    alpha, beta = joint.coordinates
    return (Step((alpha,), "hinge", axis_vector(joint.axis)), Step((beta,), "hinge", axis_vector(joint.axis2)))


_STEPS: Mapping[type[AbstractTreeJoint], Callable[[Any], tuple[Step, ...]]] = {
    Free: _free_steps,
    FreeQuaternion: lambda joint: (*_slides(joint.coordinates[:3]), Step(joint.coordinates[3:], "ball")),
    Revolute: lambda joint: (Step(joint.coordinates, "hinge", axis_vector(joint.axis)),),
    Prismatic: lambda joint: (Step(joint.coordinates, "slide", axis_vector(joint.axis)),),
    Cylindrical: _cylindrical_steps,
    Universal: _universal_steps,
    Planar: _planar_steps,
    Spherical: lambda joint: (Step(joint.coordinates, "ball"),),
    Weld: lambda joint: (),
}
