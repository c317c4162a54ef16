"""The mechanism in motion as expressions of a graph: what constraints and loads ask for (`Kinematics`)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from nullbody.equations.frame import Frame, frames
from nullbody.equations.scalar import ParameterScalars
from nullbody.expr import Expr, Graph, sqrt
from nullbody.expr.matrix import add, cross, matmul, matvec, scale
from nullbody.mechanism import Mechanism, Placement, Pose
from nullbody.typing import Scalar

__all__ = ["MotionExpressions"]


class MotionExpressions:
    """Poses and velocities from the frames of all bodies; fulfils `nullbody.mechanism.Kinematics`.

    Args:
        found: frames of all bodies and the ground.
        scalars: turns texts into expressions.
        q, rates: symbols of coordinates and rates by name.
        time: the symbol t.
    """

    def __init__(
        self,
        found: Mapping[str, Frame],
        scalars: ParameterScalars,
        q: Mapping[str, Expr],
        rates: Mapping[str, Expr],
        time: Expr,
    ) -> None:
        self.scalar, self.triple = scalars, scalars.triple
        self.q, self.rates, self.time = q, rates, time
        self.frames, self._scalars = found, scalars
        self._symbols = {**q, **{f"{name}_dot": rate for name, rate in rates.items()}, "t": time}

    @classmethod
    def of(cls, mechanism: Mechanism, graph: Graph) -> MotionExpressions:
        """The motion of a mechanism, written in a graph."""
        scalars = ParameterScalars(graph, tuple(p.name for p in mechanism.parameters))
        q = {name: graph.symbol(name) for name in mechanism.coordinates}
        rates = {name: graph.symbol(f"{name}_dot") for name in mechanism.coordinates}
        return cls(frames(mechanism, scalars, q), scalars, q, rates, graph.symbol("t"))

    def expression(self, source: Scalar) -> Expr:
        """A text in parameters, coordinates, rates and t."""
        return self._scalars.moving(source, self._symbols)

    def coordinate(self, name: str) -> Expr:
        """A coordinate."""
        return self.q[name]

    def rate(self, name: str) -> Expr:
        """Its rate."""
        return self.rates[name]

    def frame(self, body: str, place: Placement) -> Pose:
        """R = R_body R_place, p = p_body + R_body p_place."""
        frame = self.frames[body]
        rotation = matmul(frame.pose.rotation, self._scalars.rotation(place))
        return Pose(rotation, frame.point(self.triple(place.position)))

    def velocity(self, body: str, local: Sequence[Any]) -> list[Any]:
        """R (V + omega x local)"""
        frame = self.frames[body]
        columns = [(name, add(V, cross(W, local))) for name, (W, V) in frame.columns.items()]
        return matvec(frame.pose.rotation, self._sum(columns))

    def spin(self, body: str) -> list[Any]:
        """R omega"""
        frame = self.frames[body]
        return matvec(frame.pose.rotation, self._sum([(name, W) for name, (W, _) in frame.columns.items()]))

    def sqrt(self, value: Any) -> Any:
        """The square root of an expression."""
        return sqrt(self._scalars(0) + value)

    def _sum(self, columns: Sequence[tuple[str, Sequence[Any]]]) -> list[Any]:
        total: list[Any] = [0, 0, 0]
        for name, column in columns:
            total = add(total, scale(self.rates[name], column))
        return total
