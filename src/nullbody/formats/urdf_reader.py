"""URDF read into a mechanism, with a list of loops that URDF itself cannot express."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from nullbody.errors import InputError
from nullbody.formats.document import Document, Source, document
from nullbody.formats.entries import add_joint_entries
from nullbody.formats.mjcf_mass import MassProperties, body_of
from nullbody.formats.mjcf_pose import about, placement
from nullbody.formats.mjcf_scene import symbol
from nullbody.formats.rigid import RigidFrame
from nullbody.formats.xml_tree import XmlElement, xml_tree
from nullbody.mechanism import GROUND, Mechanism, MechanismBuilder
from nullbody.typing import Scalar

__all__ = ["read_urdf", "read_urdf_document"]

Loops = Sequence[Mapping[str, Any]] | Mapping[str, Mapping[str, Any]]

_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
_IN_ROBOT = ("link", "joint", "material", "transmission", "gazebo", "sensor", "ros2_control")


def read_urdf(
    source: Source, loops: Loops = (), actuators: Sequence[str] = (), gravity: Sequence[Scalar] = (0, 0, -9.81)
) -> Mechanism:
    """Read a URDF document; its root link is fixed to the ground.

    Links with their <inertial>, joints revolute, continuous, prismatic, fixed, floating and planar with <dynamics>
    (damping, and friction regularised below 0.001 m/s or rad/s) and <mimic>. Left out: <limit> (stops are not
    modelled), looks, collision shapes, transmissions, sensors. z is up, as in ROS.

    Args:
        source: a path, or the text itself.
        loops: joints that close loops, each a mapping as under `joints` in a model file, with its name as a key "name",
            or name -> mapping.
        actuators: joints that are driven; the inputs are called u_ and the joint's name.
        gravity: acceleration of gravity in the ground frame [m/s^2].

    Raises:
        ModelFileError: what is not known here; the message names the element and its line.
        InputError: actuators that are no list of names.
        MechanismError, UnknownName: a mechanism that makes no sense.
    """
    return read_urdf_document(document(source), loops, actuators, gravity)


def read_urdf_document(
    given: Document, loops: Loops = (), actuators: Sequence[str] = (), gravity: Sequence[Scalar] = (0, 0, -9.81)
) -> Mechanism:
    """The mechanism of a document that has been read."""
    root = xml_tree(given)
    if root.tag != "robot":
        root.refuse("a URDF document begins with <robot>")
    for child in root.children:
        if child.tag not in _IN_ROBOT:
            child.refuse(f"<{child.tag}> is not known here; expand xacro files first")
    builder = MechanismBuilder(root.text("name") or "robot", gravity)
    reader = _Reader(root, builder)
    reader.read()
    add_joint_entries(builder, loops, reader.bodies)
    _check_actuators(actuators)
    try:
        for name in actuators:
            builder.actuator(f"u_{symbol(name)}", symbol(name))
        return builder.build()
    except InputError as error:
        raise given.located(error) from None


def _check_actuators(given: Any) -> None:
    listed = isinstance(given, Sequence) and not isinstance(given, str)
    if not listed or not all(isinstance(name, str) for name in given):
        raise InputError(f"actuators is a list of names of joints, not {given!r}")


class _Reader:
    """Tells a builder what is in a document."""

    def __init__(self, root: XmlElement, builder: MechanismBuilder) -> None:
        self.root = root
        self.builder = builder
        self.bodies: dict[str, str] = {}

    def read(self) -> None:
        """Links, the root's fixture, joints."""
        links = _by_name(self.root, "link")
        _by_name(self.root, "joint")
        if not links:
            self.root.refuse("there is no link in it")
        for name, link in links.items():
            self.bodies[name] = symbol(name) if symbol(name) != GROUND else f"{GROUND}_link"
            try:
                self.builder.add(body_of(self.bodies[name], _mass(link)))
            except InputError as error:
                raise link.located(error) from None
        children = [_only(joint, "child").required("link") for joint in self.root.all("joint")]
        for name in links:
            if name not in children:
                self.builder.weld(f"{self.bodies[name]}_fixture", GROUND, self.bodies[name], tree=True)
        for joint in self.root.all("joint"):
            try:
                self._joint(joint)
            except InputError as error:
                raise joint.located(error) from None
        for joint in self.root.all("joint"):
            for mimic in _at_most_one(joint, "mimic"):
                self._mimic(joint, mimic)

    def _body(self, element: XmlElement) -> str:
        name = element.required("link")
        if name not in self.bodies:
            element.refuse(f"there is no link {name!r}; known: {', '.join(self.bodies)}")
        return self.bodies[name]

    def _joint(self, joint: XmlElement) -> None:
        kind = joint.choice("type", _TYPES, "")
        for dynamics in _at_most_one(joint, "dynamics") if kind in ("floating", "planar") else ():
            if dynamics.number("damping") or dynamics.number("friction"):
                dynamics.refuse(f"damping and friction of a {kind} joint have no meaning here: take them out")
        name = symbol(joint.required("name"))
        ends = (self._body(_only(joint, "parent")), self._body(_only(joint, "child")))
        at = placement(_origin(joint))
        axis = next((a.numbers("xyz", 3, (1, 0, 0)) for a in _at_most_one(joint, "axis")), [1.0, 0.0, 0.0])
        builder: Any = self.builder
        if kind == "fixed":
            builder.weld(name, *ends, at, tree=True)
        elif kind == "floating":
            builder.free(name, ends[1], ends[0], at)
        elif kind == "planar":
            builder.planar(name, *ends, at, axis=axis, tree=True)
        else:
            method = builder.prismatic if kind == "prismatic" else builder.revolute
            method(name, *ends, at, axis=axis, tree=True)
            self._resist(joint, name)

    def _resist(self, joint: XmlElement, name: str) -> None:
        for dynamics in _at_most_one(joint, "dynamics"):
            damping, friction = dynamics.number("damping"), dynamics.number("friction")
            if damping:
                self.builder.coordinate_damper(f"{name} damping", name, damping)
            if friction:
                self.builder.friction(f"{name} friction", name, friction)

    def _mimic(self, joint: XmlElement, mimic: XmlElement) -> None:
        """joint = multiplier other + offset."""
        name, other = symbol(joint.text("name")), symbol(mimic.required("joint"))
        ratio, offset = mimic.number("multiplier", 1.0), mimic.number("offset")
        try:
            self.builder.coupling(f"{name} mimics {other}", name, other, ratio, offset)
        except InputError as error:
            raise mimic.located(error) from None


def _only(element: XmlElement, tag: str) -> XmlElement:
    """The one child of this name."""
    found = list(element.all(tag))
    if len(found) != 1:
        element.refuse(f"it needs one <{tag}>, not {len(found)}")
    return found[0]


def _at_most_one(element: XmlElement, tag: str) -> list[XmlElement]:
    """The child of this name, if there is one."""
    found = list(element.all(tag))
    if len(found) > 1:
        found[1].refuse(f"{element.place} has one <{tag}>, not {len(found)}")
    return found


def _by_name(root: XmlElement, tag: str) -> dict[str, XmlElement]:
    """The elements of a kind; no two have the same name."""
    found: dict[str, XmlElement] = {}
    for element in root.all(tag):
        name = element.required("name")
        if name in found:
            element.refuse(f"there is another {tag} of this name")
        found[name] = element
    return found


def _origin(element: XmlElement) -> RigidFrame:
    """<origin xyz rpy>: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    for origin in _at_most_one(element, "origin"):
        roll, pitch, yaw = origin.numbers("rpy", 3, (0, 0, 0))
        x, y, z = np.eye(3)
        return RigidFrame(
            about(z, yaw) @ about(y, pitch) @ about(x, roll), np.array(origin.numbers("xyz", 3, (0, 0, 0)))
        )
    return RigidFrame(np.eye(3), np.zeros(3))


def _mass(link: XmlElement) -> MassProperties:
    """<inertial>: mass, and inertia about the centre in the axes of <origin>."""
    for inertial in _at_most_one(link, "inertial"):
        frame = _origin(inertial)
        mass = _only(inertial, "mass")
        mass.required("value")
        entries = _only(inertial, "inertia")
        xx, yy, zz, xy, xz, yz = (entries.number(key) for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if not np.array_equal(frame.rotation, np.eye(3)):
            inertia = frame.rotation @ inertia @ frame.rotation.T
            inertia = (inertia + inertia.T) / 2
        return MassProperties(mass.number("value"), frame.position, inertia)
    return MassProperties(0.0, np.zeros(3), np.zeros((3, 3)))
