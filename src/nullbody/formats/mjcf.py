"""MJCF: a mechanism as a document for MuJoCo, with the same coordinates and the same q."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from nullbody.errors import MechanismError
from nullbody.formats.look import add_look
from nullbody.formats.rigid import RigidFrame, Step, frame, loop_points, mass_properties, steps, triple
from nullbody.mechanism import GROUND, AbstractTreeJoint, Mechanism
from nullbody.typing import FloatArray

__all__ = ["write_mjcf"]

_SMALLEST = 1e-15  # mjMINVAL: MuJoCo refuses moving bodies with less mass [kg] or inertia [kg m^2]
_MOST_STEPS = 6  # coordinates of one MuJoCo body

_COMPILER = {
    "angle": "radian",
    "autolimits": "false",
    "inertiafromgeom": "false",
    "balanceinertia": "false",
    "boundmass": "0",
    "boundinertia": "0",
}


def write_mjcf(mechanism: Mechanism, values: Mapping[str, float] | None = None) -> str:
    """An MJCF document whose joints are the coordinates: same names, same zero, same sign.

    A Free joint becomes three slides and three hinges (phi, theta, psi; MuJoCo applies the first listed joint
    nearest to the parent). A massless body with one child is merged into it. Every loop joint becomes two
    sites, <loop>_a and <loop>_b, and a `connect` between them, which MuJoCo holds only softly. An inertia below
    1e-15 kg m^2 (thin rods about their axis, point masses) is written as 1e-15, the least that MuJoCo takes.
    Bodies carry a look without mass or contact. The key frame "home" is the mechanism's home.

    Args:
        mechanism: any mechanism of joints that `steps` knows.
        values: parameter values that differ from the mechanism's own [SI].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
        MechanismError: a massless body that cannot be merged, or a name that MuJoCo reserves.
    """
    checked = mechanism.values(values)
    root = Element("mujoco", model=mechanism.name)
    SubElement(root, "compiler", _COMPILER)
    SubElement(
        root,
        "option",
        gravity=_text(triple(mechanism.gravity, checked)),
        timestep="0.001",
        integrator="implicitfast",
    )
    writer = _Writer(mechanism, checked)
    world = SubElement(root, "worldbody")
    placed = writer.grow(world, GROUND)
    add_look(mechanism, checked, {GROUND: world, **placed})
    equality = SubElement(root, "equality")
    for loop in mechanism.loops:
        for side, body, point in zip("ab", (loop.body_a, loop.body_b), loop_points(loop, checked), strict=True):
            site = {"name": f"{loop.name}_{side}", "pos": _text(point), "size": "0.001"}
            SubElement(world if body == GROUND else placed[body], "site", site)
        SubElement(equality, "connect", name=loop.name, site1=f"{loop.name}_a", site2=f"{loop.name}_b")
    actuators = SubElement(root, "actuator")
    for actuator in mechanism.actuators:
        SubElement(actuators, "motor", name=actuator.name, joint=actuator.coordinate)
    home = mechanism.home_values(checked)
    order = [joint.attrib["name"] for joint in world.iter("joint")]
    SubElement(SubElement(root, "keyframe"), "key", name="home", qpos=_text(home[name] for name in order))
    indent(root)
    return tostring(root, encoding="unicode") + "\n"


@dataclass(frozen=True)
class _Writer:
    """Writes the tree of bodies."""

    mechanism: Mechanism
    values: Mapping[str, float]

    def grow(self, element: Element, name: str) -> dict[str, Element]:
        """Add all descendants of a body to its element; their elements by name."""
        placed: dict[str, Element] = {}
        for joint in self.mechanism.joints:
            if joint.parent == name:
                chain = self._chain(joint)
                child = chain[-1].child
                placed[child] = self._body(element, chain)
                placed |= self.grow(placed[child], child)
        return placed

    def _chain(self, joint: AbstractTreeJoint) -> list[AbstractTreeJoint]:
        """The joint and those that follow it through massless bodies, up to a body with mass."""
        chain = [joint]
        while self._massless(chain[-1].child):
            name = chain[-1].child
            onward = [other for other in self.mechanism.joints if other.parent == name]
            held = [loop.name for loop in self.mechanism.loops if name in (loop.body_a, loop.body_b)]
            if len(onward) != 1 or held:
                why = f"loop {held[0]!r} holds it" if held else f"it carries {len(onward)} bodies, not one"
                raise MechanismError(
                    f"body {name!r} has neither mass nor inertia, and {why}: MuJoCo cannot have it. "
                    "Give it a mass, or take engine 'pinocchio'"
                )
            chain += onward
        return chain

    def _massless(self, name: str) -> bool:
        body = next(body for body in self.mechanism.bodies if body.name == name)
        mass, _, inertia = mass_properties(body, self.values)
        return mass == 0 and not inertia.any()

    def _body(self, parent: Element, chain: Sequence[AbstractTreeJoint]) -> Element:
        """One body with the joints of its chain, all of them in the body's own frame at q = 0."""
        name = chain[-1].child
        if name == "world":
            raise MechanismError("MuJoCo keeps the name 'world' for the ground: rename that body")
        count = sum(joint.size for joint in chain)
        if count > _MOST_STEPS:
            raise MechanismError(
                f"body {name!r} would take {count} coordinates together with the massless bodies before it; "
                f"a MuJoCo body has at most {_MOST_STEPS}. Give one of those bodies a mass"
            )
        back = RigidFrame(np.eye(3), np.zeros(3))
        moves: list[tuple[Step, RigidFrame]] = []
        for joint in reversed(chain):
            moves = [(step, back) for step in steps(joint)] + moves
            back = back @ frame(joint.at, self.values).inverse()
        element = SubElement(parent, "body", {"name": name, **_place(back.inverse())})
        for step, seen in moves:
            joint_element = SubElement(element, "joint", name=step.coordinate, type=step.kind)
            joint_element.set("axis", _text(seen.rotation @ step.axis))
            if seen.position.any():
                joint_element.set("pos", _text(seen.position))
        self._inertial(element, name)
        return element

    def _inertial(self, element: Element, name: str) -> None:
        """Mass and principal moments, which MuJoCo takes as they are; a full matrix it wants to be definite."""
        body = next(body for body in self.mechanism.bodies if body.name == name)
        mass, centre, inertia = mass_properties(body, self.values)
        axes = np.eye(3)
        moments = np.diag(inertia)
        if np.count_nonzero(inertia - np.diag(moments)):
            moments, axes = np.linalg.eigh(inertia)
            axes = axes * np.linalg.det(axes).round()
        inertial = SubElement(element, "inertial", {"pos": "0 0 0", **_place(RigidFrame(axes, centre))})
        inertial.set("mass", _text([max(mass, _SMALLEST)]))
        inertial.set("diaginertia", _text(np.maximum(moments, _SMALLEST)))


def _place(at: RigidFrame) -> dict[str, str]:
    """The attributes of a frame; the identity needs none."""
    place = {}
    if at.position.any():
        place["pos"] = _text(at.position)
    if not np.array_equal(at.rotation, np.eye(3)):
        place["xyaxes"] = _text([*at.rotation[:, 0], *at.rotation[:, 1]])
    return place


def _text(numbers: Iterable[float] | FloatArray) -> str:
    """Numbers in full precision, without trailing .0."""
    return " ".join(repr(float(number) + 0.0).removesuffix(".0") for number in numbers)
