"""The tree of bodies of an MJCF document: one element for each body with mass, joints with the mechanism's q."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from nullbody.errors import MechanismError
from nullbody.formats.rigid import RigidFrame, Step, frame, mass_properties, steps
from nullbody.mechanism import GROUND, AbstractTreeJoint, Mechanism, Placement
from nullbody.typing import FloatArray

__all__ = ["Tree", "mjcf_numbers"]

_SMALLEST = 1e-15  # mjMINVAL: MuJoCo refuses moving bodies with less mass [kg] or inertia [kg m^2]
_MOST_RATES = 6  # of one MuJoCo body
_DEEPEST = 496  # bodies one inside the other: MuJoCo reads no more than 499 nested elements
_HERE = RigidFrame(np.eye(3), np.zeros(3))


@dataclass(frozen=True)
class Tree:
    """Writes bodies and joints.

    A body's element has the body's own frame, unless a ball joint sits on it in a turned frame: then the element is
    turned with it, so that MuJoCo's quaternion is the mechanism's.

    Attributes:
        mechanism: what is written.
        values: of its parameters.
        elements: of the bodies, by name.
        offsets: frame of a body's element in the body.
        world: frame of a body's element where all coordinates are zero.
        joints: elements of hinges and slides, by coordinate.
        order: coordinates in the order of MuJoCo's qpos.
    """

    mechanism: Mechanism
    values: Mapping[str, float]
    elements: dict[str, Element] = field(default_factory=dict)
    offsets: dict[str, RigidFrame] = field(default_factory=dict)
    world: dict[str, RigidFrame] = field(default_factory=dict)
    joints: dict[str, Element] = field(default_factory=dict)
    order: list[str] = field(default_factory=list)

    def grow(self, element: Element, name: str = GROUND, depth: int = 0) -> None:
        """Add all descendants of a body to its element.

        Raises:
            MechanismError: bodies nested deeper than MuJoCo reads, and those of `write_mjcf`.
        """
        if depth > _DEEPEST:
            raise MechanismError(
                f"body {name!r} is number {depth} of a chain; MuJoCo reads no more than {_DEEPEST} bodies one inside "
                "the other. Begin the tree in the middle of the chain"
            )
        self.elements[name] = element
        if name == GROUND:
            self.offsets[name] = self.world[name] = _HERE
        for joint in self.mechanism.joints:
            if joint.parent == name:
                chain = self._chain(joint)
                child = chain[-1].child
                self.grow(self._body(element, chain), child, depth + 1)

    def local(self, body: str, place: Placement) -> RigidFrame:
        """A frame on a body, in the body's element."""
        return self.offsets[body].inverse() @ frame(place, self.values)

    def _chain(self, joint: AbstractTreeJoint) -> list[AbstractTreeJoint]:
        """The joint and those that follow it through massless bodies, up to a body with mass."""
        chain = [joint]
        while self._massless(chain[-1].child) and not self._resting(chain):
            name = chain[-1].child
            onward = [other for other in self.mechanism.joints if other.parent == name]
            held = [loop.name for loop in self.mechanism.loops if name in (loop.parent, loop.child)]
            if len(onward) != 1 or held:
                why = f"loop {held[0]!r} holds it" if held else f"it carries {len(onward)} bodies, not one"
                raise MechanismError(
                    f"body {name!r} has neither mass nor inertia, and {why}: MuJoCo cannot have it. Give it a mass"
                )
            chain += onward
        return chain

    def _resting(self, chain: Sequence[AbstractTreeJoint]) -> bool:
        """Whether a chain is a weld on what needs no mass: the ground, or a body that is welded there."""
        return chain[0].parent in self._fixed() and not any(joint.coordinates for joint in chain)

    def _fixed(self) -> set[str]:
        fixed = {GROUND}
        for joint in self.mechanism.tree_order():
            if joint.parent in fixed and not joint.coordinates:
                fixed.add(joint.child)
        return fixed

    def _massless(self, name: str) -> bool:
        body = next(body for body in self.mechanism.bodies if body.name == name)
        mass, _, inertia = mass_properties(body, self.values)
        return mass == 0 and not inertia.any()

    def _body(self, parent: Element, chain: Sequence[AbstractTreeJoint]) -> Element:
        """One body with the joints of its chain, all of them in the element's frame at q = 0."""
        name = chain[-1].child
        if name == "world":
            raise MechanismError("MuJoCo keeps the name 'world' for the ground: rename that body")
        back = _HERE
        moves: list[tuple[Step, RigidFrame]] = []
        for joint in reversed(chain):
            seen = back @ frame(joint.on, self.values)
            moves = [(step, seen) for step in steps(joint)] + moves
            back = seen @ frame(joint.at, self.values).inverse()
        self._check_size(name, moves)
        self.offsets[name] = offset = self._offset(name, moves)
        carrier = chain[0].parent
        place = self.offsets[carrier].inverse() @ back.inverse() @ offset
        self.world[name] = self.world[carrier] @ place
        element = SubElement(parent, "body", {"name": name, **_place(place)})
        for step, seen in moves:
            self._joint(element, step, offset.inverse() @ seen)
        self._inertial(element, name)
        return element

    def _check_size(self, name: str, moves: Sequence[tuple[Step, RigidFrame]]) -> None:
        count = sum(3 if step.kind == "ball" else 1 for step, _ in moves)
        if count > _MOST_RATES:
            raise MechanismError(
                f"body {name!r} would take {count} coordinates together with the massless bodies before it; "
                f"a MuJoCo body has at most {_MOST_RATES}. Give one of those bodies a mass"
            )

    def _offset(self, name: str, moves: Sequence[tuple[Step, RigidFrame]]) -> RigidFrame:
        """The frame of the element: turned as the ball is, if there is one."""
        balls = [seen.rotation for step, seen in moves if step.kind == "ball"]
        if len(balls) > 1:
            raise MechanismError(
                f"body {name!r} would take two ball joints: give the massless body between them a mass"
            )
        return RigidFrame(balls[0], np.zeros(3)) if balls else _HERE

    def _joint(self, element: Element, step: Step, seen: RigidFrame) -> None:
        made = SubElement(element, "joint", name=step.coordinate, type=step.kind)
        if step.kind != "ball":
            made.set("axis", mjcf_numbers(seen.rotation @ step.axis))
            self.joints[step.coordinate] = made
        if seen.position.any():
            made.set("pos", mjcf_numbers(seen.position))
        self.order.extend(step.coordinates)

    def _inertial(self, element: Element, name: str) -> None:
        """Mass and principal moments, which MuJoCo takes as they are; a full matrix it wants to be definite."""
        body = next(body for body in self.mechanism.bodies if body.name == name)
        mass, centre, inertia = mass_properties(body, self.values)
        axes = np.eye(3)
        moments = np.diag(inertia)
        if np.count_nonzero(inertia - np.diag(moments)):
            moments, axes = np.linalg.eigh(inertia)
            axes = axes * np.linalg.det(axes).round()
        place = self.offsets[name].inverse() @ RigidFrame(axes, centre)
        inertial = SubElement(element, "inertial", {"pos": "0 0 0", **_place(place)})
        inertial.set("mass", mjcf_numbers([max(mass, _SMALLEST)]))
        inertial.set("diaginertia", mjcf_numbers(np.maximum(moments, _SMALLEST)))


def mjcf_numbers(numbers: Iterable[float] | FloatArray) -> str:
    """Numbers in full precision, without trailing .0."""
    return " ".join(repr(float(number) + 0.0).removesuffix(".0") for number in numbers)


def _place(at: RigidFrame) -> dict[str, str]:
    """The attributes of a frame; the identity needs none."""
    place = {}
    if at.position.any():
        place["pos"] = mjcf_numbers(at.position)
    if not np.array_equal(at.rotation, np.eye(3)):
        place["xyaxes"] = mjcf_numbers([*at.rotation[:, 0], *at.rotation[:, 1]])
    return place
