"""Mechanism: bodies, joints, loops, actuators and parameters as plain frozen data."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Any

from nullbody.errors import ExpressionError, MechanismError, ParameterError, UnknownName
from nullbody.expr.parse import parse
from nullbody.mechanism.body import AXES, GROUND, Body, Placement
from nullbody.mechanism.joints.base import AbstractLoopJoint, AbstractTreeJoint
from nullbody.mechanism.parameter import Parameter, check_expression, parameter_values
from nullbody.typing import Scalar, Triple

__all__ = ["Actuator", "Mechanism"]

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_RESERVED = {"pi", "sqrt", "sin", "cos", "t", GROUND}
_INERTIA_SLACK = 1e-9  # relative; a disc or a rod meets the triangle inequality with equality, up to rounding


@dataclass(frozen=True)
class Actuator:
    """A force [N] or torque [N m] that acts along one coordinate, conjugate to it."""

    name: str
    coordinate: str


@dataclass(frozen=True)
class Mechanism:
    """A mechanism of rigid bodies with loops; nothing in it depends on q.

    Attributes:
        name: what it is called in reports and generated code.
        bodies: all but the ground.
        joints: the spanning tree, one joint for each body; their order is the order of the coordinates.
        loops: the joints that close loops.
        actuators: the inputs u.
        parameters: symbols that lengths, masses and so on are written in.
        gravity: acceleration of gravity in the ground frame [m/s^2].
        home: coordinates of a configuration in which the loops close for every parameter set, or nearly;
            missing ones are 0.
        end_effector: the body whose coordinates are the task.

    Raises:
        MechanismError, UnknownName, ExpressionError: what it is made of makes no sense; the message says what.
    """

    name: str
    bodies: tuple[Body, ...]
    joints: tuple[AbstractTreeJoint, ...]
    loops: tuple[AbstractLoopJoint, ...] = ()
    actuators: tuple[Actuator, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    gravity: Triple = (0, 0, 0)
    home: Mapping[str, Scalar] = field(default_factory=dict)
    end_effector: str | None = None

    def __post_init__(self) -> None:
        self._check_names()
        self._check_tree()
        self._check_expressions()

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of all coordinates q, in order."""
        return tuple(name for joint in self.joints for name in joint.coordinates)

    @property
    def units(self) -> dict[str, str]:
        """SI unit of every coordinate."""
        return {name: unit for joint in self.joints for name, unit in zip(joint.coordinates, joint.units, strict=True)}

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs u, in order."""
        return tuple(actuator.name for actuator in self.actuators)

    @property
    def actuated(self) -> tuple[str, ...]:
        """The coordinates that actuators act on, in the order of the actuators."""
        return tuple(actuator.coordinate for actuator in self.actuators)

    def __str__(self) -> str:
        """A summary for the terminal."""
        lines = [f"Mechanism {self.name!r}: {len(self.bodies)} bodies, {len(self.coordinates)} coordinates"]
        for joint in self.joints:
            kind = type(joint).__name__.lower()
            lines.append(
                f"  {joint.name}: {kind} joint, {joint.parent} -> {joint.child}, {' '.join(joint.coordinates)}"
            )
        for loop in self.loops:
            lines.append(f"  {loop.name}: {type(loop).__name__.lower()} loop joint, {loop.body_a} - {loop.body_b}")
        acting = ", ".join(f"{actuator.name} on {actuator.coordinate}" for actuator in self.actuators)
        lines.append(f"  inputs: {acting or 'none'}")
        lines.append(f"  parameters: {', '.join(f'{p.name} = {p.default}' for p in self.parameters) or 'none'}")
        return "\n".join(lines)

    def with_parameters(self, **values: object) -> Mechanism:
        """The same mechanism with other parameter values as defaults.

        Raises:
            UnknownName, ParameterError: as `values`.
        """
        self.values(values)
        changed = tuple(replace(p, default=p.check(values[p.name])) if p.name in values else p for p in self.parameters)
        return replace(self, parameters=changed)

    def values(self, given: Mapping[str, object] | None = None) -> dict[str, float]:
        """Values of all parameters, checked for being physical body by body.

        Raises:
            UnknownName: a given name is no parameter.
            ParameterError: a value is of the wrong kind or sign, or a body gets an impossible inertia.
        """
        values = parameter_values(self.parameters, given or {})
        for place, scalars in self._scalars():
            for scalar in scalars:
                _finite(scalar, values, place)
        for body in self.bodies:
            _check_physical(body, values)
        return values

    def home_values(self, values: Mapping[str, float]) -> dict[str, float]:
        """The home configuration for these parameter values."""
        return {name: float(parse(self.home.get(name, 0), values.__getitem__)) for name in self.coordinates}

    def tree_order(self) -> list[AbstractTreeJoint]:
        """The tree joints ordered so that each parent comes before its children."""
        placed, waiting, order = {GROUND}, list(self.joints), []
        while waiting:
            ready = [joint for joint in waiting if joint.parent in placed]
            if not ready:
                names = ", ".join(joint.child for joint in waiting)
                raise MechanismError(f"bodies not connected to the ground by tree joints: {names}")
            order += ready
            placed.update(joint.child for joint in ready)
            waiting = [joint for joint in waiting if joint not in ready]
        return order

    def _check_names(self) -> None:
        kinds: dict[str, list[str]] = {
            "body": [body.name for body in self.bodies],
            "joint": [joint.name for joint in self.joints] + [loop.name for loop in self.loops],
            "coordinate, parameter or input": [*self.coordinates, *(p.name for p in self.parameters), *self.inputs],
        }
        for kind, names in kinds.items():
            for name, times in Counter(names).items():
                if times > 1:
                    raise MechanismError(f"the {kind} name {name!r} is used {times} times in {self.name!r}")
                if kind != "joint" and (not _NAME.fullmatch(name) or name in _RESERVED):
                    raise MechanismError(f"{name!r} cannot name a {kind}: letters, digits and _, not {_reserved()}")
        for name in self.coordinates:
            for rate in (f"{name}_dot", f"{name}_ddot"):
                if rate in kinds["coordinate, parameter or input"]:
                    raise MechanismError(f"{rate!r} cannot be a name: it stands for a rate of the coordinate {name!r}")
        for joint in self.joints:
            if len(joint.coordinates) != joint.size:
                raise MechanismError(
                    f"joint {joint.name!r} has {joint.size} coordinates, {len(joint.coordinates)} were named"
                )
        for actuator in self.actuators:
            if actuator.coordinate not in self.coordinates:
                raise UnknownName("coordinate", actuator.coordinate, self.coordinates, f"actuator {actuator.name!r}")
        for name in self.home:
            if name not in self.coordinates:
                raise UnknownName("coordinate", name, self.coordinates, "home")

    def _check_tree(self) -> None:
        known = [GROUND, *(body.name for body in self.bodies)]
        sides = [(joint.name, side) for joint in self.joints for side in (joint.parent, joint.child)]
        sides += [(loop.name, side) for loop in self.loops for side in (loop.body_a, loop.body_b)]
        for joint_name, body_name in sides:
            if body_name not in known:
                raise UnknownName("body", body_name, known, f"joint {joint_name!r}")
        if self.end_effector is not None and self.end_effector not in known:
            raise UnknownName("body", self.end_effector, known, "end effector")
        children = Counter(joint.child for joint in self.joints)
        for body in self.bodies:
            if children[body.name] != 1:
                raise MechanismError(
                    f"body {body.name!r} must be the child of exactly one tree joint, not of {children[body.name]}; "
                    "joints that close loops belong in `loops`"
                )
        if GROUND in children:
            raise MechanismError("the ground cannot be the child of a joint")
        self.tree_order()

    def _check_expressions(self) -> None:
        known = {parameter.name for parameter in self.parameters}
        for place, scalars in self._scalars():
            for scalar in scalars:
                check_expression(scalar, known, place)

    def _scalars(self) -> Iterable[tuple[str, Iterable[Any]]]:
        yield "gravity", _three(self.gravity, "gravity")
        yield "home", self.home.values()
        for parameter in self.parameters:
            yield f"the default of {parameter.name}", [parameter.default]
        for body in self.bodies:
            if len(body.inertia) not in (3, 6):
                raise MechanismError(f"body {body.name!r} needs 3 or 6 inertia entries, not {len(body.inertia)}")
            place = f"body {body.name!r}"
            yield place, [body.mass, *_three(body.centre, place), *body.inertia]
        for joint in self.joints:
            place = f"joint {joint.name!r}"
            _check_axis(getattr(joint, "axis", "x"), place)
            yield place, _three(joint.at.position, place)
            yield place, _angles(joint.at, place)
        for loop in self.loops:
            place = f"loop {loop.name!r}"
            yield place, [*_three(loop.point_a, place), *_three(loop.point_b, place)]


def _reserved() -> str:
    return ", ".join(sorted(_RESERVED))


def _three(triple: object, place: str) -> list[Any]:
    if not isinstance(triple, list | tuple) or len(triple) != 3:
        raise MechanismError(f"{place} needs three components along x, y, z, not {triple!r}")
    return list(triple)


def _check_axis(axis: object, place: str) -> None:
    if axis not in AXES:
        raise MechanismError(f"{place} has the axis {axis!r}; choose one of {', '.join(AXES)}")


def _angles(placement: Placement, place: str) -> list[Scalar]:
    """The angles of a placement's rotations."""
    angles: list[Scalar] = []
    for rotation in placement.rotations:
        _check_axis(rotation.axis, f"a rotation of {place}")
        if isinstance(rotation.degrees, str):
            raise MechanismError(f"a rotation of {place} needs a number of degrees; write expressions in radians")
        given = [angle for angle in (rotation.degrees, rotation.radians) if angle is not None]
        if len(given) != 1:
            raise MechanismError(f"a rotation of {place} needs either degrees or radians")
        angles += given
    return angles


def _finite(scalar: Any, values: Mapping[str, float], place: str) -> None:
    try:
        number = float(parse(scalar, values.__getitem__))
    except ExpressionError as error:
        raise ParameterError(f"{place}: {error}") from None
    if not isfinite(number):
        raise ParameterError(f"{place}: {scalar!r} is {number} for these parameters")


def _check_physical(body: Body, values: Mapping[str, float]) -> None:
    """Mass and principal moments of a rigid body: m >= 0, moments >= 0, none above the sum of the others."""
    import numpy as np

    try:
        mass = float(parse(body.mass, values.__getitem__))
        matrix = np.array([[float(parse(e, values.__getitem__)) for e in row] for row in body.inertia_matrix])
    except ExpressionError as error:
        raise ParameterError(f"body {body.name!r}: {error}") from None
    if mass < 0:
        raise ParameterError(f"body {body.name!r} would have the mass {mass:g} kg")
    moments = np.linalg.eigvalsh(matrix)
    slack = _INERTIA_SLACK * float(np.abs(moments).max())
    if moments[0] < -slack or moments[2] > moments[0] + moments[1] + slack:
        shown = ", ".join(f"{moment:.6g}" for moment in moments)
        raise ParameterError(
            f"body {body.name!r} would have the principal moments of inertia {shown} kg m^2: "
            "none may be negative or above the sum of the other two"
        )
