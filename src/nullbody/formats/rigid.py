"""A mechanism in numbers, as other tools want it: frames, masses and joints of one coordinate each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
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
    Free,
    Placement,
    Prismatic,
    Revolute,
    Spherical,
)
from nullbody.mechanism.joints.base import axis_vector, elementary_rotation
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
    """A joint of one coordinate: it slides along, or turns about, an axis of the frame that the steps before it moved.

    Attributes:
        coordinate: its name.
        kind: "slide" [m] or "hinge" [rad].
        axis: unit vector.
    """

    coordinate: str
    kind: Literal["slide", "hinge"]
    axis: tuple[int, int, int]


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
    """The two points that a loop joint keeps together, each in its own body's frame [m].

    Raises:
        MechanismError: a type of loop joint that does more than that.
    """
    if not isinstance(loop, Spherical):
        raise MechanismError(
            f"loop {loop.name!r} is a {type(loop).__name__}, which cannot be written for another engine; "
            "known: Spherical"
        )
    return triple(loop.point_a, values), triple(loop.point_b, values)


def steps(joint: AbstractTreeJoint) -> tuple[Step, ...]:
    """A joint as a chain of slides and hinges with the same coordinates, from the parent to the child.

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


def _free_steps(joint: Any) -> tuple[Step, ...]:
    """p = (x, y, z), R = Rz(phi) Ry(theta) Rx(psi): the yaw phi is nearest to the parent."""
    x, y, z, psi, theta, phi = joint.coordinates
    slides = (Step(x, "slide", (1, 0, 0)), Step(y, "slide", (0, 1, 0)), Step(z, "slide", (0, 0, 1)))
    return (*slides, Step(phi, "hinge", (0, 0, 1)), Step(theta, "hinge", (0, 1, 0)), Step(psi, "hinge", (1, 0, 0)))


_STEPS: Mapping[type[AbstractTreeJoint], Callable[[Any], tuple[Step, ...]]] = {
    Free: _free_steps,
    Revolute: lambda joint: (Step(joint.coordinates[0], "hinge", axis_vector(joint.axis)),),
    Prismatic: lambda joint: (Step(joint.coordinates[0], "slide", axis_vector(joint.axis)),),
}
