"""Mechanism: bodies, joints, loops, constraints, loads, actuators and parameters as plain frozen data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from nullbody.errors import MechanismError
from nullbody.expr.parse import names_in, parse
from nullbody.mechanism.body import GROUND, Body
from nullbody.mechanism.check import check_mechanism, check_values
from nullbody.mechanism.constraints.base import AbstractConstraint
from nullbody.mechanism.joints.base import AbstractLoopJoint, AbstractTreeJoint
from nullbody.mechanism.loads.base import AbstractLoad
from nullbody.mechanism.parameter import Parameter, parameter_values
from nullbody.typing import Scalar, Triple

__all__ = ["Actuator", "Mechanism"]


@dataclass(frozen=True)
class Actuator:
    """A force [N] or torque [N m] that acts along one coordinate, conjugate to it.

    Attributes:
        name: of the input.
        coordinate: along which it acts.
        limits: least and largest value; a simulation holds the input within them. None is without limits.
    """

    name: str
    coordinate: str
    limits: tuple[Scalar, Scalar] | None = None


@dataclass(frozen=True)
class Mechanism:
    """A mechanism of rigid bodies with loops; nothing in it depends on q.

    Attributes:
        name: what it is called in reports and generated code.
        bodies: all but the ground.
        joints: the spanning tree, one joint for each body; their order is the order of the coordinates.
        loops: the joints that close loops.
        constraints: couplings, drivers, rolling contacts, equations of your own.
        loads: springs, dampers, friction, external wrenches, energies of your own.
        actuators: the inputs u.
        parameters: symbols that lengths, masses and so on are written in.
        gravity: acceleration of gravity in the ground frame [m/s^2].
        home: coordinates of a configuration in which the loops close for every parameter set, or nearly;
            missing ones are those at which their joint's frames coincide: 0, and 1 for e0 of Euler parameters.
        end_effector: the body whose coordinates are the task.

    Raises:
        MechanismError, UnknownName, ExpressionError: what it is made of makes no sense; the message says what.
    """

    name: str
    bodies: tuple[Body, ...]
    joints: tuple[AbstractTreeJoint, ...]
    loops: tuple[AbstractLoopJoint, ...] = ()
    constraints: tuple[AbstractConstraint, ...] = ()
    loads: tuple[AbstractLoad, ...] = ()
    actuators: tuple[Actuator, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    gravity: Triple = (0, 0, 0)
    home: Mapping[str, Scalar] = field(default_factory=dict)
    end_effector: str | None = None

    def __post_init__(self) -> None:
        check_mechanism(self)

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

    @property
    def rheonomic(self) -> bool:
        """Whether the time itself enters: by a driver, a load or an equation of your own."""
        parts: tuple[AbstractConstraint | AbstractLoad, ...] = (*self.constraints, *self.loads)
        return any("t" in names_in(text) for part in parts for text in part.expressions)

    @property
    def holonomic_rows(self) -> tuple[tuple[str, str], ...]:
        """(label, unit) of every equation Phi(q, t) = 0: loops, constraints, then Euler parameters."""
        return tuple(self._holonomic_rows())

    def _holonomic_rows(self) -> Iterator[tuple[str, str]]:
        units = self.units
        for loop in self.loops:
            yield from ((f"{loop.name} {row}", unit) for row, unit in zip(loop.rows, loop.row_units, strict=True))
        for constraint in self.constraints:
            yield from ((f"{constraint.name} {row}", unit) for row, unit in constraint.holonomic_rows(units))
        for joint in self.joints:
            yield from ((f"{joint.name} {row}", "") for row in joint.own_rows)

    @property
    def nonholonomic_rows(self) -> tuple[tuple[str, str], ...]:
        """(label, unit) of every equation in rates that no equation in q stands behind."""
        return tuple((f"{c.name} {row}", unit) for c in self.constraints for row, unit in c.nonholonomic_rows)

    def __str__(self) -> str:
        """A summary for the terminal."""
        lines = [f"Mechanism {self.name!r}: {len(self.bodies)} bodies, {len(self.coordinates)} coordinates"]
        for joint in self.joints:
            kind = type(joint).__name__.lower()
            lines.append(
                f"  {joint.name}: {kind} joint, {joint.parent} -> {joint.child}, {' '.join(joint.coordinates)}"
            )
        for loop in self.loops:
            lines.append(f"  {loop.name}: {type(loop).__name__.lower()} loop joint, {loop.parent} - {loop.child}")
        parts: tuple[AbstractConstraint | AbstractLoad, ...] = (*self.constraints, *self.loads)
        for part in parts:
            lines.append(f"  {part.name}: {type(part).__name__.lower()}")
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
        check_values(self, values)
        return values

    def home_values(self, values: Mapping[str, float]) -> dict[str, float]:
        """The home configuration for these parameter values."""
        zero = {name: at for joint in self.joints for name, at in zip(joint.coordinates, joint.zero, strict=True)}
        return {name: float(parse(self.home.get(name, zero[name]), values.__getitem__)) for name in self.coordinates}

    def limits(self, values: Mapping[str, float]) -> tuple[tuple[float, float], ...]:
        """Least and largest value of each input for these parameter values; infinite where there is none."""
        whole = (float("-inf"), float("inf"))
        return tuple(
            whole
            if a.limits is None
            else (float(parse(a.limits[0], values.__getitem__)), float(parse(a.limits[1], values.__getitem__)))
            for a in self.actuators
        )

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
