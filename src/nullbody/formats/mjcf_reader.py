"""MJCF read into a mechanism: bodies, joints and masses; loops, springs and inputs are in the modules beside it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from nullbody.errors import InputError
from nullbody.formats.document import Document, Source, document
from nullbody.formats.mjcf_class import Classes
from nullbody.formats.mjcf_contact import Surface, refuse_contacts
from nullbody.formats.mjcf_joint import add_joints
from nullbody.formats.mjcf_loop import add_actuators, add_equalities, add_tendons
from nullbody.formats.mjcf_mass import MassProperties, body_of, geom_mass, inertial_mass, together
from nullbody.formats.mjcf_pose import Angles, point, pose
from nullbody.formats.mjcf_rules import check_attributes, check_children, check_names, check_options
from nullbody.formats.mjcf_scene import IGNORABLE, Scene
from nullbody.formats.rigid import RigidFrame
from nullbody.formats.xml_tree import XmlElement, xml_tree
from nullbody.mechanism import GROUND, Mechanism, MechanismBuilder

__all__ = ["read_mjcf", "read_mjcf_document"]


def read_mjcf(source: Source, ignore: Collection[str] = ()) -> Mechanism:
    """Read an MJCF document for MuJoCo.

    Bodies with <inertial> or simple geoms; hinge, slide, ball and free joints, several in one body by massless bodies
    between them; springs, dampers, armature; equality constraints connect, weld, joint (exact, not soft as in MuJoCo);
    springs between two sites; motors, whose input here is the force in the joint, gear times MuJoCo's control.
    frictionloss becomes Coulomb friction, regularised below 0.001 m/s or rad/s. Looks, sensors and the settings of
    MuJoCo's solver are left out. Home is the key frame "home", or the reference pose.

    Args:
        source: a path, or the text itself.
        ignore: what may be left out although it changes the motion: "contact", "limit" (stops of joints).

    Raises:
        ModelFileError: anything else that changes the dynamics and is not known here; the message names the element
            and its line.
        InputError: an `ignore` that is no list of those words.
        MechanismError, UnknownName: a mechanism that makes no sense.
    """
    return read_mjcf_document(document(source), ignore)


def read_mjcf_document(given: Document, ignore: Collection[str] = ()) -> Mechanism:
    """The mechanism of a document that has been read."""
    if not isinstance(ignore, Collection):
        raise InputError(f"ignore is a list of words from {', '.join(IGNORABLE)}, not {ignore!r}")
    ignored = (ignore,) if isinstance(ignore, str) else tuple(ignore)
    for word in ignored:
        if word not in IGNORABLE:
            raise InputError(f"there is nothing to ignore called {word!r}; choose from {', '.join(IGNORABLE)}")
    root = xml_tree(given)
    if root.tag != "mujoco":
        root.refuse("an MJCF document begins with <mujoco>")
    check_children(root)
    check_options(root)
    check_names(root)
    scene = _scene(root, ignored)
    scene.free_frames[GROUND] = point((0, 0, 0))
    for world in root.all("worldbody"):
        _Grower(scene).grow(world, _Carrier(GROUND, point((0, 0, 0)), GROUND, GROUND, world.text("childclass") or None))
    if not scene.frames.keys() - {GROUND}:
        root.refuse("there is no body in it")
    if "contact" not in ignored:
        refuse_contacts(root, scene.surfaces, scene.bodies, GROUND)
    add_tendons(scene)
    add_equalities(scene)
    add_actuators(scene)
    _add_home(scene)
    try:
        return scene.builder.build()
    except InputError as error:
        raise given.located(error) from None


def _scene(root: XmlElement, ignored: Collection[str]) -> Scene:
    """What all elements of the document share."""
    compiler = {key: value for element in root.all("compiler") for key, value in element.attributes.items()}
    merged = XmlElement("compiler", compiler, [], root.line, root.given)
    sequence = merged.text("eulerseq", "xyz")
    if len(sequence) != 3 or set(sequence.lower()) - set("xyz"):
        merged.refuse(f"eulerseq is three of x, y, z, X, Y, Z, not {sequence!r}")
    angles = Angles(merged.choice("angle", ("degree", "radian"), "degree") == "degree", sequence)
    option = {key: value for element in root.all("option") for key, value in element.attributes.items()}
    gravity = XmlElement("option", option, [], root.line, root.given).numbers("gravity", 3, (0, 0, -9.81))
    flags = {key: value for e in root.all("option") for f in e.all("flag") for key, value in f.attributes.items()}
    if flags.get("gravity") == "disable":
        gravity = [0.0, 0.0, 0.0]
    if flags.get("limit") == "disable":
        ignored = (*ignored, "limit")
    builder = MechanismBuilder(root.text("model", "MuJoCo Model") or "MuJoCo Model", gravity)
    return Scene(root, builder, angles, Classes(root), merged, tuple(ignored))


@dataclass(frozen=True)
class _Carrier:
    """What carries the bodies inside an element.

    Attributes:
        name: of the body.
        frame: its pose in the reference configuration.
        welded: the nearest body up the tree that can move.
        above: `welded` of the one that carries that one.
        childclass: default class of elements inside.
    """

    name: str
    frame: RigidFrame
    welded: str
    above: str
    childclass: str | None


@dataclass(frozen=True)
class _Grower:
    """Walks the tree of bodies."""

    scene: Scene

    def grow(self, element: XmlElement, carrier: _Carrier) -> None:
        """All that is in a body, then the bodies on it."""
        check_children(element)
        scene = self.scene
        scene.frames[carrier.name] = carrier.frame
        for site in element.all("site"):
            self._site(site, carrier)
        body = "world" if element.tag == "worldbody" else element.text("name")
        for geom in element.all("geom"):
            resolved = scene.classes.resolved(geom, carrier.childclass)
            check_attributes(resolved)
            scene.surfaces.append(Surface(resolved, body, carrier.welded, carrier.above))
        for child in element.all("body"):
            self._body(child, carrier)

    def _site(self, element: XmlElement, carrier: _Carrier) -> None:
        site = self.scene.classes.resolved(element, carrier.childclass)
        check_attributes(site)
        frame = pose(site, self.scene.angles)
        ends = np.array(site.numbers("fromto", 6))
        if ends.size:
            site.refuse("a site along fromto is not known here: give it a pos")
        self.scene.add_site(element, carrier.name, frame)

    def _body(self, element: XmlElement, carrier: _Carrier) -> None:
        scene = self.scene
        check_attributes(element)
        if element.text("mocap", "false") == "true" or element.number("gravcomp"):
            element.refuse("mocap and gravcomp are not known here: take them out")
        place = pose(element, scene.angles)
        name = scene.body_name(element)
        childclass = element.text("childclass") or carrier.childclass
        joints = [scene.classes.resolved(joint, childclass) for joint in element.all("joint")]
        joints += list(element.all("freejoint"))
        with scene.at(element):
            scene.builder.add(body_of(name, self._mass(element, childclass)))
        free = add_joints(scene, joints, element, (carrier.name, name), place)
        scene.free_frames[name] = scene.free_frames[carrier.name] @ free
        frame = carrier.frame @ place
        moved = _Carrier(name, frame, name, carrier.welded, childclass)
        fixed = _Carrier(name, frame, carrier.welded, carrier.above, childclass)
        self.grow(element, moved if joints else fixed)

    def _mass(self, element: XmlElement, childclass: str | None) -> MassProperties:
        """From <inertial>, or from the geoms, as the compiler's inertiafromgeom says."""
        scene = self.scene
        rule = scene.compiler.choice("inertiafromgeom", ("auto", "true", "false"), "auto")
        inertials = list(element.all("inertial"))
        if len(inertials) > 1:
            inertials[1].refuse("a body has one <inertial>")
        if inertials and rule != "true":
            check_attributes(inertials[0])
            return inertial_mass(inertials[0], scene.angles)
        if rule == "false":
            return together([])
        low, high = scene.compiler.numbers("inertiagrouprange", 2, (0, 5))
        geoms = [scene.classes.resolved(geom, childclass) for geom in element.all("geom")]
        counted = [geom for geom in geoms if low <= geom.number("group") <= high]
        parts = [geom_mass(geom, scene.angles) for geom in counted]
        return together([part for part in parts if part is not None])


def _add_home(scene: Scene) -> None:
    """The key frame "home"."""
    for frames in scene.root.all("keyframe"):
        for key in frames.all("key"):
            if key.text("name") != "home" or "qpos" not in key.attributes:
                continue
            names = [name for group in scene.positions for name in group]
            values = key.numbers("qpos", len(names))
            scene.home.update(dict(zip(names, values, strict=True)))
    scene.builder.home(scene.home)
