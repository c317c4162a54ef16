"""One method for each constraint that is no joint."""

from __future__ import annotations

from abc import ABC
from collections.abc import Sequence
from typing import Any

from nullbody.errors import MechanismError
from nullbody.mechanism.builder.direction import Direction, directed, turned_by
from nullbody.mechanism.builder.record import ORIGIN, AbstractRecord, Place
from nullbody.mechanism.builder.text import grouped, place, scalar
from nullbody.mechanism.constraints import (
    AbstractConstraint,
    Coupling,
    Driver,
    Holonomic,
    KnifeEdge,
    Nonholonomic,
    RollingDisc,
)
from nullbody.typing import Scalar

__all__ = ["AbstractConstraintMethods"]


class AbstractConstraintMethods(AbstractRecord, ABC):
    """The methods that add couplings, drivers, rolling contacts and equations of your own.

    A coordinate is named by itself, or by its joint where that has only one. Each returns the constraint's name.
    """

    def gear(
        self, name: str, driven: str, driver: str, teeth: Sequence[int], internal: bool = False, offset: Scalar = 0
    ) -> str:
        """A gear pair: driven = -(z_driver/z_driven) driver + offset, with + for internal teeth.

        Args:
            name: of the constraint.
            driven, driver: angles of both wheels against the body that carries them.
            teeth: of the driven wheel, of the driver.
            internal: whether one wheel has its teeth inside.
            offset: the driven angle where the driver's is zero [rad].
        """
        counts = list(teeth)
        if len(counts) != 2:
            raise MechanismError(f"gear {name!r} needs the numbers of teeth (driven, driver), not {teeth!r}")
        below, above = (grouped(scalar(count, f"gear {name!r}")) for count in counts)
        made = self.coupling(name, driven, driver, f"{'' if internal else '-'}{above}/{below}", offset)
        self._kinds[name] = "gear"
        return made

    def rack(self, name: str, slide: str, pinion: str, radius: Scalar, offset: Scalar = 0) -> str:
        """A rack and pinion: slide = radius pinion + offset.

        Args:
            name: of the constraint.
            slide: displacement of the rack.
            pinion: angle of the pinion.
            radius: of the pitch circle [m]; negative where the rack runs the other way.
            offset: the slide where the angle is zero [m].
        """
        made = self.coupling(name, slide, pinion, radius, offset)
        self._kinds[name] = "rack"
        return made

    def coupling(self, name: str, driven: str, driver: str, ratio: Scalar, offset: Scalar = 0) -> str:
        """driven = ratio driver + offset, for any two coordinates.

        Args:
            name: of the constraint.
            driven, driver: coordinates.
            ratio: unit of driven per unit of driver.
            offset: the driven coordinate where the driver is zero.
        """
        where = f"constraint {name!r}"
        return self._hold(Coupling(name, driven, driver, scalar(ratio, where), scalar(offset, where)))

    def driver(self, name: str, coordinate: str, motion: Scalar) -> str:
        """coordinate = f(t).

        Args:
            name: of the constraint.
            coordinate: which one.
            motion: f, a text in t and parameters [m, rad].
        """
        return self._hold(Driver(name, coordinate, scalar(motion, f"driver {name!r}")))

    def rolling_disc(
        self,
        name: str,
        body: str,
        radius: Scalar,
        on: Place = ORIGIN,
        axis: Direction = "x",
        plane: Place = ORIGIN,
    ) -> str:
        """A thin disc that rolls without slip on a plane of the ground.

        Args:
            name: of the constraint.
            body: the disc.
            radius: [m]
            on: its centre, or a frame there.
            axis: its normal in that frame.
            plane: a frame on the ground; its x and y axes span the plane, z points up.
        """
        where = f"constraint {name!r}"
        letter, turns = directed(axis, where)
        frame, ground = turned_by(place(on, where), turns), place(plane, where)
        return self._hold(RollingDisc(name, body, scalar(radius, where), frame, letter, ground))

    def knife_edge(self, name: str, body: str, on: Place = ORIGIN, axis: Direction = "y") -> str:
        """A blade or wheel at a point of a body that cannot move across itself.

        Args:
            name: of the constraint.
            body: what carries it.
            on: the contact point, or a frame there.
            axis: across the blade in that frame.
        """
        where = f"constraint {name!r}"
        letter, turns = directed(axis, where)
        return self._hold(KnifeEdge(name, body, turned_by(place(on, where), turns), letter))

    def holonomic(self, name: str, residuals: Scalar | Sequence[Scalar]) -> str:
        """residual(q, t) = 0 for each residual.

        Args:
            name: of the constraint.
            residuals: one or several texts, SymPy or SymEngine expressions in coordinates, parameters and t.
        """
        return self._hold(Holonomic(name, _several(residuals, f"constraint {name!r}")))

    def nonholonomic(self, name: str, residuals: Scalar | Sequence[Scalar]) -> str:
        """residual(q, q', t) = 0, linear in the rates, for each residual.

        Args:
            name: of the constraint.
            residuals: one or several texts, SymPy or SymEngine expressions in coordinates, their rates (`x_dot`),
                parameters and t.
        """
        return self._hold(Nonholonomic(name, _several(residuals, f"constraint {name!r}")))

    def _hold(self, constraint: AbstractConstraint) -> str:
        return self._note("constraint", self._constraints, constraint.name, constraint)


def _several(residuals: Any, where: str) -> tuple[Scalar, ...]:
    many = list(residuals) if isinstance(residuals, list | tuple) else [residuals]
    if not many:
        raise MechanismError(f"{where} needs at least one residual")
    return tuple(scalar(residual, where) for residual in many)
