"""What a joint of the spanning tree and a loop joint must provide. A new joint type is one file in this folder."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from nullbody.mechanism.body import Axis, Placement
from nullbody.typing import Triple

__all__ = ["AbstractLoopJoint", "AbstractTreeJoint", "Motion", "Pose", "Trig", "axis_vector", "elementary_rotation"]

#: sine or cosine of the scalar type in use.
Trig = Callable[[Any], Any]


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
class AbstractTreeJoint(ABC):
    """A joint of the spanning tree: it gives the child its pose from the joint's own coordinates.

    Attributes:
        name: unique among all joints.
        parent: a body, or "ground".
        child: the body that this joint carries.
        coordinates: names of its coordinates, `size` of them.
        at: the joint's frame in the parent's; the child's frame coincides with it where all coordinates are 0.
    """

    name: str
    parent: str
    child: str
    coordinates: tuple[str, ...]
    at: Placement = field(default_factory=Placement)

    size: ClassVar[int]
    units: ClassVar[tuple[str, ...]]

    @abstractmethod
    def motion(self, q: Sequence[Any], sin: Trig, cos: Trig) -> Motion:
        """The child's motion for coordinates q, in any scalar type."""


@dataclass(frozen=True)
class AbstractLoopJoint(ABC):
    """A joint that closes a loop: equations between two bodies that already have their poses.

    Attributes:
        name: unique among all joints.
        body_a, point_a: one side, the point in that body's frame [m].
        body_b, point_b: the other side.
    """

    name: str
    body_a: str
    point_a: Triple
    body_b: str
    point_b: Triple

    rows: ClassVar[tuple[str, ...]]

    @abstractmethod
    def closure(self, point_a: Sequence[Any], point_b: Sequence[Any]) -> list[Any]:
        """The residuals Phi, zero when the loop is closed, from both points in the ground frame [m]."""


def axis_vector(axis: Axis) -> tuple[int, int, int]:
    """The unit vector of "x", "-x", ..."""
    sign = -1 if axis.startswith("-") else 1
    x, y, z = (sign * (axis[-1] == letter) for letter in "xyz")
    return x, y, z


def elementary_rotation(axis: Axis, s: Any, c: Any) -> list[list[Any]]:
    """Rotation matrix about an axis, from the sine and cosine of the angle."""
    if axis.startswith("-"):
        s = -s
    if axis[-1] == "x":
        return [[1, 0, 0], [0, c, -s], [0, s, c]]
    if axis[-1] == "y":
        return [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    return [[c, -s, 0], [s, c, 0], [0, 0, 1]]
