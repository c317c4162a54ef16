"""Loops, constraints, loads and inputs of an MJCF document; a named error for what MuJoCo has no word for."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NoReturn
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from nullbody.errors import MechanismError
from nullbody.expr.parse import names_in
from nullbody.formats.mjcf_writer_tree import Tree, mjcf_numbers
from nullbody.formats.rigid import RigidFrame, number
from nullbody.mechanism import (
    CoordinateSpring,
    Coupling,
    Distance,
    Driver,
    Energy,
    Friction,
    Placement,
    Revolute,
    Spherical,
    Spring,
    Weld,
)
from nullbody.mechanism.joints.base import axis_vector
from nullbody.typing import Scalar

__all__ = ["Parts"]

_ARM = 0.1  # between the two points that stand for a revolute loop joint [m]
_ARMATURE = re.compile(r"\(?([-+.\deE]+)\)?\*(\w+)_dot\^2/2")


@dataclass
class Parts:
    """Writes what is not in the tree.

    Attributes:
        tree: that has been written.
        root: <mujoco>.
        sites: names that are taken.
        equalities: likewise; those of loops and constraints are kept for them.
        tendons: likewise; those of distances are kept for them.
        sections: <tendon>, <equality> and <actuator>.
    """

    tree: Tree
    root: Element
    sites: set[str] = field(default_factory=set)
    equalities: set[str] = field(default_factory=set)
    tendons: set[str] = field(default_factory=set)
    sections: dict[str, Element] = field(default_factory=dict)

    def write(self) -> None:
        """Everything, in the order of the mechanism.

        Raises:
            MechanismError: a part that MuJoCo has no word for.
        """
        mechanism = self.tree.mechanism
        for name in ("tendon", "equality", "actuator"):
            self.sections[name] = SubElement(self.root, name)
        self.tendons |= {loop.name for loop in mechanism.loops if isinstance(loop, Distance)}
        self.equalities |= {loop.name for loop in mechanism.loops}
        self.equalities |= {constraint.name for constraint in mechanism.constraints}
        for loop in mechanism.loops:
            self._one(
                loop, _LOOPS, "close it by a spherical, revolute, weld or distance joint, or cut the loop elsewhere"
            )
        for constraint in mechanism.constraints:
            self._one(constraint, _CONSTRAINTS, "take it out for the export")
        for load in mechanism.loads:
            self._one(load, _LOADS, "take it out for the export")
        for actuator in mechanism.actuators:
            self._motor(actuator)
        if not len(self.sections["tendon"]):
            self.root.remove(self.sections["tendon"])

    def _one(self, part: Any, known: Mapping[type, Callable[[Parts, Any], None]], advice: str) -> None:
        if type(part) not in known:
            raise MechanismError(f"{part.name!r} is a {type(part).__name__}, which MuJoCo has no word for: {advice}")
        known[type(part)](self, part)

    def _value(self, source: Scalar) -> float:
        return number(source, self.tree.values)

    def _site(self, name: str, body: str, place: Placement, *, turned: bool = False) -> str:
        """A site on a body; its name."""
        if body not in self.tree.elements:
            raise MechanismError(f"body {body!r} is massless and has no element of its own in MuJoCo: give it a mass")
        name = _unique(name, self.sites)
        frame = self.tree.local(body, place)
        site = SubElement(self.tree.elements[body], "site", name=name, pos=mjcf_numbers(frame.position), size="0.001")
        if turned and not np.array_equal(frame.rotation, np.eye(3)):
            site.set("xyaxes", mjcf_numbers([*frame.rotation[:, 0], *frame.rotation[:, 1]]))
        return name

    def _ends(self, loop: Any, *, turned: bool = False) -> dict[str, str]:
        """The two sites of a loop joint."""
        a = self._site(f"{loop.name}_a", loop.parent, loop.at, turned=turned)
        return {"site1": a, "site2": self._site(f"{loop.name}_b", loop.child, loop.on, turned=turned)}

    def _connect(self, loop: Spherical) -> None:
        SubElement(self.sections["equality"], "connect", {"name": loop.name, **self._ends(loop)})

    def _weld(self, loop: Weld) -> None:
        SubElement(self.sections["equality"], "weld", {"name": loop.name, **self._ends(loop, turned=True)})

    def _hinge(self, loop: Revolute) -> None:
        """Two points of the axis: six equations, of which one repeats."""
        SubElement(self.sections["equality"], "connect", {"name": loop.name, **self._ends(loop)})
        names = {}
        for key, suffix, body, place in (("site1", "a", loop.parent, loop.at), ("site2", "b", loop.child, loop.on)):
            arm = RigidFrame(np.eye(3), _ARM * np.array(axis_vector(loop.axis)))
            element, frame = self.tree.elements[body], self.tree.local(body, place) @ arm
            names[key] = _unique(f"{loop.name}_axis_{suffix}", self.sites)
            SubElement(element, "site", name=names[key], pos=mjcf_numbers(frame.position), size="0.001")
        second = _unique(f"{loop.name}_axis", self.equalities)
        SubElement(self.sections["equality"], "connect", {"name": second, **names})

    def _rod(self, loop: Distance) -> None:
        """A tendon that keeps its length: L = L(q = 0) + c."""
        ends = self._ends(loop)
        self._tendon(loop.name, ends)
        rest = self._span((loop.parent, loop.at), (loop.child, loop.on))
        change = mjcf_numbers([self._value(loop.length) - rest, 0, 0, 0, 0])
        SubElement(self.sections["equality"], "tendon", name=loop.name, tendon1=loop.name, polycoef=change)

    def _span(self, a: tuple[str, Placement], b: tuple[str, Placement]) -> float:
        """Distance of two points where all coordinates are zero."""
        points = [(self.tree.world[body] @ self.tree.local(body, place)).position for body, place in (a, b)]
        return float(np.linalg.norm(points[1] - points[0]))

    def _tendon(self, name: str, ends: Mapping[str, str]) -> Element:
        tendon = SubElement(self.sections["tendon"], "spatial", name=name)
        for key in ("site1", "site2"):
            SubElement(tendon, "site", site=ends[key])
        return tendon

    def _couple(self, constraint: Coupling) -> None:
        coefficients = [self._value(constraint.offset), self._value(constraint.ratio), 0, 0, 0]
        names = {"joint1": constraint.driven, "joint2": constraint.driver}
        self._joint_equality(constraint.name, names, coefficients)

    def _hold(self, constraint: Driver) -> None:
        """A driver that stands still."""
        if isinstance(constraint.motion, str) and names_in(constraint.motion) - set(self.tree.values):
            raise MechanismError(
                f"driver {constraint.name!r} follows the time, which MuJoCo has no word for: take it out for the export"
            )
        self._joint_equality(
            constraint.name, {"joint1": constraint.coordinate}, [self._value(constraint.motion), 0, 0, 0, 0]
        )

    def _joint_equality(self, name: str, names: Mapping[str, str], coefficients: list[float]) -> None:
        for coordinate in names.values():
            self._joint(coordinate, name)
        SubElement(self.sections["equality"], "joint", {"name": name, **names, "polycoef": mjcf_numbers(coefficients)})

    def _joint(self, coordinate: str, name: str) -> Element:
        """The hinge or slide of a coordinate."""
        if coordinate not in self.tree.joints:
            raise MechanismError(
                f"{name!r} acts on {coordinate!r}, one of a ball's Euler parameters: MuJoCo has no word for that"
            )
        return self.tree.joints[coordinate]

    def _spring(self, load: Spring) -> None:
        ends = {
            "site1": self._site(f"{load.name}_a", load.body_a, Placement(load.point_a)),
            "site2": self._site(f"{load.name}_b", load.body_b, Placement(load.point_b)),
        }
        name = load.name if load.name not in self.tendons else f"{load.name}_spring"
        tendon = self._tendon(_unique(name, self.tendons), ends)
        for key, source in (("stiffness", load.stiffness), ("springlength", load.length), ("damping", load.damping)):
            tendon.set(key, mjcf_numbers([self._value(source)]))

    def _joint_spring(self, load: CoordinateSpring) -> None:
        """Springs of one coordinate add up: k = sum k_i, k rest = sum k_i rest_i."""
        joint = self._joint(load.coordinate, load.name)
        before, rest = float(joint.get("stiffness", "0")), float(joint.get("springref", "0"))
        more = self._value(load.stiffness)
        if more:
            if before + more == 0:
                raise MechanismError(f"{load.name!r} and another spring cancel: MuJoCo has no word for what is left")
            joint.set("stiffness", mjcf_numbers([before + more]))
            joint.set("springref", mjcf_numbers([(before * rest + more * self._value(load.rest)) / (before + more)]))
        self._add(joint, "damping", load.damping)

    def _friction(self, load: Friction) -> None:
        joint = self._joint(load.coordinate, load.name)
        speed = self._value(load.speed)
        if self._value(load.coulomb) and speed != Friction.speed:
            raise MechanismError(
                f"friction {load.name!r} is smooth below speed = {speed:g}, which MuJoCo has no word for: it is read "
                f"back with {Friction.speed}. Take that speed, or take the friction out for the export"
            )
        self._add(joint, "damping", load.viscous)
        self._add(joint, "frictionloss", load.coulomb)

    def _add(self, joint: Element, key: str, source: Scalar) -> None:
        total = float(joint.get(key, "0")) + self._value(source)
        if total:
            joint.set(key, mjcf_numbers([total]))

    def _energy(self, load: Energy) -> None:
        """The kinetic energy of a rotor, a q'^2 / 2, is MuJoCo's armature."""
        found = _ARMATURE.fullmatch(str(load.kinetic_energy).replace(" ", ""))
        if load.potential_energy != 0 or not found:
            self._refuse_energy(load)
        self._add(self._joint(found[2], load.name), "armature", found[1])

    def _refuse_energy(self, load: Energy) -> NoReturn:
        raise MechanismError(
            f"{load.name!r} is an energy of your own, which MuJoCo has no word for unless it is kinetic and reads like "
            "0.01*q_dot^2/2: take it out for the export"
        )

    def _motor(self, actuator: Any) -> None:
        motor = SubElement(self.sections["actuator"], "motor", name=actuator.name, joint=actuator.coordinate)
        self._joint(actuator.coordinate, actuator.name)
        if actuator.limits is not None:
            motor.set("ctrllimited", "true")
            motor.set("ctrlrange", mjcf_numbers(self._value(limit) for limit in actuator.limits))


def _unique(name: str, taken: set[str]) -> str:
    """A name that nothing else of its kind has: with _ behind it until it is free; it is taken from then on."""
    while name in taken:
        name += "_"
    taken.add(name)
    return name


_LOOPS: Mapping[type, Callable[[Parts, Any], None]] = {
    Spherical: Parts._connect,
    Weld: Parts._weld,
    Revolute: Parts._hinge,
    Distance: Parts._rod,
}
_CONSTRAINTS: Mapping[type, Callable[[Parts, Any], None]] = {Coupling: Parts._couple, Driver: Parts._hold}
_LOADS: Mapping[type, Callable[[Parts, Any], None]] = {
    Spring: Parts._spring,
    CoordinateSpring: Parts._joint_spring,
    Friction: Parts._friction,
    Energy: Parts._energy,
}
