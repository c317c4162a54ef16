"""Rigid bodies and where things are placed on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from nullbody.typing import Scalar, Triple

__all__ = ["AXES", "GROUND", "Axis", "Body", "Placement", "Rotation"]

#: The name of the fixed body.
GROUND = "ground"

Axis = Literal["x", "y", "z", "-x", "-y", "-z"]

#: All axes.
AXES: tuple[str, ...] = get_args(Axis)


@dataclass(frozen=True)
class Rotation:
    """A fixed rotation about an axis of the current frame.

    Exactly one of the two angles is given: `degrees` (a number; multiples of 15 are exact) or `radians`
    (an expression in parameters).
    """

    axis: Axis
    degrees: int | float | None = None
    radians: Scalar | None = None


@dataclass(frozen=True)
class Placement:
    """A frame fixed in another one: first moved to `position` [m], then rotated, each about the new axes."""

    position: Triple = (0, 0, 0)
    rotations: tuple[Rotation, ...] = ()


@dataclass(frozen=True)
class Body:
    """A rigid body.

    Attributes:
        name: unique among the bodies; "ground" is the fixed one and is not listed.
        mass: [kg]
        centre: centre of mass in the body's frame [m].
        inertia: (Ixx, Iyy, Izz) or (Ixx, Iyy, Izz, Ixy, Ixz, Iyz) about the centre of mass, in the body's
            axes [kg m^2]; the last three are entries of the matrix, products of inertia with their sign.
    """

    name: str
    mass: Scalar = 0
    centre: Triple = (0, 0, 0)
    inertia: tuple[Scalar, ...] = (0, 0, 0)

    @property
    def inertia_matrix(self) -> tuple[tuple[Scalar, ...], ...]:
        """The symmetric 3 x 3 matrix of scalars."""
        xx, yy, zz = self.inertia[:3]
        xy, xz, yz = self.inertia[3:] or (0, 0, 0)
        return ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
