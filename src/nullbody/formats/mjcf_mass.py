"""Mass, centre and inertia of MJCF bodies: as given, or from simple geoms."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from nullbody.formats.mjcf_pose import Angles, point, pose, shortest
from nullbody.formats.rigid import RigidFrame
from nullbody.formats.xml_tree import XmlElement
from nullbody.mechanism import Body
from nullbody.typing import FloatArray, Scalar

__all__ = ["MassProperties", "body_of", "geom_mass", "inertial_mass", "together"]

_DENSITY = 1000.0  # MuJoCo's default [kg/m^3]
_WITHOUT_MASS = ("plane", "hfield")


@dataclass(frozen=True)
class MassProperties:
    """Mass [kg], centre [m] and inertia about it [kg m^2, 3 x 3], in a body's axes."""

    mass: float
    centre: FloatArray
    inertia: FloatArray


def together(parts: Sequence[MassProperties]) -> MassProperties:
    """One rigid body of several: I = sum I_k + m_k (|d|^2 1 - d d^T), d from the common centre of mass."""
    mass = sum(part.mass for part in parts)
    if mass == 0:
        return MassProperties(0.0, np.zeros(3), sum((part.inertia for part in parts), np.zeros((3, 3))))
    centre = sum((part.mass * part.centre for part in parts), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for part in parts:
        d = part.centre - centre
        inertia += part.inertia + part.mass * (d @ d * np.eye(3) - np.outer(d, d))
    return MassProperties(mass, centre, inertia)


def body_of(name: str, given: MassProperties) -> Body:
    """A body with these properties; products of inertia only where there are any."""
    inertia = given.inertia
    entries: list[Scalar] = [float(inertia[k, k]) for k in range(3)]
    products = [float(inertia[i, j]) for i, j in ((0, 1), (0, 2), (1, 2))]
    if any(products):
        entries += products
    x, y, z = (float(component) + 0.0 for component in given.centre)
    return Body(name, given.mass, (x, y, z), tuple(entries))


def inertial_mass(element: XmlElement, angles: Angles) -> MassProperties:
    """<inertial>: R diag(diaginertia) R^T, or fullinertia in the body's axes."""
    if "mass" not in element.attributes:
        element.refuse("the attribute 'mass' is missing")
    frame = pose(element, angles)
    full = element.numbers("fullinertia", 6)
    if full:
        if not np.array_equal(frame.rotation, np.eye(3)) or "diaginertia" in element.attributes:
            element.refuse("fullinertia goes with neither an orientation nor diaginertia")
        xx, yy, zz, xy, xz, yz = full
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    else:
        moments = np.diag(element.numbers("diaginertia", 3, (0, 0, 0)))
        turned = not np.array_equal(frame.rotation, np.eye(3))
        inertia = frame.rotation @ moments @ frame.rotation.T if turned else moments
        inertia = (inertia + inertia.T) / 2
    return MassProperties(element.number("mass"), frame.position, inertia)


def geom_mass(element: XmlElement, angles: Angles) -> MassProperties | None:
    """<geom>: a solid of uniform density; None where it weighs nothing.

    Raises:
        ModelFileError: a shape whose mass is not known here, such as a mesh.
    """
    kind = element.text("type", "sphere")
    given = element.number("mass", -1.0)
    density = element.number("density", _DENSITY)
    if given == 0 or (given < 0 and density == 0) or kind in _WITHOUT_MASS:
        return None
    if kind not in _SHAPES or element.text("mesh"):
        element.refuse(
            f"the mass of a {'mesh' if element.text('mesh') else kind} is not known here: give the body an <inertial>, "
            f"or mass='0' to this geom; known: {', '.join(_SHAPES)}"
        )
    if element.text("shellinertia", "false") == "true":
        element.refuse("shellinertia is not known here: give the body an <inertial>")
    frame, size = _solid(element, kind, angles)
    volume, moments = _SHAPES[kind](*size)
    mass = given if given > 0 else density * volume
    turned = not np.array_equal(frame.rotation, np.eye(3))
    principal = mass * np.diag(moments)
    inertia = frame.rotation @ principal @ frame.rotation.T if turned else principal
    return MassProperties(mass, frame.position, (inertia + inertia.T) / 2)


def _solid(element: XmlElement, kind: str, angles: Angles) -> tuple[RigidFrame, list[float]]:
    """Frame and sizes; `fromto` gives the axis and the half length."""
    count = {"sphere": 1, "capsule": 2, "cylinder": 2}.get(kind, 3)
    ends = np.array(element.numbers("fromto", 6))
    if not ends.size or kind == "sphere":
        size = element.numbers("size", range(1, 4))
        if len(size) < count or min(size[:count], default=0) <= 0:
            element.refuse(f"a {kind} needs {count} positive sizes, not {element.text('size')!r}")
        return pose(element, angles), size[:count]
    size = element.numbers("size", range(1, 4))
    start, span = ends[:3], ends[3:] - ends[:3]
    length = float(np.linalg.norm(span))
    if not size or size[0] <= 0 or length <= 0:
        element.refuse(f"a {kind} along fromto needs a positive first size and two different ends")
    frame = point(start + span / 2)
    return RigidFrame(shortest(span / length), frame.position), [*[size[0]] * (count - 1), length / 2]


def _capsule(r: float, h: float) -> tuple[float, Sequence[float]]:
    """A cylinder of length 2 h between half spheres, whose centres of mass are 3/8 r beyond its ends."""
    middle, ends = 2 * h / (2 * h + 4 * r / 3), 1 - 2 * h / (2 * h + 4 * r / 3)
    across = middle * (r**2 / 4 + h**2 / 3) + ends * (2 / 5 * r**2 + h**2 + 3 / 4 * r * h)
    return pi * r**2 * (2 * h + 4 * r / 3), [across, across, middle * r**2 / 2 + ends * 2 / 5 * r**2]


_SHAPES: Mapping[str, Callable[..., tuple[float, Sequence[float]]]] = {  # sizes -> volume, moments per mass
    "sphere": lambda r: (4 / 3 * pi * r**3, [2 / 5 * r**2] * 3),
    "capsule": _capsule,
    "cylinder": lambda r, h: (2 * pi * r**2 * h, [r**2 / 4 + h**2 / 3, r**2 / 4 + h**2 / 3, r**2 / 2]),
    "ellipsoid": lambda a, b, c: (
        4 / 3 * pi * a * b * c,
        [(b**2 + c**2) / 5, (a**2 + c**2) / 5, (a**2 + b**2) / 5],
    ),
    "box": lambda a, b, c: (8 * a * b * c, [(b**2 + c**2) / 3, (a**2 + c**2) / 3, (a**2 + b**2) / 3]),
}
