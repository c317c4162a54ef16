"""A mechanism at one configuration in numbers: where its bodies are, and which of their points others hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import cos, sin

import numpy as np

from nullbody.formats import RigidFrame, frame, mass_properties, number
from nullbody.mechanism import (
    GROUND,
    AbstractJoint,
    Free,
    FreeQuaternion,
    KnifeEdge,
    Mechanism,
    Placement,
    Planar,
    RollingDisc,
    Spring,
)
from nullbody.typing import FloatArray

__all__ = ["Skeleton", "skeleton"]

_LOOSE = (Free, FreeQuaternion, Planar)  # in the tree they hold nothing: the body goes where the loops let it
_SAME = 1e-9  # relative to the size of the mechanism: points that are nearer are one


@dataclass(frozen=True)
class Skeleton:
    """Poses, and points that joints and loads hold.

    Attributes:
        mechanism: what it is of.
        values: parameters by name.
        q: coordinates by name [m, rad].
        frames: of all bodies and the ground, in the ground frame.
    """

    mechanism: Mechanism
    values: Mapping[str, float]
    q: Mapping[str, float]
    frames: Mapping[str, RigidFrame]

    def place(self, body: str, placement: Placement) -> RigidFrame:
        """A frame that is fixed on a body, in the ground frame."""
        return self.frames[body] @ frame(placement, self.values)

    def held(self, body: str) -> list[FloatArray]:
        """Points of a body that joints, constraints and springs hold, in the ground frame, each once [m]."""
        points: list[FloatArray] = []
        for placement in self._placements(body):
            point = self.place(body, placement).position
            if all(np.abs(point - other).max() > _SAME * self.size for other in points):
                points.append(point)
        return points

    def centre(self, body: str) -> tuple[float, FloatArray]:
        """Mass [kg] and centre of mass in the ground frame [m]."""
        (found,) = (b for b in self.mechanism.bodies if b.name == body)
        mass, local, _ = mass_properties(found, self.values)
        return mass, self.frames[body].rotation @ local + self.frames[body].position

    @property
    def size(self) -> float:
        """Half the diagonal of a box around all joints and centres of mass [m]."""
        points = self.cloud
        return float(np.linalg.norm(np.ptp(points, axis=0))) / 2 or 1.0

    @property
    def cloud(self) -> FloatArray:
        """All points that must be seen, row by row [m]."""
        points = [self.place(body, at).position for body in self.frames for at in self._placements(body)]
        for body in self.mechanism.bodies:
            centre = self.centre(body.name)[1]
            points += [centre, *(2 * centre - self.place(body.name, at).position for at in self._lone(body.name))]
        for part in self.mechanism.constraints:
            if isinstance(part, RollingDisc):
                centre, radius = self.place(part.body, part.on).position, number(part.radius, self.values)
                points += [*(centre + radius * np.eye(3)), *(centre - radius * np.eye(3))]
        return np.array(points)

    def _lone(self, body: str) -> list[Placement]:
        """The only place where a body is held, if there is but one: it is drawn to the other side of its centre."""
        places = list(dict.fromkeys(self._placements(body)))
        return places if len(places) == 1 else []

    def _placements(self, body: str) -> Iterator[Placement]:
        """Where joints, constraints and springs hold a body."""
        joints: tuple[AbstractJoint, ...] = (*self.mechanism.joints, *self.mechanism.loops)
        for joint in joints:
            if isinstance(joint, _LOOSE) and joint in self.mechanism.joints:
                continue
            if joint.parent == body:
                yield joint.at
            if joint.child == body:
                yield joint.on
        for part in self.mechanism.constraints:
            if isinstance(part, KnifeEdge | RollingDisc) and part.body == body:
                yield part.on
        for load in self.mechanism.loads:
            if isinstance(load, Spring):
                ends = ((load.body_a, load.point_a), (load.body_b, load.point_b))
                yield from (Placement(point) for end, point in ends if end == body)


def skeleton(mechanism: Mechanism, values: Mapping[str, float], q: Mapping[str, float]) -> Skeleton:
    """The mechanism at coordinates q: each child's frame from its parent's, R = R_parent R_at R_q R_on^T."""
    frames = {GROUND: RigidFrame(np.eye(3), np.zeros(3))}
    for joint in mechanism.tree_order():
        motion = joint.motion([q[name] for name in joint.coordinates], sin, cos)
        moved = RigidFrame(np.array(motion.pose.rotation, dtype=float), np.array(motion.pose.position, dtype=float))
        at, on = frame(joint.at, values), frame(joint.on, values)
        frames[joint.child] = frames[joint.parent] @ at @ moved @ on.inverse()
    return Skeleton(mechanism, values, q, frames)
