"""Equality constraints, tendons and actuators of MJCF: loop joints, couplings, springs and inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from nullbody.formats.mjcf_pose import Angles, placement, point, pose
from nullbody.formats.mjcf_rules import check_attributes
from nullbody.formats.mjcf_scene import Scene
from nullbody.formats.rigid import RigidFrame
from nullbody.formats.xml_tree import XmlElement

__all__ = ["add_actuators", "add_equalities", "add_tendons"]

_SAME = 1e-12  # relative; two spring lengths that are one


def add_tendons(scene: Scene) -> None:
    """<spatial> between two sites: a spring and damper; a tendon of a fixed length is a constraint."""
    for section in scene.root.all("tendon"):
        for given in section.children:
            tendon = scene.classes.resolved(given, None)
            if tendon.tag != "spatial":
                if tendon.tag == "fixed" and not any(
                    tendon.number(k) for k in ("stiffness", "damping", "frictionloss")
                ):
                    continue
                tendon.refuse(f"<{tendon.tag}> tendons are not known here: write springs at the joints")
            _tendon(scene, tendon)


def _tendon(scene: Scene, tendon: XmlElement) -> None:
    check_attributes(tendon)
    parts = tendon.children
    if [part.tag for part in parts] != ["site", "site"]:
        tendon.refuse("a tendon is a straight line between two sites here: write one for each part")
    ends = [scene.site(part, "site") for part in parts]
    rest = _span(scene.frames, ends)
    if tendon.number("frictionloss") or tendon.number("armature"):
        tendon.refuse("frictionloss and armature of tendons are not known here: take them out")
    limited = tendon.choice("limited", ("auto", "true", "false"), "auto")
    automatic = "range" in tendon.attributes and scene.compiler.text("autolimits", "true") == "true"
    if (limited == "true" or (limited == "auto" and automatic)) and "limit" not in scene.ignored:
        tendon.refuse("stops are not modelled here: take range out, set limited='false', or give ignore=('limit',)")
    number = len(scene.tendons) + 1
    scene.tendons[tendon.text("name") or f" {number}"] = (tendon, ends, rest)  # without a name, none can refer to it
    stiffness, damping = tendon.number("stiffness"), tendon.number("damping")
    if not (stiffness or damping):
        return
    lengths = tendon.numbers("springlength", (1, 2), (-1,))
    if len(lengths) == 2 and abs(lengths[0] - lengths[1]) > _SAME * abs(lengths[1]):
        tendon.refuse("a spring that is slack between two lengths is not known here: give one springlength")
    length = _span(scene.free_frames, ends) if lengths[0] < 0 else lengths[0]
    (a, at), (b, on) = ends
    with scene.at(tendon):
        points = (at.position.tolist(), on.position.tolist())
        name = tendon.text("name") or f"tendon {number}"
        scene.builder.spring(name, a, b, stiffness, length, damping, *points)


def _span(frames: Mapping[str, RigidFrame], ends: Sequence[tuple[str, RigidFrame]]) -> float:
    """Distance of two sites."""
    start, end = ((frames[body] @ frame).position for body, frame in ends)
    return float(np.linalg.norm(end - start))


def add_equalities(scene: Scene) -> None:
    """connect, weld, joint, and tendon between two sites; those that are not active are left out."""
    for section in scene.root.all("equality"):
        for given in section.children:
            element = scene.classes.equality(given)
            if element.text("active", "true") == "false":
                continue
            kinds = {"connect": _connect, "weld": _weld, "joint": _couple, "tendon": _keep_length}
            if element.tag not in kinds:
                element.refuse(f"<{element.tag}> is not known here; known: {', '.join(kinds)}")
            check_attributes(element, f"equality {element.tag}" if element.tag in ("joint", "tendon") else "")
            with scene.at(element):
                kinds[element.tag](scene, element)


def _ends(scene: Scene, element: XmlElement) -> tuple[tuple[str, RigidFrame], tuple[str, RigidFrame]]:
    return scene.site(element, "site1"), scene.site(element, "site2")


def _connect(scene: Scene, element: XmlElement) -> None:
    """Two sites meet; or the anchor on body1 and the point of body2 that is there in the reference configuration."""
    name = scene.name(element, "connect")
    if "site1" in element.attributes:
        (a, at), (b, on) = _ends(scene, element)
    else:
        element.required("body1")
        a, b = scene.body(element, "body1"), scene.body(element, "body2")
        element.required("anchor")
        at = point(element.numbers("anchor", 3))
        on = scene.frames[b].inverse() @ scene.frames[a] @ at
    points = (at.position.tolist(), on.position.tolist())
    scene.builder.spherical(name, a, b, *points, loop=True)


def _weld(scene: Scene, element: XmlElement) -> None:
    """Two sites coincide; or body2 stays where relpose, or the reference configuration, has it in body1."""
    name = scene.name(element, "weld")
    if element.number("torquescale", 1.0) <= 0:
        element.refuse("a torquescale of 0 leaves the turning free: write <connect>, or take torquescale out")
    if "site1" in element.attributes:
        (a, at), (b, on) = _ends(scene, element)
        scene.builder.weld(name, a, b, placement(at), placement(on), loop=True)
        return
    element.required("body1")
    a, b = scene.body(element, "body1"), scene.body(element, "body2")
    given = element.numbers("relpose", 7, (0, 1, 0, 0, 0, 0, 0))
    relative = scene.frames[a].inverse() @ scene.frames[b]
    if any(given[3:]):
        words = {"pos": " ".join(map(repr, given[:3])), "quat": " ".join(map(repr, given[3:]))}
        relative = pose(XmlElement("relpose", words, [], element.line, element.given), Angles())
    scene.builder.weld(name, a, b, placement(relative), loop=True)


def _couple(scene: Scene, element: XmlElement) -> None:
    """q1 - ref1 = a0 + a1 (q2 - ref2) + ... + a4 (q2 - ref2)^4; without joint2, q1 stays at ref1 + a0."""
    name = scene.name(element, "coupling")
    first = scene.joint(element, "joint1")
    given = element.numbers("polycoef", range(1, 6), (0,))
    a0, a1, *higher = given + [0.0, 1.0, 0.0, 0.0, 0.0][len(given) :]  # as in MuJoCo, a1 is 1 where it is not given
    if "joint2" not in element.attributes:
        fixed = first.reference + a0
        scene.builder.driver(name, first.coordinate, fixed)
        return
    second = scene.joint(element, "joint2")
    if not any(higher[:3]):
        offset = first.reference + a0 - a1 * second.reference
        scene.builder.coupling(name, first.coordinate, second.coordinate, a1, offset)
        return
    x = f"({second.coordinate} - ({second.reference!r}))"
    terms = "".join(f" - ({a!r})*{x}^{power}" for power, a in enumerate((a1, *higher[:3]), 1))
    scene.builder.holonomic(name, f"{first.coordinate} - ({first.reference + a0!r}){terms}")


def _keep_length(scene: Scene, element: XmlElement) -> None:
    """A tendon between two sites that keeps its length: a massless rod."""
    name = scene.name(element, "rod")
    wanted = element.required("tendon1")
    if wanted not in scene.tendons:
        known = ", ".join(name for name in scene.tendons if not name.startswith(" ")) or "none"
        element.refuse(f"tendon1: there is no spatial tendon {wanted!r}; known: {known}")
    a0, *slope = element.numbers("polycoef", range(1, 6), (0, 1, 0, 0, 0))
    if "tendon2" in element.attributes or any(slope[1:]):
        element.refuse("tendons that follow each other are not known here")
    _, ((a, at), (b, on)), rest = scene.tendons[wanted]
    points = (at.position.tolist(), on.position.tolist())
    scene.builder.distance(name, a, b, rest + a0, *points)


def add_actuators(scene: Scene) -> None:
    """Motors: force = gear * control, limited by gear times ctrlrange and forcerange."""
    for section in scene.root.all("actuator"):
        for given in section.children:
            motor = scene.classes.resolved(given, None)
            if motor.tag not in ("motor", "general"):
                motor.refuse(f"<{motor.tag}> acts by a law of its own that is not known here: write a <motor>")
            check_attributes(motor, "actuator")
            with scene.at(motor):
                _motor(scene, motor)


def _motor(scene: Scene, motor: XmlElement) -> None:
    attribute = next((key for key in ("joint", "jointinparent") if key in motor.attributes), "joint")
    joint = scene.joint(motor, attribute)
    for key, plain in (("dyntype", "none"), ("gaintype", "fixed"), ("biastype", "none")):
        if motor.text(key, plain) != plain:
            motor.refuse(f"{key}={motor.text(key)!r} is a law of its own that is not known here: write a <motor>")
    if motor.number("delay") or motor.number("nsample"):
        motor.refuse("a delay is not known here: take it out")
    gain = motor.numbers("gainprm", range(1, 11), (1,))[0]
    gear, *others = motor.numbers("gear", range(1, 7), (1,))
    if any(others):
        motor.refuse("only the first number of gear acts on a hinge or slide: take the others out")
    bounds = [_bounds(scene, motor, "ctrl", gear * gain), _bounds(scene, motor, "force", gear)]
    low, high = max(bound[0] for bound in bounds), min(bound[1] for bound in bounds)
    limits = None if (low, high) == (-np.inf, np.inf) else (low, high)
    scene.builder.actuator(scene.name(motor, "motor"), joint.coordinate, limits)


def _bounds(scene: Scene, motor: XmlElement, kind: str, factor: float) -> tuple[float, float]:
    """Least and largest force in the joint that a range of the motor allows."""
    limited = motor.choice(f"{kind}limited", ("auto", "true", "false"), "auto")
    given = motor.numbers(f"{kind}range", 2)
    automatic = scene.compiler.text("autolimits", "true") == "true"
    if not given or limited == "false" or (limited == "auto" and not automatic):
        return (-np.inf, np.inf)
    ends = sorted(factor * end for end in given)
    return ends[0], ends[1]
