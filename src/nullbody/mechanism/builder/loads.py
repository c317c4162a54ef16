"""One method for each load, and the actuators."""

from __future__ import annotations

from abc import ABC
from collections.abc import Sequence
from typing import Literal

from nullbody.errors import MechanismError
from nullbody.mechanism.builder.record import ORIGIN, AbstractRecord
from nullbody.mechanism.builder.text import scalar, triple
from nullbody.mechanism.loads import AbstractLoad, CoordinateSpring, Energy, Friction, Spring, Wrench
from nullbody.mechanism.mechanism import Actuator
from nullbody.typing import Scalar

__all__ = ["AbstractLoadMethods"]


class AbstractLoadMethods(AbstractRecord, ABC):
    """The methods that add springs, dampers, friction, wrenches, energies and actuators.

    A coordinate is named by itself, or by its joint where that has only one. Each returns the load's name.
    """

    def spring(
        self,
        name: str,
        parent: str,
        child: str,
        stiffness: Scalar,
        length: Scalar = 0,
        damping: Scalar = 0,
        at: Sequence[Scalar] = ORIGIN,
        on: Sequence[Scalar] = ORIGIN,
    ) -> str:
        """A spring and damper between two points: stiffness (L - length) + damping L'.

        Args:
            name: of the load.
            parent, child: the two bodies.
            stiffness: [N/m]
            length: free length [m].
            damping: [N s/m]
            at: point on the parent [m].
            on: point on the child [m].
        """
        where = f"load {name!r}"
        constants = (scalar(stiffness, where), scalar(length, where), scalar(damping, where))
        return self._bear(Spring(name, parent, triple(at, where), child, triple(on, where), *constants))

    def damper(
        self,
        name: str,
        parent: str,
        child: str,
        damping: Scalar,
        at: Sequence[Scalar] = ORIGIN,
        on: Sequence[Scalar] = ORIGIN,
    ) -> str:
        """A damper between two points: damping L'.

        Args:
            name: of the load.
            parent, child: the two bodies.
            damping: [N s/m]
            at: point on the parent [m].
            on: point on the child [m].
        """
        return self.spring(name, parent, child, 0, 0, damping, at, on)

    def coordinate_spring(
        self, name: str, coordinate: str, stiffness: Scalar, rest: Scalar = 0, damping: Scalar = 0
    ) -> str:
        """A spring and damper along one coordinate, rotational for an angle: -stiffness (q - rest) - damping q'.

        Args:
            name: of the load.
            coordinate: which one.
            stiffness: [N/m] or [N m/rad]
            rest: where it is free [m] or [rad].
            damping: [N s/m] or [N m s/rad]
        """
        where = f"load {name!r}"
        constants = (scalar(stiffness, where), scalar(rest, where), scalar(damping, where))
        return self._bear(CoordinateSpring(name, coordinate, *constants))

    def coordinate_damper(self, name: str, coordinate: str, damping: Scalar) -> str:
        """A damper along one coordinate, rotational for an angle: -damping q'.

        Args:
            name: of the load.
            coordinate: which one.
            damping: [N s/m] or [N m s/rad]
        """
        return self.coordinate_spring(name, coordinate, 0, 0, damping)

    def friction(
        self, name: str, coordinate: str, coulomb: Scalar = 0, viscous: Scalar = 0, speed: Scalar = 0.001
    ) -> str:
        """Friction along one coordinate, smooth at rest: -coulomb w / sqrt(w^2 + speed^2) - viscous w, w = q'.

        Args:
            name: of the load.
            coordinate: which one.
            coulomb: [N] or [N m]
            viscous: [N s/m] or [N m s/rad]
            speed: below which it is viscous [m/s] or [rad/s].
        """
        where = f"load {name!r}"
        constants = (scalar(coulomb, where), scalar(viscous, where), scalar(speed, where))
        return self._bear(Friction(name, coordinate, *constants))

    def wrench(
        self,
        name: str,
        body: str,
        force: Sequence[Scalar] = ORIGIN,
        torque: Sequence[Scalar] = ORIGIN,
        point: Sequence[Scalar] = ORIGIN,
        axes: Literal["ground", "body"] = "ground",
    ) -> str:
        """An external force at a point of a body and a torque on it.

        Args:
            name: of the load.
            body: on which it acts.
            force: [N], texts in parameters, coordinates, rates and t.
            torque: [N m], likewise.
            point: where the force acts, in the body's frame [m].
            axes: whether components are along the ground's axes or the body's.
        """
        where = f"load {name!r}"
        if axes not in ("ground", "body"):
            raise MechanismError(f"{where} has the axes {axes!r}; choose 'ground' or 'body'")
        return self._bear(Wrench(name, body, triple(point, where), triple(force, where), triple(torque, where), axes))

    def energy(self, name: str, potential: Scalar = 0, kinetic: Scalar = 0) -> str:
        """Energies of your own, as texts, SymPy or SymEngine expressions.

        Args:
            name: of the load.
            potential: U(q) [J], in coordinates and parameters.
            kinetic: T(q, q') beside that of the bodies [J], quadratic in the rates.
        """
        where = f"load {name!r}"
        return self._bear(Energy(name, scalar(potential, where), scalar(kinetic, where)))

    def actuator(self, name: str, coordinate: str, limits: Sequence[Scalar] | None = None) -> str:
        """An input: a force [N] or torque [N m] along one coordinate.

        Args:
            name: of the input.
            coordinate: along which it acts.
            limits: least and largest value; None is without limits.
        """
        where = f"actuator {name!r}"
        if limits is not None and (isinstance(limits, str) or len(limits) != 2):
            raise MechanismError(f"{where} needs two limits, the least and the largest value, not {limits!r}")
        pair = None if limits is None else (scalar(limits[0], where), scalar(limits[1], where))
        return self._note("actuator", self._actuators, name, Actuator(name, coordinate, pair))

    def _bear(self, load: AbstractLoad) -> str:
        return self._note("load", self._loads, load.name, load)
