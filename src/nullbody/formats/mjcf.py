"""MJCF: a mechanism as a document for MuJoCo, with the same coordinates and the same q."""

from __future__ import annotations

import re
from collections.abc import Mapping
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from nullbody.errors import MechanismError
from nullbody.formats.look import add_look
from nullbody.formats.mjcf_writer_parts import Parts
from nullbody.formats.mjcf_writer_tree import Tree, mjcf_numbers
from nullbody.formats.rigid import triple
from nullbody.mechanism import Mechanism

__all__ = ["write_mjcf"]

_COMPILER = {
    "angle": "radian",
    "autolimits": "false",
    "inertiafromgeom": "false",
    "balanceinertia": "false",
    "boundmass": "0",
    "boundinertia": "0",
}

_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # XML has no word for these


def write_mjcf(mechanism: Mechanism, values: Mapping[str, float] | None = None) -> str:
    """An MJCF document whose joints are the coordinates: same names, same zero, same sign.

    A Free joint becomes three slides and three hinges (phi, theta, psi; MuJoCo applies the first listed joint
    nearest to the parent), Euler parameters a ball with the name of e0 and the same four numbers in qpos. A massless
    body with one child is merged into it. An inertia below 1e-15 kg m^2 (thin rods about their axis, point masses)
    is written as 1e-15, the least that MuJoCo takes.

    A spherical loop joint becomes two sites, <loop>_a and <loop>_b, and a `connect` between them, a weld a `weld`,
    a revolute one two `connect` at two points of its axis, a distance a tendon of fixed length, a coupling a `joint`
    equality; MuJoCo holds all of them only softly. Springs become tendons or joint springs; of friction, the Coulomb
    part is `frictionloss`, which MuJoCo does not regularise. Bodies carry a look without mass or contact. The key frame
    "home" is the mechanism's home.

    Args:
        mechanism: what is written.
        values: parameter values that differ from the mechanism's own [SI].

    Raises:
        UnknownName, ParameterError: unknown or non-physical values.
        MechanismError: a massless body that cannot be merged, a name that MuJoCo reserves or XML cannot hold, a
            chain of more than 496 bodies, or a joint, constraint or load that MuJoCo has no word for (friction with a
            speed other than 0.001 is one); the message names it.
    """
    checked = mechanism.values(values)
    root = Element("mujoco", model=mechanism.name)
    SubElement(root, "compiler", _COMPILER)
    gravity = mjcf_numbers(triple(mechanism.gravity, checked))
    SubElement(root, "option", gravity=gravity, timestep="0.001", integrator="implicitfast")
    tree = Tree(mechanism, checked)
    tree.grow(SubElement(root, "worldbody"))
    add_look(tree)
    Parts(tree, root).write()
    home = mechanism.home_values(checked)
    qpos = mjcf_numbers(home[name] for name in tree.order)
    SubElement(SubElement(root, "keyframe"), "key", name="home", qpos=qpos)
    indent(root)
    text = tostring(root, encoding="unicode") + "\n"
    wrong = _NO_XML.search(text)
    if wrong:
        around = text[max(0, wrong.start() - 20) : wrong.start() + 20]
        raise MechanismError(f"the character {wrong[0]!r} cannot stand in XML, in {around!r}: take it out of that name")
    return text
