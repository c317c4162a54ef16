"""A force and a torque on a body, and generalized forces and energies given as expressions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from nullbody.expr.matrix import matvec
from nullbody.mechanism.body import GROUND, Placement
from nullbody.mechanism.kinematics import Kinematics
from nullbody.mechanism.loads.base import AbstractLoad
from nullbody.typing import Scalar, Triple

__all__ = ["Energy", "Wrench"]


@dataclass(frozen=True)
class Wrench(AbstractLoad):
    """An external force at a point of a body and a torque on it.

    Attributes:
        body: on which it acts.
        point: where, in the body's frame [m].
        force: [N], texts in parameters, coordinates, rates and t.
        torque: [N m], likewise.
        axes: whether the components are along the ground's axes or the body's.
    """

    body: str = GROUND
    point: Triple = (0, 0, 0)
    force: Triple = (0, 0, 0)
    torque: Triple = (0, 0, 0)
    axes: Literal["ground", "body"] = "ground"

    @property
    def bodies(self) -> tuple[str, ...]:
        """The body."""
        return (self.body,)

    @property
    def scalars(self) -> tuple[Scalar, ...]:
        """The point."""
        return tuple(self.point)

    @property
    def expressions(self) -> tuple[Scalar, ...]:
        """Force and torque."""
        return (*self.force, *self.torque)

    def efforts(self, motion: Kinematics) -> Sequence[tuple[Any, Any]]:
        """(F_x, v_x), ..., (T_x, omega_x), ..., those that are not identically zero."""
        force = [motion.expression(component) for component in self.force]
        torque = [motion.expression(component) for component in self.torque]
        if self.axes == "body":
            rotation = motion.frame(self.body, Placement()).rotation
            force, torque = matvec(rotation, force), matvec(rotation, torque)
        flows = [*motion.velocity(self.body, motion.triple(self.point)), *motion.spin(self.body)]
        return [(effort, flow) for effort, flow in zip([*force, *torque], flows, strict=True) if effort != 0]


@dataclass(frozen=True)
class Energy(AbstractLoad):
    """Energies of your own: a potential U(q), and a kinetic energy T(q, q') beside that of the bodies [J].

    Attributes:
        potential_energy: a text in coordinates and parameters.
        kinetic_energy: a text in coordinates, rates and parameters, quadratic in the rates.
    """

    potential_energy: Scalar = 0
    kinetic_energy: Scalar = 0

    @property
    def expressions(self) -> tuple[Scalar, ...]:
        """Both."""
        return (self.potential_energy, self.kinetic_energy)

    def potential(self, motion: Kinematics) -> Any:
        """U(q)"""
        return motion.expression(self.potential_energy)

    def kinetic(self, motion: Kinematics) -> Any:
        """T(q, q')"""
        return motion.expression(self.kinetic_energy)
