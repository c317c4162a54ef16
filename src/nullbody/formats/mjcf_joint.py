"""Joints of MJCF: several in one body turn and slide one after the other, by massless bodies between them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nullbody.formats.mjcf_pose import about, placement, point, unit
from nullbody.formats.mjcf_rules import check_attributes
from nullbody.formats.mjcf_scene import ReadJoint, Scene
from nullbody.formats.rigid import RigidFrame
from nullbody.formats.xml_tree import XmlElement
from nullbody.mechanism import GROUND
from nullbody.typing import FloatArray

__all__ = ["add_joints"]

_KINDS = ("hinge", "slide", "ball", "free")
_RESISTANCE = ("stiffness", "damping", "armature", "frictionloss")


def add_joints(
    scene: Scene, joints: Sequence[XmlElement], body: XmlElement, ends: tuple[str, str], place: RigidFrame
) -> RigidFrame:
    """Join a body with the one that carries it; its frame on the carrier where all springs of its joints are free.

    Args:
        scene: what is told of it.
        joints: of the body, with their defaults; the first one is nearest to the carrier.
        body: the element.
        ends: carrier and body.
        place: of the body on its carrier in the reference configuration.
    """
    carrier, name = ends
    if not joints:
        with scene.at(body):
            scene.builder.weld(scene.free_name(f"{name}_fixed"), carrier, name, placement(place), tree=True)
        return place
    free = place
    for number, joint in enumerate(joints):
        last = number == len(joints) - 1
        child = name if last else scene.free_name(f"{name}_{number + 1}")
        check_attributes(joint)
        with scene.at(joint):
            if not last:
                scene.builder.body(child)
                scene.bodies[f" {child}"] = child  # cannot be named in the document
            free = free @ _add(scene, joint, body, (carrier, child), place, len(joints))
        carrier, place = child, point((0, 0, 0))
    return free


def _add(
    scene: Scene, joint: XmlElement, body: XmlElement, ends: tuple[str, str], place: RigidFrame, count: int
) -> RigidFrame:
    """Tell the builder of one joint; how far it moves from the reference configuration to where its spring is free."""
    kind = "free" if joint.tag == "freejoint" else joint.choice("type", _KINDS, "hinge")
    stem = joint.text("name").removesuffix("_e0") if kind == "ball" else joint.text("name")
    name = scene.free_name(stem or f"{ends[1]}_{kind}")
    _check(scene, joint, kind)
    builder = scene.builder
    anchor, moved = point(joint.numbers("pos", 3, (0, 0, 0))), point((0, 0, 0))
    if kind == "free":
        if ends[0] != GROUND or count > 1:
            joint.refuse("a free joint stands alone in a body of the world")
        _check_alignment(scene, joint, body)
        builder.free(name, ends[1])
        names = tuple(f"{name}_{suffix}" for suffix in ("x", "y", "z", "e0", "e1", "e2", "e3"))
        scene.home.update(dict(zip(names, [*place.position.tolist(), *_quaternion(place.rotation)], strict=True)))
    elif kind == "ball":
        builder.spherical(name, *ends, placement(place @ anchor), placement(anchor), tree=True)
        names = tuple(f"{name}_e{k}" for k in range(4))
    else:
        names = (name,)
        moved = _one_axis(scene, joint, name, ends, place)
    scene.taken.update(names)
    scene.positions.append(names)
    return moved


def _one_axis(scene: Scene, joint: XmlElement, name: str, ends: tuple[str, str], place: RigidFrame) -> RigidFrame:
    """A hinge or slide: its value in the reference configuration, where nothing has moved, is `ref`."""
    axis = unit(joint, "axis", np.array(joint.numbers("axis", 3, (0, 0, 1))))
    anchor = point(joint.numbers("pos", 3, (0, 0, 0)))
    turn = joint.text("type", "hinge") == "hinge"
    reference = _angle(scene, joint, "ref", turn)
    stretch = _angle(scene, joint, "springref", turn) - reference
    if turn:
        on = anchor @ RigidFrame(about(axis, reference), np.zeros(3)) if reference else anchor
        moved = anchor @ RigidFrame(about(axis, stretch), np.zeros(3)) @ anchor.inverse()
        scene.builder.revolute(name, *ends, placement(place @ anchor), placement(on), _axis(axis), tree=True)
    else:
        on, moved = point(reference * axis), point(stretch * axis)
        scene.builder.prismatic(name, *ends, placement(place), placement(on), _axis(axis), tree=True)
    if joint.text("name"):
        scene.joints[joint.text("name")] = ReadJoint(name, reference)
    if reference:
        scene.home[name] = reference
    _resist(scene, joint, name, turn)
    return moved


def _resist(scene: Scene, joint: XmlElement, name: str, turn: bool) -> None:
    """Spring, damper, rotor inertia and friction along the coordinate."""
    builder = scene.builder
    stiffness, damping, armature, friction = (joint.number(key) for key in _RESISTANCE)
    if stiffness or damping:
        builder.coordinate_spring(f"{name} spring", name, stiffness, _angle(scene, joint, "springref", turn), damping)
    if armature:
        builder.energy(f"{name} armature", 0, f"{armature!r}*{name}_dot^2/2")
    if friction:
        builder.friction(f"{name} friction", name, friction)


def _check(scene: Scene, joint: XmlElement, kind: str) -> None:
    """Refuse what a joint of this kind cannot have here."""
    if kind in ("ball", "free"):
        for key in _RESISTANCE:
            if joint.number(key):
                joint.refuse(f"{key} of a {kind} joint is not known here: take it out, or write three hinges")
    if any(joint.numbers("springdamper", 2, (0, 0))):
        joint.refuse("springdamper is not known here: give stiffness and damping")
    if joint.text("actuatorfrclimited", "auto") != "false" and joint.text("actuatorfrcrange"):
        joint.refuse("actuatorfrcrange is not known here: give the motor a ctrlrange")
    ranged = "range" in joint.attributes and scene.compiler.text("autolimits", "true") == "true"
    limited = joint.choice("limited", ("auto", "true", "false"), "auto")
    if (limited == "true" or (limited == "auto" and ranged)) and "limit" not in scene.ignored:
        joint.refuse("stops are not modelled here: take range out, set limited='false', or give ignore=('limit',)")


def _check_alignment(scene: Scene, joint: XmlElement, body: XmlElement) -> None:
    """Refuse where MuJoCo moves the frame of a free body without children into its centre of mass."""
    word = joint.choice("align", ("auto", "true", "false"), "auto")
    aligned = word == "true" or (word == "auto" and scene.compiler.text("alignfree", "false") == "true")
    if aligned and not any(body.all("body")):
        joint.refuse(
            "align, or alignfree of the compiler, moves the body's frame into its centre of mass, and with it the "
            "meaning of qpos: set align='false' on a <freejoint>"
        )


def _angle(scene: Scene, joint: XmlElement, name: str, turn: bool) -> float:
    given = joint.number(name)
    return scene.angles.radians(given) if turn else given


def _axis(axis: FloatArray) -> list[float]:
    return [float(component) + 0.0 for component in axis]


def _quaternion(rotation: FloatArray) -> list[float]:
    """Euler parameters of a rotation matrix, the largest one first found: 4 e_k^2 = 1 + trace-like sums."""
    K = np.array(
        [
            [np.trace(rotation), 0, 0, 0],
            [rotation[2, 1] - rotation[1, 2], 0, 0, 0],
            [rotation[0, 2] - rotation[2, 0], 0, 0, 0],
            [rotation[1, 0] - rotation[0, 1], 0, 0, 0],
        ]
    )
    K[1:, 1:] = rotation + rotation.T - np.trace(rotation) * np.eye(3)
    values, vectors = np.linalg.eigh(K)  # the lower triangle: e is the eigenvector of the largest eigenvalue
    e = vectors[:, int(np.argmax(values))]
    e = e if e[0] >= 0 else -e
    return [float(component) + 0.0 for component in e]
