"""Positions and orientations of MJCF, in all the ways in which they are written."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians
from typing import Any

import numpy as np

from nullbody.formats.rigid import RigidFrame
from nullbody.formats.xml_tree import XmlElement
from nullbody.mechanism import Placement
from nullbody.mechanism.builder import rotations_of
from nullbody.typing import FloatArray

__all__ = ["Angles", "about", "placement", "point", "pose", "quaternion_matrix"]

_ORIENTATIONS = ("quat", "axisangle", "euler", "xyaxes", "zaxis")
_SMALLEST = 1e-12  # length of a direction that can still be scaled to 1


@dataclass(frozen=True)
class Angles:
    """How a document writes angles.

    Attributes:
        degrees: whether they are in degrees.
        sequence: of Euler angles, such as "xyz"; capital letters turn about fixed axes.
    """

    degrees: bool = True
    sequence: str = "xyz"

    def radians(self, angle: float) -> float:
        """An angle in radians."""
        return radians(angle) if self.degrees else angle


def point(position: Any) -> RigidFrame:
    """A frame that is moved but not turned."""
    return RigidFrame(np.eye(3), np.asarray(position, float))


def about(axis: Any, angle: float) -> FloatArray:
    """The rotation by an angle about a unit vector: 1 + sin a [n] + (1 - cos a) [n]^2."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def quaternion_matrix(quaternion: Any) -> FloatArray:
    """The rotation of a unit quaternion (w, x, y, z)."""
    w, x, y, z = quaternion
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def placement(frame: RigidFrame) -> Placement:
    """A frame in numbers as a placement; rotations by multiples of 15 degrees become exact ones."""
    x, y, z = (float(component) + 0.0 for component in frame.position)
    return Placement((x, y, z), rotations_of(frame.rotation.tolist()))


def pose(element: XmlElement, angles: Angles, name: str = "pos") -> RigidFrame:
    """The frame that an element's pos and orientation give in the one around it."""
    return RigidFrame(_rotation(element, angles), np.array(element.numbers(name, 3, (0, 0, 0))))


def unit(element: XmlElement, name: str, vector: FloatArray) -> FloatArray:
    """A vector scaled to length 1."""
    length = float(np.linalg.norm(vector))
    if length < _SMALLEST:
        element.refuse(f"{name} must not be zero")
    return vector / length


def _rotation(element: XmlElement, angles: Angles) -> FloatArray:
    given = [name for name in _ORIENTATIONS if name in element.attributes]
    if len(given) > 1:
        element.refuse(f"it has two orientations, {given[0]} and {given[1]}: leave one out")
    if not given:
        return np.eye(3)
    numbers = np.array(element.numbers(given[0], {"quat": 4, "axisangle": 4, "xyaxes": 6}.get(given[0], 3)))
    if given[0] == "quat":
        return quaternion_matrix(unit(element, "quat", numbers))
    if given[0] == "axisangle":
        return about(unit(element, "axisangle", numbers[:3]), angles.radians(float(numbers[3])))
    if given[0] == "euler":
        return _euler(numbers, angles)
    if given[0] == "zaxis":
        return shortest(unit(element, "zaxis", numbers))
    x = unit(element, "xyaxes", numbers[:3])
    y = unit(element, "xyaxes", numbers[3:] - (numbers[3:] @ x) * x)
    return np.column_stack([x, y, np.cross(x, y)])


def shortest(z: FloatArray) -> FloatArray:
    """The rotation by the smallest angle that turns the z axis to a unit vector."""
    axis = np.cross([0.0, 0.0, 1.0], z)
    length = float(np.linalg.norm(axis))
    if length < _SMALLEST:
        return np.eye(3) if z[2] > 0 else about((1, 0, 0), np.pi)
    return about(axis / length, float(np.arctan2(length, z[2])))


def _euler(numbers: FloatArray, angles: Angles) -> FloatArray:
    rotation = np.eye(3)
    for letter, number in zip(angles.sequence, numbers, strict=True):
        angle = angles.radians(float(number))
        turn = about(np.eye(3)["xyz".index(letter.lower())], angle)
        rotation = turn @ rotation if letter.isupper() else rotation @ turn
    return rotation
