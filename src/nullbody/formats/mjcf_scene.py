"""What is known of an MJCF document while it is read: names, frames, sites, the builder."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

from nullbody.errors import InputError
from nullbody.formats.mjcf_class import Classes
from nullbody.formats.mjcf_contact import Surface
from nullbody.formats.mjcf_pose import Angles
from nullbody.formats.rigid import RigidFrame
from nullbody.formats.xml_tree import XmlElement
from nullbody.mechanism import GROUND, MechanismBuilder
from nullbody.typing import Scalar

__all__ = ["IGNORABLE", "ReadJoint", "Scene", "symbol"]

#: What `ignore` may name.
IGNORABLE = ("contact", "limit")

_RESERVED = ("pi", "sqrt", "sin", "cos", "tan", "t")


@dataclass(frozen=True)
class ReadJoint:
    """A hinge or slide of the document.

    Attributes:
        coordinate: its name here.
        reference: its value in the reference configuration.
    """

    coordinate: str
    reference: float


@dataclass(frozen=True)
class Scene:
    """What all elements share.

    Attributes:
        root: <mujoco>.
        builder: that is told what is read.
        angles: how angles are written.
        classes: default classes.
        compiler: its attributes, of all <compiler> elements together.
        ignored: what may be left out although it changes the motion.
        bodies: name in the document -> name here.
        frames: of the bodies here, in the reference configuration.
        free_frames: likewise, where all joint springs are free: there MuJoCo measures the free lengths of tendons.
        sites: name -> (body here, frame on it).
        joints: hinges and slides by their name in the document.
        positions: names of coordinates in the order of MuJoCo's qpos.
        home: of coordinates.
        surfaces: geoms that may touch.
        tendons: <spatial> by name: element with defaults, its two (body, frame), and its length in the reference
            configuration.
    """

    root: XmlElement
    builder: MechanismBuilder
    angles: Angles
    classes: Classes
    compiler: XmlElement
    ignored: Sequence[str]
    bodies: dict[str, str] = field(default_factory=lambda: {"world": GROUND})
    frames: dict[str, RigidFrame] = field(default_factory=dict)
    free_frames: dict[str, RigidFrame] = field(default_factory=dict)
    sites: dict[str, tuple[str, RigidFrame]] = field(default_factory=dict)
    joints: dict[str, ReadJoint] = field(default_factory=dict)
    positions: list[tuple[str, ...]] = field(default_factory=list)
    home: dict[str, Scalar] = field(default_factory=dict)
    surfaces: list[Surface] = field(default_factory=list)
    tendons: dict[str, tuple[XmlElement, list[tuple[str, RigidFrame]], float]] = field(default_factory=dict)
    taken: set[str] = field(default_factory=lambda: {*_RESERVED, GROUND})

    @contextmanager
    def at(self, element: XmlElement) -> Iterator[None]:
        """Errors of the builder get the place of an element."""
        try:
            yield
        except InputError as error:
            raise element.located(error) from None

    def name(self, element: XmlElement, stem: str) -> str:
        """A name for what an element becomes, letters, digits and _, taken by nothing else."""
        return self.free_name(element.text("name") or stem)

    def free_name(self, wanted: str) -> str:
        """A name like the wanted one that nothing else has: with _2, _3 and so on where it is taken."""
        stem = symbol(wanted)
        name, number = stem, 1
        while name in self.taken:
            number += 1
            name = f"{stem}_{number}"
        self.taken.add(name)
        return name

    def body_name(self, element: XmlElement) -> str:
        """The name of a body; those of bodies and of joints may be the same."""
        number = len(self.bodies)
        given = element.text("name") or f" {number}"  # which cannot be named in the document
        if given in self.bodies:
            element.refuse("there is another body of this name")
        known = {*self.bodies.values(), *_RESERVED}
        stem = symbol(element.text("name") or f"body{number}")
        name, number = stem, 1
        while name in known:
            number += 1
            name = f"{stem}_{number}"
        self.bodies[given] = name
        return name

    def body(self, element: XmlElement, attribute: str) -> str:
        """The body that an attribute names; the ground where there is none."""
        given = element.text(attribute, "world")
        if given not in self.bodies:
            known = ", ".join(name for name in self.bodies if not name.startswith(" "))
            element.refuse(f"{attribute}: there is no body {given!r}; known: {known}")
        return self.bodies[given]

    def site(self, element: XmlElement, attribute: str) -> tuple[str, RigidFrame]:
        """Body and frame of the site that an attribute names."""
        given = element.required(attribute)
        if given not in self.sites:
            element.refuse(f"{attribute}: there is no site {given!r}; known: {', '.join(self.sites) or 'none'}")
        return self.sites[given]

    def joint(self, element: XmlElement, attribute: str) -> ReadJoint:
        """The hinge or slide that an attribute names."""
        given = element.required(attribute)
        if given not in self.joints:
            known = ", ".join(self.joints) or "none"
            element.refuse(f"{attribute}: there is no hinge or slide {given!r}; known: {known}")
        return self.joints[given]

    def add_site(self, element: XmlElement, body: str, frame: RigidFrame) -> None:
        """Note a site; one without a name is used by nothing. A second one of a name is refused."""
        name = element.text("name")
        if name in self.sites:
            element.refuse("there is another site of this name")
        if name:
            self.sites[name] = (body, frame)


def symbol(name: str) -> str:
    """A name of letters, digits and _ that begins with a letter."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return plain if plain[:1].isalpha() else f"n{plain}"
