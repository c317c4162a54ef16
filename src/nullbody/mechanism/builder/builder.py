"""MechanismBuilder: a mechanism told piece by piece, joints between any bodies in any order."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, Literal

from nullbody.errors import MechanismError, UnknownName
from nullbody.expr.parse import names_in
from nullbody.mechanism.body import AXES, GROUND, Axis
from nullbody.mechanism.builder.bodies import AbstractBodyMethods
from nullbody.mechanism.builder.constraints import AbstractConstraintMethods
from nullbody.mechanism.builder.joints import AbstractJointMethods, default_names
from nullbody.mechanism.builder.loads import AbstractLoadMethods
from nullbody.mechanism.builder.record import ORIGIN, Told
from nullbody.mechanism.builder.spanning_tree import Branch, Edge, bases, spanning_tree, unreached
from nullbody.mechanism.builder.text import scalar, triple
from nullbody.mechanism.builder.turning import keeps_meaning, turned, turned_home
from nullbody.mechanism.constraints import KnifeEdge, RollingDisc
from nullbody.mechanism.joints import (
    AbstractLoopJoint,
    AbstractTreeJoint,
    Free,
    FreeQuaternion,
    Planar,
)
from nullbody.mechanism.mechanism import Mechanism
from nullbody.typing import Scalar

__all__ = ["MechanismBuilder"]

_REFERENCES = ("coordinate", "driven", "driver")  # fields of constraints, loads and actuators that name a coordinate


class MechanismBuilder(AbstractBodyMethods, AbstractJointMethods, AbstractConstraintMethods, AbstractLoadMethods):
    """A mechanism told piece by piece: the only thing in nullbody that changes. `build` makes the frozen Mechanism.

    Joints come between any two bodies in any order. The spanning tree grows from the ground by the joints with the
    fewest coordinates, and of equal ones by the nearest; joints whose coordinates are driven, actuated, coupled or
    braked are preferred, and `tree=True`, `loop=True` decide. The other joints close loops. A body that only rods,
    points and other loop joints hold gets coordinates of its own.

    Every joint takes `at`, its frame on the parent, and `on`, its frame on the child: points [m], or Placements where
    the frame is turned. The two coincide where all coordinates are zero. `axis` is one of "x", "-x", ... of that frame
    or any three numbers. `names` are those of its coordinates; `coordinates="body"` gives the child coordinates against
    the ground, and the joint closes a loop.

    Args:
        name: of the mechanism.
        gravity: acceleration of gravity in the ground frame [m/s^2].
        own: coordinates of bodies that no tree joint holds: "quaternion" for position and Euler parameters, "angles"
            for position, roll, pitch and yaw, "planar" for two displacements and an angle.
        normal: of the plane in which "planar" bodies move.

    Raises:
        MechanismError, UnknownName, ExpressionError: by its methods, each with the place and what to try.
    """

    def __init__(
        self,
        name: str,
        gravity: Sequence[Scalar] = ORIGIN,
        own: Literal["quaternion", "angles", "planar"] = "quaternion",
        normal: Axis = "z",
    ) -> None:
        super().__init__(name)
        self._gravity = triple(gravity, "gravity")
        if own not in ("quaternion", "angles", "planar"):
            raise MechanismError(f"own is 'quaternion', 'angles' or 'planar', not {own!r}")
        if normal not in AXES:
            raise MechanismError(f"the normal is one of {', '.join(AXES)}, not {normal!r}")
        self._own = own
        self._normal: Axis = normal
        self._end_effector: str | None = None

    def home(self, values: Mapping[str, Scalar] | None = None, **more: Scalar) -> None:
        """A configuration near which the loops close; a rough guess is enough. It fixes the assembly.

        Args:
            values, more: coordinates, or joints that have only one [m, rad]. Those of joints that close loops are left
                out.
        """
        self._alive()
        for name, value in {**(values or {}), **more}.items():
            self._home[name] = scalar(value, f"home {name!r}")

    def end_effector(self, body: str) -> None:
        """The body whose coordinates are the task."""
        self._alive()
        self._end_effector = body

    def build(self) -> Mechanism:
        """The mechanism; the builder is at its end.

        Raises:
            MechanismError: disconnected bodies, joints that cannot have the role they are given, names used twice,
                a coordinate of a joint that closes a loop.
            UnknownName, ExpressionError: a name or an expression that makes no sense.
            ParameterError: masses, inertias, lengths that are not physical for the defaults of the parameters.
        """
        self._alive()
        if not self._bodies:
            raise MechanismError(f"{self._name!r} has no bodies: add one, such as body('arm', mass=1)")
        self._check_ends()
        branches = self._branches()
        tree = self._tree_joints(branches)
        standing = {branch.edge.name for branch in branches}
        loops = [told for name, told in self._told.items() if name not in standing]
        table = _Coordinates(tree, loops)
        self._check_turned(branches)
        made = Mechanism(
            name=self._name,
            bodies=tuple(self._bodies.values()),
            joints=tuple(tree.values()),
            loops=tuple(_loop_joint(told) for told in loops),
            constraints=tuple(self._checked(table.resolved(c, "constraint"), tree) for c in self._constraints.values()),
            loads=tuple(table.resolved(load, "load") for load in self._loads.values()),
            actuators=tuple(table.resolved(actuator, "actuator") for actuator in self._actuators.values()),
            parameters=tuple(self._parameters.values()),
            gravity=self._gravity,
            home=self._home_of(branches, table),
            end_effector=self._end_effector,
        )
        made.values()
        self._built = True
        return made

    def _check_ends(self) -> None:
        known = [GROUND, *self._bodies]
        for told in self._told.values():
            joint = told.joint
            for body in (joint.parent, joint.child):
                if body not in known:
                    raise UnknownName("body", body, known, f"joint {joint.name!r}")
            if joint.parent == joint.child:
                raise MechanismError(f"joint {joint.name!r} joins body {joint.parent!r} with itself")

    def _branches(self) -> list[Branch]:
        """The spanning tree, with coordinates of their own for bodies that it does not reach."""
        wanted = self._wanted()
        edges = [self._edge(told, wanted) for told in self._told.values()]
        edges += [_own_edge(body) for body in dict.fromkeys(t.own for t in self._told.values()) if body]
        bodies = list(self._bodies)
        while True:
            branches = spanning_tree(edges)
            rest = unreached(bodies, branches)
            if not rest:
                return branches
            self._check_connected(rest)
            edges += [_own_edge(body) for body in bases(rest, edges)]

    def _edge(self, told: Told, wanted: set[str]) -> Edge:
        joint = told.joint
        role: Any = "wanted" if told.role == "any" and joint.name in wanted else told.role
        free = isinstance(joint, Free | FreeQuaternion)
        return Edge(joint.name, joint.parent, joint.child, len(joint.coordinates), role, free)

    def _wanted(self) -> set[str]:
        """Joints whose coordinates are used by name."""
        used = {name for _, name in self._references()}
        parts: list[Any] = [*self._constraints.values(), *self._loads.values()]
        for part in parts:
            for text in part.expressions:
                used |= {name.removesuffix("_dot") for name in (names_in(text) if isinstance(text, str) else ())}
        return {name for name, told in self._told.items() if used & {name, *told.joint.coordinates}}

    def _references(self) -> Iterator[tuple[Any, str]]:
        for part in (*self._constraints.values(), *self._loads.values(), *self._actuators.values()):
            for key in _keys(part):
                yield part, getattr(part, key)

    def _check_connected(self, rest: Sequence[str]) -> None:
        """Bodies that the tree does not reach must hang on the ground by something."""
        pairs = [{told.joint.parent, told.joint.child} for told in self._told.values()]
        pairs += [{GROUND, c.body} for c in self._constraints.values() if isinstance(c, KnifeEdge | RollingDisc)]
        reached, size = {GROUND}, 0
        while len(reached) != size:
            size = len(reached)
            for pair in pairs:
                if pair & reached:
                    reached |= pair
        lost = [body for body in rest if body not in reached]
        if lost:
            raise MechanismError(
                f"bodies not connected to the ground by any joint: {', '.join(lost)}; add the missing joint, or "
                f"free('{lost[0]}_free', '{lost[0]}') for a body that flies"
            )

    def _tree_joints(self, branches: Sequence[Branch]) -> dict[str, AbstractTreeJoint]:
        """The joints of the tree in the order in which they were written, then coordinates of bodies' own."""
        ways = {branch.edge.name: branch for branch in branches}
        made: dict[str, AbstractTreeJoint] = {}
        for name, told in self._told.items():
            joint = told.joint
            if name in ways:
                assert isinstance(joint, AbstractTreeJoint)
                made[name] = turned(joint) if ways[name].turned else joint
        for branch in branches:
            if branch.edge.name.startswith(_OWN):
                body = branch.edge.child
                made[branch.edge.name] = self._own_joint(body)
        return made

    def _own_joint(self, body: str) -> AbstractTreeJoint:
        name = body if body not in {**self._told, **self._constraints} else f"{body}_own"
        kinds: dict[str, AbstractTreeJoint] = {
            "quaternion": FreeQuaternion(name, GROUND, body),
            "angles": Free(name, GROUND, body),
            "planar": Planar(name, GROUND, body, axis=self._normal),
        }
        joint = kinds[self._own]
        return replace(joint, coordinates=default_names(joint, body))

    def _check_turned(self, branches: Sequence[Branch]) -> None:
        """Coordinates that change their meaning in a joint that is turned round must not be used by name."""
        wanted = self._wanted()
        for branch in branches:
            told = self._told.get(branch.edge.name)
            if told is None or not branch.turned or branch.edge.name not in wanted:
                continue
            joint = told.joint
            if isinstance(joint, AbstractTreeJoint) and not keeps_meaning(joint):
                raise MechanismError(
                    f"coordinates of joint {joint.name!r} are used by name, but it stands in the tree from "
                    f"{joint.child!r} to {joint.parent!r} and they would mean something else: exchange its parent "
                    "and child"
                )

    def _checked(self, constraint: Any, tree: Mapping[str, AbstractTreeJoint]) -> Any:
        """The constraint, if gears couple two angles and racks a displacement with an angle."""
        kind = self._kinds.get(constraint.name, "")
        wanted = {"gear": ("rad", "rad"), "rack": ("m", "rad")}.get(kind)
        if wanted:
            units = {n: u for j in tree.values() for n, u in zip(j.coordinates, j.units, strict=True)}
            found = (units[constraint.driven], units[constraint.driver])
            if found != wanted:
                raise MechanismError(
                    f"{kind} {constraint.name!r} couples coordinates in {wanted[0]} and {wanted[1]}, but "
                    f"{constraint.driven!r} is in {found[0] or '1'} and {constraint.driver!r} in {found[1] or '1'}; "
                    "for others take coupling(...)"
                )
        return constraint

    def _home_of(self, branches: Sequence[Branch], table: _Coordinates) -> dict[str, Scalar]:
        """Home of the coordinates that are left, in the meaning that they have now."""
        given: dict[str, Scalar] = {}
        for name, value in self._home.items():
            found = table.coordinate(name, "home", may_be_lost=True)
            if found is not None:
                given[found] = value
        for branch in branches:
            told = self._told.get(branch.edge.name)
            if told is not None and branch.turned and isinstance(told.joint, AbstractTreeJoint):
                given.update(turned_home(told.joint, given))
        return given


_OWN = "own coordinates of "


def _own_edge(body: str) -> Edge:
    return Edge(f"{_OWN}{body}", GROUND, body, 0, "tree", True)


def _keys(part: Any) -> list[str]:
    return [field.name for field in fields(part) if field.name in _REFERENCES]


def _loop_joint(told: Told) -> AbstractLoopJoint:
    joint = told.joint
    if not isinstance(joint, AbstractLoopJoint):
        raise MechanismError(
            f"joint {joint.name!r} is free and body {joint.child!r} has another joint in the tree: leave it out, "
            "or give the other one loop=True"
        )
    return replace(joint, coordinates=())


class _Coordinates:
    """Which coordinate a name stands for."""

    def __init__(self, tree: Mapping[str, AbstractTreeJoint], loops: Sequence[Told]) -> None:
        self.names = [name for joint in tree.values() for name in joint.coordinates]
        self.joints = {name: joint.coordinates for name, joint in tree.items()}
        self.lost = {name: told.joint.name for told in loops for name in (told.joint.name, *told.joint.coordinates)}
        for name, times in Counter(self.names).items():
            if times > 1:
                raise MechanismError(f"the coordinate name {name!r} is used {times} times: give others as names=...")

    def coordinate(self, name: str, place: str, may_be_lost: bool = False) -> str | None:
        """The coordinate of this name, or of the joint of this name."""
        if name in self.names:
            return name
        if name in self.joints:
            own = self.joints[name]
            if len(own) == 1:
                return own[0]
            raise MechanismError(
                f"{place}: joint {name!r} has {len(own)} coordinates; name one of {', '.join(own) or 'none'}"
            )
        if name in self.lost:
            if may_be_lost:
                return None
            raise MechanismError(
                f"{place} needs a coordinate of joint {self.lost[name]!r}, which closes a loop and has none: give it "
                "tree=True, and loop=True to another joint of the loop"
            )
        raise UnknownName("coordinate", name, self.names, place)

    def resolved(self, part: Any, kind: str) -> Any:
        """A constraint, load or actuator with coordinates in place of joints."""
        place = f"{kind} {part.name!r}"
        for text in getattr(part, "expressions", ()):
            for name in names_in(text) if isinstance(text, str) else ():
                stem = name.removesuffix("_dot")
                if stem not in self.names and stem in self.lost:
                    self.coordinate(stem, place)
        return replace(part, **{key: self.coordinate(getattr(part, key), place) for key in _keys(part)})
