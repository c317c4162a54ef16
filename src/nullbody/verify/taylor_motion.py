"""The mechanism in motion as numbers with derivatives: what its constraints and loads ask for (`Kinematics`).

Directions: a unit change of each coordinate, of each rate, and the motion (q', 0, 1) in (q, q', t). A position p(q) has

    dp/dq_j = J_j,   dp/dq'_j = 0,   p' = J q',   d^2p/dq_j dm = J_j'

and from these its velocity v = J q' is a number with derivatives too:

    dv/dq_j = J_j' (q' constant),   dv/dq'_j = J_j,   v' = p'' for q'' = 0,   d^2v/dq'_j dm = J_j'

Third derivatives of p, which d^2v/dq_j dm and v'' would be, are not known: they are NaN, so that nothing uses them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from nullbody.expr.parse import parse
from nullbody.formats import frame, number
from nullbody.mechanism import GROUND, Mechanism, Placement, Pose
from nullbody.typing import FloatArray, Scalar, Triple
from nullbody.verify.taylor import FUNCTIONS, Moving, Taylor, root

__all__ = ["BodyMotion", "TaylorMotion", "Variables"]


@dataclass(frozen=True, eq=False)
class BodyMotion:
    """Rotation matrix and position of a body's frame in the ground frame."""

    rotation: Moving
    position: Moving

    def frame(self, rotation: FloatArray, position: FloatArray) -> BodyMotion:
        """A frame that is fixed on the body."""
        return BodyMotion(self.rotation @ rotation, self.position + self.rotation @ position)


@dataclass(frozen=True, eq=False)
class Variables:
    """q, q' and t as numbers with derivatives.

    Attributes:
        q, rates: coordinates and rates by name.
        time: t.
    """

    q: Mapping[str, Taylor]
    rates: Mapping[str, Taylor]
    time: Taylor

    @staticmethod
    def at(names: Sequence[str], q: FloatArray, q_dot: FloatArray, t: float) -> Variables:
        """The variables of a state."""
        size = len(names)
        first = np.zeros((2 * size + 1, 2 * size + 1))
        first[: 2 * size, : 2 * size] = np.eye(2 * size)
        first[:size, -1] = q_dot
        first[-1, -1] = 1
        none = np.zeros(2 * size + 1)
        numbers = [Taylor(x, slope, none) for x, slope in zip([*q, *q_dot, t], first, strict=True)]
        coordinates = dict(zip(names, numbers[:size], strict=True))
        return Variables(coordinates, dict(zip(names, numbers[size:-1], strict=True)), numbers[-1])

    @property
    def directions(self) -> int:
        """How many derivatives every number carries: two for each coordinate, and the motion."""
        return 2 * len(self.q) + 1


class TaylorMotion:
    """A mechanism in motion from the poses of its bodies; fulfils `nullbody.mechanism.Kinematics`.

    Args:
        mechanism: whose parts ask.
        values: of all parameters.
        variables: q, q', t.
        bodies: motions of all bodies that are asked for, but the ground.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        values: Mapping[str, float],
        variables: Variables,
        bodies: Mapping[str, BodyMotion],
    ) -> None:
        self.mechanism, self.variables = mechanism, variables
        self._values, self._bodies = values, bodies
        rates = {f"{name}_dot": rate for name, rate in variables.rates.items()}
        self._names = {**values, **variables.q, **rates, "t": variables.time}

    def scalar(self, source: Scalar) -> float:
        """The value of a text in parameters."""
        return number(source, self._values)

    def triple(self, source: Triple) -> list[float]:
        """The values of three components."""
        return [self.scalar(component) for component in source]

    def expression(self, source: Scalar) -> Any:
        """A text in parameters, coordinates, rates and t."""
        return parse(source, self._names.__getitem__, functions=FUNCTIONS)

    def coordinate(self, name: str) -> Taylor:
        """A coordinate."""
        return self.variables.q[name]

    def rate(self, name: str) -> Taylor:
        """Its rate."""
        return self.variables.rates[name]

    def sqrt(self, value: Any) -> Any:
        """The square root."""
        return root(value)

    def frame(self, body: str, place: Placement) -> Pose:
        """R = R_body R_place, p = p_body + R_body p_place."""
        fixed = frame(place, self._values)
        if body == GROUND:
            return Pose(fixed.rotation.tolist(), fixed.position.tolist())
        moving = self._bodies[body].frame(fixed.rotation, fixed.position)
        return Pose(moving.rotation.entries(), moving.position.entries())

    def velocity(self, body: str, local: Sequence[Any]) -> list[Any]:
        """p' + R' local; the local coordinates are those of a point of the body, so their own change does not count."""
        if body == GROUND:
            return [0.0, 0.0, 0.0]
        moving = self._bodies[body]
        turning = self._rate(moving.rotation).entries()
        origin = self._rate(moving.position).entries()
        return [
            p + row[0] * local[0] + row[1] * local[1] + row[2] * local[2]
            for p, row in zip(origin, turning, strict=True)
        ]

    def spin(self, body: str) -> list[Any]:
        """omega with [omega x] = R' R^T."""
        if body == GROUND:
            return [0.0, 0.0, 0.0]
        R, rate = self._bodies[body].rotation.entries(), self._rate(self._bodies[body].rotation).entries()

        def entry(i: int, j: int) -> Any:
            return rate[i][0] * R[j][0] + rate[i][1] * R[j][1] + rate[i][2] * R[j][2]

        return [(entry(k, j) - entry(j, k)) * 0.5 for j, k in ((1, 2), (2, 0), (0, 1))]

    def with_rates(self, q_dot: FloatArray) -> TaylorMotion:
        """The same pose with other rates; second derivatives are not known."""
        names = self.mechanism.coordinates
        q = np.array([x.value for x in self.variables.q.values()])
        variables = Variables.at(names, q, q_dot, self.variables.time.value)
        bodies = {
            name: BodyMotion(_along(moving.rotation, q_dot), _along(moving.position, q_dot))
            for name, moving in self._bodies.items()
        }
        return TaylorMotion(self.mechanism, self._values, variables, bodies)

    def _rate(self, position: Moving) -> Moving:
        """The velocity that belongs to a position."""
        size = len(self.variables.q)
        first, second = np.zeros_like(position.first), np.full_like(position.second, np.nan)
        first[:size], first[size : 2 * size], first[-1] = (
            position.second[:size],
            position.first[:size],
            position.second[-1],
        )
        second[size : 2 * size] = position.second[:size]
        return Moving(position.first[-1], first, second)


def _along(position: Moving, q_dot: FloatArray) -> Moving:
    """A position with p' = J q' for other rates."""
    first = position.first.copy()
    first[-1] = np.tensordot(q_dot, first[: len(q_dot)], 1)
    return Moving(position.value, first, np.full_like(position.second, np.nan))
