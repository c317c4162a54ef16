"""What constraints and loads may ask about a mechanism in motion, in any scalar type."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from nullbody.mechanism.body import Placement
from nullbody.mechanism.joints.base import Pose
from nullbody.typing import Scalar, Triple

__all__ = ["Kinematics"]


class Kinematics(Protocol):
    """Poses and velocities of a mechanism at q, q' and t. All vectors are in the ground frame."""

    def scalar(self, source: Scalar) -> Any:
        """A number or a text in parameters."""

    def expression(self, source: Scalar) -> Any:
        """A number or a text in parameters, coordinates, their rates (`s1_dot`) and the time t."""

    def coordinate(self, name: str) -> Any:
        """A coordinate by name [m, rad]."""

    def rate(self, name: str) -> Any:
        """Its rate [m/s, rad/s]."""

    def frame(self, body: str, place: Placement) -> Pose:
        """A frame that is fixed on a body."""

    def velocity(self, body: str, local: Sequence[Any]) -> list[Any]:
        """The velocity of a point of a body, given in the body's frame in the scalar type in use [m/s]."""

    def spin(self, body: str) -> list[Any]:
        """The angular velocity of a body [rad/s]."""

    def triple(self, source: Triple) -> list[Any]:
        """Three scalars."""

    def sqrt(self, value: Any) -> Any:
        """The square root."""
