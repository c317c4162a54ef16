"""Whether a mechanism makes sense: names, the spanning tree, expressions, and values that are physical."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from math import isfinite
from typing import TYPE_CHECKING, Any

from nullbody.errors import ExpressionError, MechanismError, ParameterError, UnknownName
from nullbody.expr.parse import parse
from nullbody.mechanism.body import AXES, GROUND, Body, Placement
from nullbody.mechanism.constraints.base import AbstractConstraint
from nullbody.mechanism.joints.base import AbstractJoint, AbstractLoopJoint, AbstractTreeJoint
from nullbody.mechanism.loads.base import AbstractLoad
from nullbody.mechanism.parameter import check_expression
from nullbody.typing import Scalar

if TYPE_CHECKING:
    from nullbody.mechanism.mechanism import Mechanism

__all__ = ["INERTIA_SLACK", "check_mechanism", "check_values"]

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_RESERVED = {"pi", "sqrt", "sin", "cos", "tan", "t", GROUND}
INERTIA_SLACK = 1e-9  # relative; a disc or a rod meets the triangle inequality with equality, up to rounding


def check_mechanism(mechanism: Mechanism) -> None:
    """Raise unless the mechanism makes sense.

    Raises:
        MechanismError, UnknownName, ExpressionError: what does not, and where.
    """
    _check_roles(mechanism)
    _check_names(mechanism)
    _check_references(mechanism)
    _check_tree(mechanism)
    _check_expressions(mechanism)


def check_values(mechanism: Mechanism, values: Mapping[str, float]) -> None:
    """Raise unless all scalars are finite and everything is physical for these parameter values.

    Raises:
        ParameterError: what is not, and where.
    """
    for place, scalars in _scalars(mechanism):
        for scalar in scalars:
            _number(scalar, values, place)
    for body in mechanism.bodies:
        _check_physical(body, values)
    parts: tuple[AbstractLoopJoint | AbstractConstraint | AbstractLoad, ...] = (*mechanism.loops, *_others(mechanism))
    for part in parts:
        for what, scalar, sign in part.signs:
            number = _number(scalar, values, f"{part.name!r}")
            if number < 0 or (sign == "positive" and number == 0):
                raise ParameterError(f"{what} of {part.name!r} must be {sign}, not {number:g}")
    for actuator, (low, high) in zip(mechanism.actuators, mechanism.limits(values), strict=True):
        if low > high:
            raise ParameterError(f"the limits of actuator {actuator.name!r} are in the wrong order: {low:g} > {high:g}")


def _others(mechanism: Mechanism) -> tuple[AbstractConstraint | AbstractLoad, ...]:
    """Constraints and loads."""
    return (*mechanism.constraints, *mechanism.loads)


def _named(mechanism: Mechanism) -> tuple[AbstractJoint | AbstractConstraint, ...]:
    """Joints, loops and constraints, which share their names."""
    return (*mechanism.joints, *mechanism.loops, *mechanism.constraints)


def _check_roles(mechanism: Mechanism) -> None:
    for joint in mechanism.joints:
        if not isinstance(joint, AbstractTreeJoint):
            raise MechanismError(
                f"joint {getattr(joint, 'name', joint)!r} is a {type(joint).__name__}: it gives no body its pose and "
                "can only close a loop; it belongs in `loops`"
            )
        if len(joint.coordinates) != len(joint.units):
            raise MechanismError(
                f"joint {joint.name!r} has {len(joint.units)} coordinates, {len(joint.coordinates)} were named"
            )
    for loop in mechanism.loops:
        if not isinstance(loop, AbstractLoopJoint):
            raise MechanismError(f"joint {getattr(loop, 'name', loop)!r} is a {type(loop).__name__}: it closes no loop")
        if loop.coordinates:
            raise MechanismError(f"loop joint {loop.name!r} has no coordinates of its own: leave them out")


def _check_names(mechanism: Mechanism) -> None:
    parts = _named(mechanism)
    symbols = [*mechanism.coordinates, *(p.name for p in mechanism.parameters), *mechanism.inputs]
    kinds: dict[str, list[str]] = {
        "body": [body.name for body in mechanism.bodies],
        "joint or constraint": [part.name for part in parts],
        "load": [load.name for load in mechanism.loads],
        "coordinate, parameter or input": symbols,
    }
    for kind, names in kinds.items():
        for name, times in Counter(names).items():
            if times > 1:
                raise MechanismError(f"the {kind} name {name!r} is used {times} times in {mechanism.name!r}")
            free = kind in ("joint or constraint", "load")
            if not free and (not _NAME.fullmatch(name) or name in _RESERVED):
                reserved = ", ".join(sorted(_RESERVED))
                raise MechanismError(f"{name!r} cannot name a {kind}: letters, digits and _, not {reserved}")
    for name in mechanism.coordinates:
        for rate in (f"{name}_dot", f"{name}_ddot"):
            if rate in symbols:
                raise MechanismError(f"{rate!r} cannot be a name: it stands for a rate of the coordinate {name!r}")


def _check_references(mechanism: Mechanism) -> None:
    known = [GROUND, *(body.name for body in mechanism.bodies)]
    named: list[tuple[str, str]] = [
        (f"joint {joint.name!r}", side)
        for joint in (*mechanism.joints, *mechanism.loops)
        for side in (joint.parent, joint.child)
    ]
    named += [(repr(p.name), body) for p in _others(mechanism) for body in p.bodies]
    if mechanism.end_effector is not None:
        named.append(("end effector", mechanism.end_effector))
    for place, body in named:
        if body not in known:
            raise UnknownName("body", body, known, place)
    uses = [(f"actuator {actuator.name!r}", actuator.coordinate) for actuator in mechanism.actuators]
    uses += [("home", name) for name in mechanism.home]
    uses += [(repr(p.name), name) for p in _others(mechanism) for name in p.coordinates]
    for place, name in uses:
        if name not in mechanism.coordinates:
            raise UnknownName("coordinate", name, mechanism.coordinates, place)


def _check_tree(mechanism: Mechanism) -> None:
    children = Counter(joint.child for joint in mechanism.joints)
    for body in mechanism.bodies:
        if children[body.name] != 1:
            raise MechanismError(
                f"body {body.name!r} must be the child of exactly one tree joint, not of {children[body.name]}; "
                "joints that close loops belong in `loops`"
            )
    if GROUND in children:
        raise MechanismError("the ground cannot be the child of a joint")
    for loop in mechanism.loops:
        if loop.parent == loop.child:
            raise MechanismError(f"loop joint {loop.name!r} joins body {loop.parent!r} with itself")
    mechanism.tree_order()


def _check_expressions(mechanism: Mechanism) -> None:
    known = {parameter.name for parameter in mechanism.parameters}
    for place, scalars in _scalars(mechanism):
        for scalar in scalars:
            check_expression(scalar, known, place)
    moving = known | {"t"} | set(mechanism.coordinates) | {f"{name}_dot" for name in mechanism.coordinates}
    for part in _others(mechanism):
        for text in part.expressions:
            check_expression(text, moving, repr(part.name))


def _scalars(mechanism: Mechanism) -> Iterator[tuple[str, list[Any]]]:
    """Everything that is a number or a text in parameters, with the place where it stands."""
    yield "gravity", _three(mechanism.gravity, "gravity")
    yield "home", list(mechanism.home.values())
    for parameter in mechanism.parameters:
        yield f"the default of {parameter.name}", [parameter.default]
    for actuator in mechanism.actuators:
        yield f"the limits of actuator {actuator.name!r}", list(actuator.limits or ())
    for body in mechanism.bodies:
        place = f"body {body.name!r}"
        inertia: object = body.inertia
        if not isinstance(inertia, list | tuple) or len(inertia) not in (3, 6):
            raise MechanismError(f"{place} needs 3 or 6 inertia entries, not {body.inertia!r}")
        yield place, [body.mass, *_three(body.centre, place), *body.inertia]
    joints: tuple[AbstractJoint, ...] = (*mechanism.joints, *mechanism.loops)
    for joint in joints:
        place = f"{'joint' if joint.coordinates else 'loop'} {joint.name!r}"
        for axis in (getattr(joint, "axis", "x"), getattr(joint, "axis2", "x")):
            _check_axis(axis, place)
        if getattr(joint, "axis", "x")[-1] == getattr(joint, "axis2", "-")[-1]:
            raise MechanismError(f"{place} needs two different axes, not {joint.axis!r} twice")  # type: ignore[attr-defined]
        yield from _placed(joint.at, place)
        yield from _placed(joint.on, place)
        yield place, [getattr(joint, "length", 1)]
    for part in _others(mechanism):
        _check_axis(getattr(part, "axis", "x"), repr(part.name))
        yield repr(part.name), list(part.scalars)
        for placement in part.placements:
            yield from _placed(placement, repr(part.name))


def _placed(placement: Placement, place: str) -> Iterator[tuple[str, list[Any]]]:
    """The scalars of a placement."""
    if not isinstance(placement, Placement):
        raise MechanismError(f"{place} needs a Placement, not {placement!r}")
    yield place, _three(placement.position, place)
    angles: list[Scalar] = []
    for rotation in placement.rotations:
        _check_axis(rotation.axis, f"a rotation of {place}")
        if isinstance(rotation.degrees, str):
            raise MechanismError(f"a rotation of {place} needs a number of degrees; write expressions in radians")
        given = [angle for angle in (rotation.degrees, rotation.radians) if angle is not None]
        if len(given) != 1:
            raise MechanismError(f"a rotation of {place} needs either degrees or radians")
        angles += given
    yield place, angles


def _three(triple: object, place: str) -> list[Any]:
    if not isinstance(triple, list | tuple) or len(triple) != 3:
        raise MechanismError(f"{place} needs three components along x, y, z, not {triple!r}")
    return list(triple)


def _check_axis(axis: object, place: str) -> None:
    if axis not in AXES:
        raise MechanismError(f"{place} has the axis {axis!r}; choose one of {', '.join(AXES)}")


def _number(scalar: Any, values: Mapping[str, float], place: str) -> float:
    try:
        number = float(parse(scalar, values.__getitem__))
    except ExpressionError as error:
        raise ParameterError(f"{place}: {error}") from None
    if not isfinite(number):
        raise ParameterError(f"{place}: {scalar!r} is {number} for these parameters")
    return number


def _check_physical(body: Body, values: Mapping[str, float]) -> None:
    """Mass and principal moments of a rigid body: m >= 0, moments >= 0, none above the sum of the others."""
    import numpy as np

    place = f"body {body.name!r}"
    mass = _number(body.mass, values, place)
    matrix = np.array([[_number(e, values, place) for e in row] for row in body.inertia_matrix])
    if mass < 0:
        raise ParameterError(f"body {body.name!r} would have the mass {mass:g} kg")
    moments = np.linalg.eigvalsh(matrix)
    slack = INERTIA_SLACK * float(np.abs(moments).max())
    if moments[0] < -slack or moments[2] > moments[0] + moments[1] + slack:
        shown = ", ".join(f"{moment:.6g}" for moment in moments)
        raise ParameterError(
            f"body {body.name!r} would have the principal moments of inertia {shown} kg m^2: "
            "none may be negative or above the sum of the other two"
        )
