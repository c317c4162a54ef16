"""The spanning tree as a document for MuJoCo, for the engine alone: one carrier for each joint, one body on it.

The carrier is the joint's frame on the child. It has the joint's slides, hinges and ball, and the body is fixed on it.
MuJoCo refuses moving bodies without mass, so everything weighs 1 here; the engine puts the true masses in afterwards.
The carriers' dummy inertia lies aside so that MuJoCo takes no body for one with a diagonal mass matrix of its own.
(`nullbody.formats.write_mjcf` is for users: it merges massless bodies and adds a look.)
"""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree.ElementTree import Element, SubElement, tostring

import numpy as np

from nullbody.formats import RigidFrame, frame, mass_properties, steps, triple
from nullbody.mechanism import GROUND, Mechanism
from nullbody.typing import FloatArray

__all__ = ["body_name", "principal_inertia", "step_name", "tree_document"]

_COMPILER = {"angle": "radian", "inertiafromgeom": "false", "balanceinertia": "false", "autolimits": "false"}
_DUMMY = {"mass": "1", "diaginertia": "1 1 1"}
_ASIDE = {"pos": "0.1 0.2 0.3", "xyaxes": "0.6 0.8 0 -0.8 0.6 0", **_DUMMY}


def tree_document(mechanism: Mechanism, values: Mapping[str, float]) -> str:
    """The document of all bodies and tree joints, without loops.

    Raises:
        MechanismError: a type of joint that `steps` does not know.
    """
    root = Element("mujoco")
    SubElement(root, "compiler", _COMPILER)
    SubElement(root, "option", gravity=_text(triple(mechanism.gravity, values)))
    elements = {GROUND: SubElement(root, "worldbody")}
    bodies = {body.name: body for body in mechanism.bodies}
    for joint in mechanism.tree_order():
        carrier = SubElement(elements[joint.parent], "body", _place(frame(joint.at, values)))
        chain = steps(joint)
        for step in chain:
            made = SubElement(carrier, "joint", name=step_name(step.coordinate), type=step.kind)
            made.set("axis", _text(step.axis))
        if chain:
            SubElement(carrier, "inertial", _ASIDE)
        back = frame(joint.on, values).inverse()
        body = SubElement(carrier, "body", {"name": body_name(joint.child), **_place(back)})
        _, centre, inertia = mass_properties(bodies[joint.child], values)
        _, axes = principal_inertia(inertia)
        SubElement(body, "inertial", {"pos": "0 0 0", **_place(RigidFrame(axes, centre)), **_DUMMY})
        elements[joint.child] = body
    return tostring(root, encoding="unicode")


def body_name(body: str) -> str:
    """What a body is called there; MuJoCo keeps "world" for itself."""
    return f"body {body}"


def step_name(coordinate: str) -> str:
    """What a slide, hinge or ball is called there, by its first coordinate."""
    return f"joint {coordinate}"


def principal_inertia(inertia: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Principal moments [kg m^2], and the axes that they belong to as columns of a rotation matrix."""
    if not np.count_nonzero(inertia - np.diag(np.diag(inertia))):
        return np.diag(inertia), np.eye(3)
    moments, axes = np.linalg.eigh(inertia)
    return moments, axes * np.round(np.linalg.det(axes))


def _place(at: RigidFrame) -> dict[str, str]:
    return {"pos": _text(at.position), "xyaxes": _text([*at.rotation[:, 0], *at.rotation[:, 1]])}


def _text(numbers: object) -> str:
    return " ".join(repr(float(number)) for number in numbers)  # type: ignore[attr-defined]
