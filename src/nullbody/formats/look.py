"""What the bodies look like in MuJoCo's viewer: rods between the points where something is joined."""

from __future__ import annotations

from itertools import pairwise
from xml.etree.ElementTree import SubElement

import numpy as np

from nullbody.formats.mjcf_writer_tree import Tree
from nullbody.mechanism import GROUND, Free, FreeQuaternion
from nullbody.typing import FloatArray

__all__ = ["add_look"]

_INERT = {"contype": "0", "conaffinity": "0", "mass": "0", "group": "1"}
_COLOURS = ("0.35 0.5 0.7 1", "0.8 0.5 0.25 1")  # bodies; the end effector
_THICKNESS = 0.02  # radius of rods against the longest of them


def add_look(tree: Tree) -> None:
    """Add geoms to the elements of bodies: nothing touches, nothing weighs, so the dynamics stay as they are.

    A body with two joined points is a rod, one with more is a ring of rods, one with a single point a ball.
    """
    outlines = {name: _outline(tree, name) for name in tree.elements if name != GROUND}
    lengths = [float(np.linalg.norm(b - a)) for points in outlines.values() for a, b in _sides(points)]
    radius = _THICKNESS * max(lengths, default=0) or _THICKNESS
    for name, points in outlines.items():
        look = {**_INERT, "rgba": _COLOURS[name == tree.mechanism.end_effector]}
        for a, b in _sides(points):
            ends = " ".join(f"{x:.6g}" for x in (*a, *b))
            rod = {"type": "capsule", "fromto": ends, "size": f"{radius:.6g}", **look}
            SubElement(tree.elements[name], "geom", rod)
        if len(points) == 1:
            centre = " ".join(f"{x:.6g}" for x in points[0])
            ball = {"type": "sphere", "pos": centre, "size": f"{2 * radius:.6g}", **look}
            SubElement(tree.elements[name], "geom", ball)


def _outline(tree: Tree, name: str) -> list[FloatArray]:
    """The distinct points of a body at which joints and loops hold it, in its element."""
    mechanism = tree.mechanism
    own = [
        joint.on for joint in mechanism.joints if joint.child == name and not isinstance(joint, Free | FreeQuaternion)
    ]
    held = own + [joint.at for joint in mechanism.joints if joint.parent == name]
    held += [loop.at for loop in mechanism.loops if loop.parent == name]
    held += [loop.on for loop in mechanism.loops if loop.child == name]
    distinct: list[FloatArray] = []
    for place in held:
        point = tree.local(name, place).position
        if not any(np.allclose(point, other, rtol=0, atol=1e-9) for other in distinct):
            distinct.append(point)
    return distinct


def _sides(points: list[FloatArray]) -> list[tuple[FloatArray, FloatArray]]:
    """Neighbouring points, closed to a ring from three points on."""
    open_line = list(pairwise(points))
    return [*open_line, (points[-1], points[0])] if len(points) > 2 else open_line
