"""The wireframe of any mechanism: bodies as bars and plates, joints as marks, springs as zigzags, inputs as arrows."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nullbody.formats import number, triple
from nullbody.mechanism import (
    GROUND,
    AbstractTreeJoint,
    Cylindrical,
    Distance,
    Free,
    FreeQuaternion,
    KnifeEdge,
    Placement,
    Planar,
    PointOnLine,
    Prismatic,
    Revolute,
    RollingDisc,
    Spherical,
    Spring,
    Universal,
    Weld,
)
from nullbody.mechanism.joints.base import axis_vector, transverse
from nullbody.report.figure import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY
from nullbody.report.shape import Arrow, Bar, Face, Line, Mark, Shape
from nullbody.report.skeleton import Skeleton
from nullbody.typing import FloatArray

__all__ = ["shapes"]

_COLOURS = (BLUE, ORANGE, GREEN, PURPLE, SKY, "#C39B00")
_PLATE, _FLOOR, _RAIL = "#dfe5ea", "#f3f3ef", "#c9c9c4"
_THIN, _THICK = 4.0, 7.5  # widths of bars, in points
_BOX, _PIN, _ARC, _ARROW, _SHORT = 0.055, 0.05, 0.16, 0.22, 0.15  # sizes in sizes of the mechanism
_COILS, _COIL = 6, 0.03


def shapes(given: Skeleton, *, plane: bool) -> list[Shape]:
    """Everything that is drawn of a mechanism; in a plane mechanism pins are circles, not short bars."""
    found: list[Shape] = [*_ground(given, plane=plane)]
    for number_, body in enumerate(given.mechanism.bodies):
        found += _body(given, body.name, _colour(given, body.name, number_))
    for joint in given.mechanism.joints:
        found += _joint(given, joint, plane=plane)
    for loop in given.mechanism.loops:
        found += _joint(given, loop, plane=plane)
    for part in (*given.mechanism.constraints, *given.mechanism.loads):
        found += _part(given, part)
    for actuator in given.mechanism.actuators:
        found += _input(given, actuator.name, actuator.coordinate)
    return found


def _colour(given: Skeleton, body: str, place: int) -> str:
    """Bodies of one leg share the number at the end of their names, and a colour; plates are grey."""
    digits = body[len(body.rstrip("0123456789")) :]
    if digits:
        return _COLOURS[(int(digits) - 1) % len(_COLOURS)]
    return _PLATE if _spread(given.held(body)) > 1 else _COLOURS[place % len(_COLOURS)]


def _spread(points: list[FloatArray]) -> int:
    """0 for one point, 1 for points on a line, 2 or 3 for others."""
    if len(points) < 2:
        return 0
    sizes = np.linalg.svd(np.array(points) - np.mean(points, axis=0), compute_uv=False)
    return int(np.sum(sizes > 1e-6 * sizes[0]))


def _ground(given: Skeleton, *, plane: bool) -> Iterator[Shape]:
    points = given.held(GROUND)
    if not plane and _spread(points) > 1:
        yield Face(_hull(points), _FLOOR, back=True)
    elif not plane and len(points) > 1:
        yield Line(np.array(points), GREY, 1.4, dashed=True, back=True)
    if plane:
        joints = (*given.mechanism.joints, *given.mechanism.loops)
        pivots = [j for j in joints if GROUND in (j.parent, j.child) and isinstance(j, Revolute | Spherical | Distance)]
        places = [pivot.at if pivot.parent == GROUND else pivot.on for pivot in pivots]
        for load in given.mechanism.loads:
            if isinstance(load, Spring):
                ends = ((load.body_a, load.point_a), (load.body_b, load.point_b))
                places += [Placement(point) for body, point in ends if body == GROUND]
        yield from (Mark(given.place(GROUND, place).position, "support") for place in places)


def _hull(points: list[FloatArray]) -> FloatArray:
    """The corners of the convex hull of points in their plane, in order."""
    centre = np.mean(points, axis=0)
    relative = np.array(points) - centre
    u, w = np.linalg.svd(relative)[2][:2]
    flat = relative @ np.array([u, w]).T
    order = np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))
    corners: FloatArray = np.array(points)[order]
    return corners


def _body(given: Skeleton, body: str, colour: str) -> Iterator[Shape]:
    points, (mass, centre) = given.held(body), given.centre(body)
    spread = _spread(points)
    if any(isinstance(part, KnifeEdge) and part.body == body for part in given.mechanism.constraints):
        yield from _sleigh(given, body, points[0], centre)
    elif _slides(given, body) and np.ptp([*points, centre], axis=0).max() < _SHORT * given.size:
        yield from _box(given, body, colour)
    elif spread > 1:
        yield Face(_hull(points), colour)
    elif spread == 1:
        direction = points[1] - points[0]
        ordered = sorted(points, key=lambda point: float(point @ direction))
        yield Bar(np.array([ordered[0], ordered[-1]]), colour, _THIN if mass > 0 else 2.0)
    elif mass > 0 and points and np.abs(centre - points[0]).max() > 1e-6 * given.size:
        carries = any(isinstance(j, Prismatic) and j.parent == body for j in given.mechanism.joints)
        yield Bar(np.array([points[0], 2 * centre - points[0]]), colour, _THICK if carries else _THIN)
    elif mass > 0 and not any(isinstance(part, RollingDisc) for part in given.mechanism.constraints):
        yield Mark(centre, "mass", colour)


def _sleigh(given: Skeleton, body: str, blade: FloatArray, centre: FloatArray) -> Iterator[Shape]:
    """An outline around the blade and the centre of mass."""
    ahead = centre - blade
    ahead *= 1 / (float(np.linalg.norm(ahead)) or 1.0)
    left = np.cross(given.frames[body].rotation[:, 2], ahead)
    outline = ((-0.5, -0.5), (1.2, -0.5), (1.9, 0.0), (1.2, 0.5), (-0.5, 0.5))
    corners = [blade + given.size * (along * ahead + across * left) for along, across in outline]
    yield Face(np.array(corners), _PLATE)
    yield Mark(centre, "mass", _COLOURS[0])


def _tree(given: Skeleton) -> tuple[AbstractTreeJoint, ...]:
    return given.mechanism.joints


def _slides(given: Skeleton, body: str) -> bool:
    """Whether a body is a slider."""
    joints = [joint for joint in _tree(given) if joint.child == body and isinstance(joint, Prismatic | Cylindrical)]
    return any(_firm(given, joint) for joint in joints)


def _firm(given: Skeleton, joint: AbstractTreeJoint) -> bool:
    """Whether a slide is a real one: not one of a cross table that only gives a body its coordinates."""
    bodies = {body.name: given.centre(body.name)[0] for body in given.mechanism.bodies}
    chained = any(isinstance(j, Prismatic) and joint.child == j.parent for j in _tree(given))
    massless = bodies[joint.child] == 0 or bodies.get(joint.parent, 1.0) == 0
    return not massless or not (chained or isinstance(_over(given, joint), Prismatic))


def _over(given: Skeleton, joint: AbstractTreeJoint) -> AbstractTreeJoint | None:
    """The joint that carries the parent of a joint."""
    return next((j for j in _tree(given) if j.child == joint.parent), None)


def _box(given: Skeleton, body: str, colour: str) -> Iterator[Shape]:
    at, half = given.frames[body], _BOX * given.size
    signs = ((1, 1), (1, -1), (-1, -1), (-1, 1))
    for k in range(3):
        for side in (1, -1):
            corners = [np.roll([side, a, b], k) * half for a, b in signs]
            yield Face(np.array([at.position + at.rotation @ corner for corner in corners]), colour)


def _joint(given: Skeleton, joint: object, *, plane: bool) -> Iterator[Shape]:
    """The mark of a joint in the tree or in a loop, and the rail of a slide."""
    if isinstance(joint, Distance):
        ends = [given.place(joint.parent, joint.at).position, given.place(joint.child, joint.on).position]
        yield Line(np.array(ends), BLACK, 2.2)
        yield from (Mark(end, "ball") for end in ends)
    elif isinstance(joint, Free | FreeQuaternion | Planar | Weld):
        return
    elif isinstance(joint, Prismatic | Cylindrical | PointOnLine):
        if not isinstance(joint, AbstractTreeJoint) or _firm(given, joint):
            yield from _rail(given, joint)
    elif isinstance(joint, Revolute | Universal | Spherical):
        at = given.place(joint.parent, joint.at)
        if isinstance(joint, Spherical) or plane:
            yield Mark(at.position, "pin" if plane else "ball")
            return
        yield _axle(given, at.rotation @ axis_vector(joint.axis), at.position)
        if isinstance(joint, Universal):
            on = given.place(joint.child, joint.on)
            yield _axle(given, on.rotation @ axis_vector(joint.axis2), at.position)


def _axle(given: Skeleton, axis: FloatArray, point: FloatArray) -> Bar:
    reach = _PIN * given.size * axis
    return Bar(np.array([point - reach, point + reach]), "white", 3.0)


def _rail(given: Skeleton, joint: Prismatic | Cylindrical | PointOnLine) -> Iterator[Shape]:
    """The line of a slide on the ground, from its zero past the slider."""
    if joint.parent != GROUND:
        return
    at = given.place(joint.parent, joint.at)
    axis = at.rotation @ axis_vector(joint.axis)
    way = float(axis @ (given.place(joint.child, joint.on).position - at.position))
    past = 0.25 * given.size
    ends = min(0.0, way - past), max(0.0, way + past)
    yield Line(np.array([at.position + end * axis for end in ends]), _RAIL, 5.0, back=True)


def _part(given: Skeleton, part: object) -> Iterator[Shape]:
    """A spring, a blade, a rolling disc."""
    if isinstance(part, Spring):
        frames = given.frames[part.body_a], given.frames[part.body_b]
        locals_ = triple(part.point_a, given.values), triple(part.point_b, given.values)
        a, b = (at.position + at.rotation @ local for at, local in zip(frames, locals_, strict=True))
        yield Line(_zigzag(a, b, _COIL * given.size), BLACK, 1.1)
    elif isinstance(part, KnifeEdge):
        at = given.place(part.body, part.on)
        along = at.rotation @ transverse(part.axis)[1] * 0.35 * given.size
        yield Bar(np.array([at.position - along, at.position + along]), BLACK, 2.5)
    elif isinstance(part, RollingDisc):
        yield from _disc(given, part)


def _zigzag(a: FloatArray, b: FloatArray, width: float) -> FloatArray:
    along = b - a
    across = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    across *= width / (float(np.linalg.norm(across)) or 1.0)
    steps = np.linspace(0.15, 0.85, 2 * _COILS + 1)
    sides = [0.0, *(1.0 if k % 2 else -1.0 for k in range(len(steps) - 2)), 0.0]
    return np.array([a, *(a + t * along + side * across for t, side in zip(steps, sides, strict=True)), b])


def _disc(given: Skeleton, part: RollingDisc) -> Iterator[Shape]:
    at, radius = given.place(part.body, part.on), number(part.radius, given.values)
    u, w = (at.rotation @ np.array(side) * radius for side in transverse(part.axis))
    yield Face(_circle(at.position, u, w), _COLOURS[0], 0.85)
    yield from (Line(np.array([at.position - side, at.position + side]), "white", 1.2) for side in (u, w))
    plane = given.place(GROUND, part.plane)
    x, y = plane.rotation[:, 0] * 1.7 * radius, plane.rotation[:, 1] * 1.7 * radius
    below = at.position - plane.rotation[:, 2] * float(plane.rotation[:, 2] @ (at.position - plane.position))
    yield Face(_circle(below, x, y), _FLOOR, back=True)


def _circle(centre: FloatArray, u: FloatArray, w: FloatArray, turns: tuple[float, float] = (0.0, 1.0)) -> FloatArray:
    angle = 2 * np.pi * np.linspace(*turns, 61)[:, None]
    found: FloatArray = centre + np.cos(angle) * u + np.sin(angle) * w
    return found


def _input(given: Skeleton, name: str, coordinate: str) -> Iterator[Shape]:
    """An arrow for an input: along or about the direction in which its coordinate moves the body."""
    joint = next(j for j in _tree(given) if coordinate in j.coordinates)
    step = 1e-6
    motion = joint.motion([given.q[c] for c in joint.coordinates], np.sin, np.cos)
    place = joint.coordinates.index(coordinate)
    at = given.place(joint.parent, joint.at)
    turn = np.array(motion.pose.rotation, dtype=float) @ np.array(motion.angular[place], dtype=float)
    move = np.array(motion.linear[place], dtype=float)
    if np.abs(turn).max() > step:
        axis = at.rotation @ turn / np.linalg.norm(turn)
        centre = at.position if isinstance(joint, Revolute | Universal) else given.centre(joint.child)[1]
        u = _ARC * given.size * _towards(given, joint.child, centre, axis)
        yield Arrow(_circle(centre, u, np.cross(axis, u), (0.18, 0.82)), name)
        return
    body = joint.child
    while given.centre(body)[0] == 0 and (after := next((j for j in _tree(given) if j.parent == body), None)):
        body = after.child
    way = at.rotation @ move / np.linalg.norm(move) * _ARROW * given.size
    if joint.parent != GROUND and given.centre(joint.parent)[0] > 0:
        start = given.place(joint.child, joint.on).position
        yield Arrow(np.array([start - 1.2 * way, start - 0.2 * way]), name, aside=True)
        return
    start, reach = given.centre(body)[1], 3.5 if isinstance(joint, Free | FreeQuaternion) else 1.3
    yield Arrow(np.array([start + 0.3 * way, start + reach * way]), name)


def _towards(given: Skeleton, body: str, centre: FloatArray, axis: FloatArray) -> FloatArray:
    """The direction across an axis in which most of a body lies; any direction across where it lies on the axis."""
    way = np.mean([*given.held(body), given.centre(body)[1]], axis=0) - centre
    way -= float(way @ axis) * axis
    if float(np.linalg.norm(way)) < 1e-6 * given.size:
        way = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    found: FloatArray = way / np.linalg.norm(way)
    return found
