"""What a joint must provide, in the spanning tree and where it closes a loop. A new joint type is one file here."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from nullbody.expr.matrix import add, dot, scale
from nullbody.mechanism.body import Axis, Placement
from nullbody.typing import Scalar

__all__ = [
    "AbstractJoint",
    "AbstractLoopJoint",
    "AbstractTreeJoint",
    "Motion",
    "Pose",
    "ScalarReader",
    "Trig",
    "axis_vector",
    "column",
    "difference",
    "elementary_rotation",
    "same_axis",
    "tilts",
    "transverse",
]

#: sine or cosine of the scalar type in use.
Trig = Callable[[Any], Any]

#: Turns a scalar of a mechanism (a number or a text in parameters) into the scalar type in use.
ScalarReader = Callable[[Scalar], Any]


@dataclass(frozen=True)
class Pose:
    """Rotation matrix (rows) and position of one frame in another, in any scalar type."""

    rotation: Sequence[Sequence[Any]]
    position: Sequence[Any]


@dataclass(frozen=True)
class Motion:
    """How a child moves in its joint's frame on the parent.

    Attributes:
        pose: of the child.
        angular: for every coordinate, the child's angular velocity per unit rate, in the child's axes [rad/s].
        linear: for every coordinate, the velocity of the child's origin per unit rate, in the joint's axes [m/s].
    """

    pose: Pose
    angular: Sequence[Sequence[Any]]
    linear: Sequence[Sequence[Any]]


@dataclass(frozen=True)
class AbstractJoint(ABC):
    """A joint between two bodies.

    Attributes:
        name: unique among all joints.
        parent: a body, or "ground".
        child: another body.
        coordinates: names of its coordinates in the spanning tree; none where it closes a loop.
        at: the joint's frame on the parent, in the parent's axes.
        on: the joint's frame on the child, in the child's axes; the two coincide where all coordinates are zero.
    """

    name: str
    parent: str
    child: str
    coordinates: tuple[str, ...] = ()
    at: Placement = field(default_factory=Placement)
    on: Placement = field(default_factory=Placement)


@dataclass(frozen=True)
class AbstractTreeJoint(AbstractJoint):
    """A joint that can stand in the spanning tree: it gives the child its pose from the joint's own coordinates.

    Attributes:
        units: of the coordinates; "" for Euler parameters.
        zero: coordinates at which both frames coincide.
        own_rows: names of equations that its coordinates must fulfil among themselves.
    """

    units: ClassVar[tuple[str, ...]]
    zero: ClassVar[tuple[float, ...]]
    own_rows: ClassVar[tuple[str, ...]] = ()

    @abstractmethod
    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """The motion of the frame on the child for coordinates q, in any scalar type."""

    def own_closure(self, q: Sequence[Any]) -> list[Any]:
        """The residuals of `own_rows`; none for most joints."""
        return []


@dataclass(frozen=True)
class AbstractLoopJoint(AbstractJoint):
    """A joint that can close a loop: equations between two bodies that already have their poses.

    Attributes:
        rows: names of its equations.
        row_units: "m" for a gap, "rad" for a tilt.
    """

    rows: ClassVar[tuple[str, ...]]
    row_units: ClassVar[tuple[str, ...]]

    @property
    def signs(self) -> tuple[tuple[str, Scalar, str], ...]:
        """(what, scalar, "positive" or "non-negative") of scalars that must not be of another sign."""
        return ()

    @abstractmethod
    def closure(self, a: Pose, b: Pose, scalar: ScalarReader) -> list[Any]:
        """The residuals Phi, zero when the loop is closed, from the joint's frames on parent and child in the ground
        frame: gaps are a - b [m], tilts cosines of angles that are right angles.
        """

    def facing(self, a: Pose, b: Pose) -> list[Any]:
        """Cosines that are positive where the loop is closed the right way round, not with an axis reversed."""
        return []


def axis_vector(axis: Axis) -> tuple[int, int, int]:
    """The unit vector of "x", "-x", ..."""
    sign = -1 if axis.startswith("-") else 1
    x, y, z = (sign * (axis[-1] == letter) for letter in "xyz")
    return x, y, z


def transverse(axis: Axis) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    """Unit vectors u, w with u x w = axis: the next two axes of x, y, z, x, y; swapped for a negative axis."""
    k = "xyz".index(axis[-1])
    u, w = axis_vector("yzx"[k]), axis_vector("zxy"[k])  # type: ignore[arg-type]
    return (w, u) if axis.startswith("-") else (u, w)


def column(pose: Pose, direction: Sequence[int]) -> list[Any]:
    """A direction of a frame in the ground frame: R direction."""
    return [dot(row, direction) for row in pose.rotation]


def difference(a: Pose, b: Pose) -> list[Any]:
    """p_a - p_b in the ground frame [m]."""
    return add(a.position, scale(-1, b.position))


def tilts(a: Pose, b: Pose, axis: Axis) -> list[Any]:
    """w_a . n_b and -u_a . n_b: minus the small tilts of the axis n of b against a about u and w."""
    u, w = transverse(axis)
    normal = column(b, axis_vector(axis))
    return [dot(column(a, w), normal), -dot(column(a, u), normal)]


def same_axis(a: Pose, b: Pose, axis: Axis) -> list[Any]:
    """n_a . n_b"""
    return [dot(column(a, axis_vector(axis)), column(b, axis_vector(axis)))]


def elementary_rotation(axis: Axis, s: Any, c: Any) -> list[list[Any]]:
    """Rotation matrix about an axis, from the sine and cosine of the angle."""
    if axis.startswith("-"):
        s = -s
    if axis[-1] == "x":
        return [[1, 0, 0], [0, c, -s], [0, s, c]]
    if axis[-1] == "y":
        return [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    return [[c, -s, 0], [s, c, 0], [0, 0, 1]]
