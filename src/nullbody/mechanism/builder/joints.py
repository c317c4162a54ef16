"""One method for each type of joint."""

from __future__ import annotations

from abc import ABC
from dataclasses import replace
from typing import Any, Literal, Unpack

from nullbody.errors import MechanismError
from nullbody.mechanism.body import GROUND
from nullbody.mechanism.builder.direction import Direction, directed, directed_pair, turned_by
from nullbody.mechanism.builder.record import ORIGIN, AbstractRecord, Choice, Place, Told
from nullbody.mechanism.builder.text import grouped, place, scalar
from nullbody.mechanism.constraints import Coupling
from nullbody.mechanism.joints import (
    AbstractJoint,
    AbstractTreeJoint,
    Cylindrical,
    Distance,
    Free,
    FreeQuaternion,
    Planar,
    PointOnLine,
    PointOnPlane,
    Prismatic,
    Revolute,
    Spherical,
    Universal,
    Weld,
)
from nullbody.mechanism.joints.base import transverse
from nullbody.typing import Scalar

__all__ = ["AbstractJointMethods", "default_names"]

_SUFFIXES: dict[type[AbstractJoint], tuple[str, ...]] = {
    Revolute: ("",),
    Prismatic: ("",),
    Cylindrical: ("_s", "_alpha"),
    Universal: ("_alpha", "_beta"),
    Spherical: ("_e0", "_e1", "_e2", "_e3"),
    Free: ("_x", "_y", "_z", "_psi", "_theta", "_phi"),
    FreeQuaternion: ("_x", "_y", "_z", "_e0", "_e1", "_e2", "_e3"),
    Weld: (),
}


class AbstractJointMethods(AbstractRecord, ABC):
    """The methods that join two bodies, in any order. Each returns the joint's name.

    All take `at`, the joint's frame on the parent, and `on`, its frame on the child: points, or Placements where the
    frame is turned. The two frames coincide where all coordinates are zero. Where a joint ends in the spanning tree
    the other way round, coordinates keep their meaning; those of balls and planar joints are then of the parent in the
    child. Beside the geometry, each joint takes:

    names: of its coordinates; by default those that its own description gives.
    coordinates: "relative", or "body": the child gets coordinates of its own and the joint closes a loop.
    tree, loop: True where the joint must stand in the spanning tree, or close a loop.
    """

    def revolute(
        self,
        name: str,
        parent: str,
        child: str,
        at: Place = ORIGIN,
        on: Place = ORIGIN,
        axis: Direction = "z",
        **choice: Unpack[Choice],
    ) -> str:
        """The child turns by the angle `name` [rad] about an axis of the joint's frame."""
        return self._axial(Revolute, (name, parent, child), at, on, axis, choice)

    def prismatic(
        self,
        name: str,
        parent: str,
        child: str,
        at: Place = ORIGIN,
        on: Place = ORIGIN,
        axis: Direction = "z",
        **choice: Unpack[Choice],
    ) -> str:
        """The child slides by `name` [m] along an axis of the joint's frame."""
        return self._axial(Prismatic, (name, parent, child), at, on, axis, choice)

    def cylindrical(
        self,
        name: str,
        parent: str,
        child: str,
        at: Place = ORIGIN,
        on: Place = ORIGIN,
        axis: Direction = "z",
        **choice: Unpack[Choice],
    ) -> str:
        """The child slides by `name`_s [m] along an axis and turns by `name`_alpha [rad] about it."""
        return self._axial(Cylindrical, (name, parent, child), at, on, axis, choice)

    def planar(
        self,
        name: str,
        parent: str,
        child: str,
        at: Place = ORIGIN,
        on: Place = ORIGIN,
        axis: Direction = "z",
        **choice: Unpack[Choice],
    ) -> str:
        """The child slides and turns in the plane across an axis: `name`_x, `name`_y [m], `name`_alpha [rad] for z."""
        return self._axial(Planar, (name, parent, child), at, on, axis, choice)

    def screw(
        self,
        name: str,
        parent: str,
        child: str,
        lead: Scalar,
        at: Place = ORIGIN,
        on: Place = ORIGIN,
        axis: Direction = "z",
        **choice: Unpack[Choice],
    ) -> str:
        """A cylindrical joint whose displacement is lead/(2 pi) times its angle; `lead` [m] per turn."""
        self.cylindrical(name, parent, child, at, on, axis, **choice)
        s, alpha = self._told[name].joint.coordinates
        ratio = f"{grouped(scalar(lead, f'screw {name!r}'))}/(2*pi)"
        self._note("constraint", self._constraints, f"{name}_lead", Coupling(f"{name}_lead", s, alpha, ratio))
        return name

    def universal(
        self,
        name: str,
        parent: str,
        child: str,
        at: Place = ORIGIN,
        on: Place = ORIGIN,
        axis: Direction = "x",
        axis2: Direction = "y",
        **choice: Unpack[Choice],
    ) -> str:
        """Angles `name`_alpha about an axis that the parent holds, `name`_beta about `axis2` on the child [rad]."""
        where = f"joint {name!r}"
        first, second, turns = directed_pair(axis, axis2, where)
        frames = (turned_by(place(at, where), turns), turned_by(place(on, where), turns))
        return self._join(Universal(name, parent, child, (), *frames, axis=first, axis2=second), choice)

    def spherical(
        self, name: str, parent: str, child: str, at: Place = ORIGIN, on: Place = ORIGIN, **choice: Unpack[Choice]
    ) -> str:
        """A ball: two points coincide. Euler parameters `name`_e0 ... `name`_e3."""
        return self._framed(Spherical, name, (parent, child), at, on, choice)

    def weld(
        self, name: str, parent: str, child: str, at: Place = ORIGIN, on: Place = ORIGIN, **choice: Unpack[Choice]
    ) -> str:
        """Two frames coincide; no coordinates."""
        return self._framed(Weld, name, (parent, child), at, on, choice)

    def free(
        self,
        name: str,
        child: str,
        parent: str = GROUND,
        at: Place = ORIGIN,
        on: Place = ORIGIN,
        attitude: Literal["quaternion", "angles"] = "quaternion",
        **choice: Unpack[Choice],
    ) -> str:
        """Nothing holds the child: `name`_x, _y, _z [m] and Euler parameters `name`_e0 ... `name`_e3, or the angles
        `name`_psi, _theta, _phi [rad] of roll, pitch and yaw, which are singular at a pitch of 90 degrees.
        """
        if attitude not in ("quaternion", "angles"):
            raise MechanismError(f"joint {name!r} has the attitude {attitude!r}; choose 'quaternion' or 'angles'")
        if choice.get("loop") or choice.get("coordinates") == "body":
            raise MechanismError(f"joint {name!r} is free: it holds nothing and can close no loop")
        kind = FreeQuaternion if attitude == "quaternion" else Free
        return self._framed(kind, name, (parent, child), at, on, {"tree": True, **choice})

    def distance(
        self,
        name: str,
        parent: str,
        child: str,
        length: Scalar,
        at: Place = ORIGIN,
        on: Place = ORIGIN,
        **choice: Unpack[Choice],
    ) -> str:
        """A massless rod with ball ends: two points keep the distance `length` [m]. It closes a loop."""
        where = f"joint {name!r}"
        frames = (place(at, where), place(on, where))
        return self._join(Distance(name, parent, child, (), *frames, length=scalar(length, where)), choice)

    def point_on_line(
        self,
        name: str,
        parent: str,
        child: str,
        at: Place = ORIGIN,
        on: Place = ORIGIN,
        axis: Direction = "z",
        **choice: Unpack[Choice],
    ) -> str:
        """The child's point stays on a line along an axis of the parent's frame. It closes a loop."""
        return self._axial(PointOnLine, (name, parent, child), at, on, axis, choice)

    def point_on_plane(
        self,
        name: str,
        parent: str,
        child: str,
        at: Place = ORIGIN,
        on: Place = ORIGIN,
        axis: Direction = "z",
        **choice: Unpack[Choice],
    ) -> str:
        """The child's point stays in the plane across an axis of the parent's frame. It closes a loop."""
        return self._axial(PointOnPlane, (name, parent, child), at, on, axis, choice)

    def _axial(
        self, kind: Any, ends: tuple[str, str, str], at: Place, on: Place, axis: Direction, choice: Choice
    ) -> str:
        where = f"joint {ends[0]!r}"
        letter, turns = directed(axis, where)
        frames = (turned_by(place(at, where), turns), turned_by(place(on, where), turns))
        return self._join(kind(*ends, (), *frames, axis=letter), choice)

    def _framed(self, kind: Any, name: str, ends: tuple[str, str], at: Place, on: Place, choice: Choice) -> str:
        where = f"joint {name!r}"
        return self._join(kind(name, *ends, (), place(at, where), place(on, where)), choice)

    def _join(self, joint: AbstractJoint, choice: Choice) -> str:
        """Note a joint with the names of its coordinates and its role."""
        known = ("names", "coordinates", "tree", "loop")
        unknown = [key for key in choice if key not in known]
        if unknown:
            raise MechanismError(f"joint {joint.name!r} has no {unknown[0]!r}; beside its geometry it takes {known}")
        relative = choice.get("coordinates", "relative")
        if relative not in ("relative", "body"):
            raise MechanismError(
                f"joint {joint.name!r} has the coordinates {relative!r}; choose 'relative' or 'body' (its own names "
                "are given by `names`)"
            )
        tree, loop = bool(choice.get("tree")), bool(choice.get("loop")) or relative == "body"
        if tree and loop:
            raise MechanismError(f"joint {joint.name!r} cannot both stand in the tree and close a loop")
        own = (joint.child if joint.child != GROUND else joint.parent) if relative == "body" else None
        if not isinstance(joint, AbstractTreeJoint):
            if tree or "names" in choice:
                raise MechanismError(
                    f"joint {joint.name!r} is a {type(joint).__name__}: it can only close a loop and has no coordinates"
                )
            return self._note("joint", self._told, joint.name, Told(joint, "loop", own))
        named = _with_names(joint, choice.get("names"))
        return self._note(
            "joint", self._told, joint.name, Told(named, "tree" if tree else "loop" if loop else "any", own)
        )


def default_names(joint: AbstractTreeJoint, stem: str) -> tuple[str, ...]:
    """Names of a joint's coordinates, made from a name."""
    if isinstance(joint, Planar):
        u, w = ("xyz"[[abs(x) for x in side].index(1)] for side in transverse(joint.axis))
        return (f"{stem}_{u}", f"{stem}_{w}", f"{stem}_alpha")
    return tuple(stem + suffix for suffix in _SUFFIXES[type(joint)])


def _with_names(joint: AbstractTreeJoint, names: Any) -> AbstractTreeJoint:
    """The joint with the names of its coordinates."""
    count = len(joint.units)
    given = (names,) if isinstance(names, str) else None if names is None else tuple(names)
    if given is None:
        given = default_names(joint, joint.name)
    if len(given) != count:
        raise MechanismError(
            f"joint {joint.name!r} has {count} coordinates ({', '.join(default_names(joint, joint.name)) or 'none'}), "
            f"{len(given)} were named"
        )
    return replace(joint, coordinates=given)
