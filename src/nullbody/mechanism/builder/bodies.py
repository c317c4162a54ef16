"""Bodies of ready shapes, and parameters."""

from __future__ import annotations

import re
from abc import ABC
from collections.abc import Sequence
from typing import cast

from nullbody.errors import MechanismError
from nullbody.expr.parse import names_in, parse
from nullbody.mechanism.body import AXES, Axis, Body
from nullbody.mechanism.builder.record import ORIGIN, AbstractRecord
from nullbody.mechanism.builder.text import grouped, scalar, triple
from nullbody.mechanism.joints.base import axis_vector
from nullbody.mechanism.parameter import Parameter, Sign
from nullbody.typing import Scalar, Triple

__all__ = ["AbstractBodyMethods"]

_UNITS = {"", "1", "m", "kg", "s", "rad", "N", "J", "W", "Pa", "Hz", "A", "V", "K"}


class AbstractBodyMethods(AbstractRecord, ABC):
    """The methods that add parameters and bodies. Each returns the name, to be used further on."""

    def parameter(self, name: str, default: Scalar, unit: str = "", meaning: str = "", sign: Sign = "positive") -> str:
        """A named constant that all texts may use.

        Args:
            name: letters, digits and _.
            default: a number, or a text in other parameters.
            unit: SI, such as "m" or "kg m^2".
            meaning: a few words.
            sign: which values are physical.

        Raises:
            MechanismError: the name is taken, or the unit is not SI.
        """
        for part in re.split(r"[ */()^·²³]+|-?\d+", unit):
            if part not in _UNITS:
                raise MechanismError(
                    f"parameter {name!r} has the unit {unit!r}, and {part!r} is no SI unit here: everything is in "
                    "m, kg, s, rad, N, J; convert the value"
                )
        entry = Parameter(name, scalar(default, f"the default of {name}"), unit, meaning, sign)
        return self._note("parameter", self._parameters, name, entry)

    def body(
        self, name: str, mass: Scalar = 0, centre: Sequence[Scalar] = ORIGIN, inertia: Sequence[Scalar] = ORIGIN
    ) -> str:
        """A rigid body.

        Args:
            name: letters, digits and _.
            mass: [kg]
            centre: centre of mass in the body's frame [m].
            inertia: (Ixx, Iyy, Izz) or (Ixx, Iyy, Izz, Ixy, Ixz, Iyz) about the centre of mass, in the body's axes
                [kg m^2]; the last three are entries of the matrix, products of inertia with their sign.
        """
        where = f"body {name!r}"
        if isinstance(inertia, str) or not hasattr(inertia, "__iter__") or len(inertia) not in (3, 6):
            raise MechanismError(f"{where} needs 3 or 6 inertia entries, not {inertia!r}")
        entries = tuple(scalar(entry, where) for entry in inertia)
        return self._add(Body(name, scalar(mass, where), triple(centre, where), entries))

    def rod(self, name: str, mass: Scalar, length: Scalar, axis: Axis = "x", radius: Scalar = 0) -> str:
        """A uniform straight rod from the body's origin along an axis; thin unless a radius is given.

        Args:
            name: letters, digits and _.
            mass: [kg]
            length: [m]
            axis: along which it lies.
            radius: of a round rod [m]. A thin one has no inertia about itself: where nothing holds it against turning
                about itself, give a radius.
        """
        where = f"rod {name!r}"
        half = f"{grouped(_size(length, where))}/2"
        centre = [_value(f"{'-' if sign == -1 else ''}{half}") if sign else 0 for sign in _along(axis, where)]
        return self.cylinder(name, mass, radius, length, axis, centre)

    def disc(self, name: str, mass: Scalar, radius: Scalar, axis: Axis = "z", centre: Sequence[Scalar] = ORIGIN) -> str:
        """A uniform thin disc about the body's origin: m r^2/2 about its axis, m r^2/4 across.

        Args:
            name: letters, digits and _.
            mass: [kg]
            radius: [m]
            axis: its normal.
            centre: in the body's frame [m].
        """
        return self.cylinder(name, mass, radius, 0, axis, centre)

    def cylinder(
        self,
        name: str,
        mass: Scalar,
        radius: Scalar,
        length: Scalar,
        axis: Axis = "z",
        centre: Sequence[Scalar] = ORIGIN,
    ) -> str:
        """A uniform round cylinder about the body's origin: m r^2/2 about its axis, m (3 r^2 + l^2)/12 across.

        Args:
            name: letters, digits and _.
            mass: [kg]
            radius: [m]
            length: [m]
            axis: of the cylinder.
            centre: in the body's frame [m].
        """
        where = f"body {name!r}"
        along = _along(axis, where)
        m = grouped(scalar(mass, where))
        r, l = (grouped(_size(given, where)) for given in (radius, length))  # noqa: E741, a length
        parts = [f"{m}*{r}^2/4" if r != "0" else "", f"{m}*{l}^2/12" if l != "0" else ""]
        across = _value(" + ".join(part for part in parts if part) or "0")
        itself = _value(f"{m}*{r}^2/2") if r != "0" else 0
        return self.body(name, mass, centre, [itself if sign else across for sign in along])

    def box(self, name: str, mass: Scalar, size: Sequence[Scalar], centre: Sequence[Scalar] = ORIGIN) -> str:
        """A uniform box about the body's origin: m (b^2 + c^2)/12 about the edge a, and so on.

        Args:
            name: letters, digits and _.
            mass: [kg]
            size: edges along x, y, z [m].
            centre: in the body's frame [m].
        """
        where = f"box {name!r}"
        m, (a, b, c) = grouped(scalar(mass, where)), (grouped(_size(edge, where)) for edge in triple(size, where))
        pairs = ((b, c), (a, c), (a, b))
        return self.body(name, mass, centre, [_value(f"{m}*({one}^2 + {two}^2)/12") for one, two in pairs])

    def sphere(self, name: str, mass: Scalar, radius: Scalar, centre: Sequence[Scalar] = ORIGIN) -> str:
        """A uniform solid sphere about the body's origin: 2/5 m r^2.

        Args:
            name: letters, digits and _.
            mass: [kg]
            radius: [m]
            centre: in the body's frame [m].
        """
        where = f"sphere {name!r}"
        moment = _value(f"2*{grouped(scalar(mass, where))}*{grouped(_size(radius, where))}^2/5")
        return self.body(name, mass, centre, [moment] * 3)

    def point_mass(self, name: str, mass: Scalar, centre: Sequence[Scalar] = ORIGIN) -> str:
        """A mass without inertia about itself.

        Args:
            name: letters, digits and _.
            mass: [kg]
            centre: where it is in the body's frame [m].
        """
        return self.body(name, mass, centre)

    def add(self, body: Body) -> str:
        """A body that is there already."""
        return self.body(body.name, body.mass, body.centre, body.inertia)

    def _add(self, body: Body) -> str:
        return self._note("body", self._bodies, body.name, body)


def _along(axis: object, where: str) -> Triple:
    if not isinstance(axis, str) or axis not in AXES:
        raise MechanismError(f"{where} has the axis {axis!r}; choose one of {', '.join(AXES)}")
    return axis_vector(cast(Axis, axis))


def _size(given: object, where: str) -> Scalar:
    """A length, not negative where it is a number."""
    value = scalar(given, where)
    if not isinstance(value, str) and value < 0:
        raise MechanismError(f"{where} has a length or radius of {value} m: it must not be negative")
    return value


def _value(text: str) -> Scalar:
    """A number where the text holds no parameter."""
    return text if names_in(text) else float(parse(text, float))
