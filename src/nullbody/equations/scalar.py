"""Parameter expressions of a mechanism as expressions of a graph."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from math import cos as cos_float
from math import radians
from math import sin as sin_float
from typing import Any

from nullbody.errors import UnknownName
from nullbody.expr import Exact, Expr, Graph, cos, sin, sqrt
from nullbody.expr.matrix import matmul
from nullbody.expr.parse import parse
from nullbody.mechanism import Placement, Rotation
from nullbody.mechanism.joints.base import elementary_rotation
from nullbody.typing import Scalar, Triple

__all__ = ["ParameterScalars"]

# sin of 0, 15, 30, 45, 60, 75, 90 degrees as (sum of square roots, common divisor)
_SINES = {
    0: ((), 1),
    15: ((6, -2), 4),
    30: ((1,), 2),
    45: ((2,), 2),
    60: ((3,), 2),
    75: ((6, 2), 4),
    90: ((1,), 1),
}


class ParameterScalars:
    """Turns texts such as "M*b^2/4" into expressions of one graph, parameters into its symbols."""

    def __init__(self, graph: Graph, parameters: tuple[str, ...]) -> None:
        self.graph = graph
        self.parameters = parameters

    def __call__(self, source: Scalar) -> Expr:
        """The expression of a scalar."""
        return self._parsed(source, self._symbol)

    def moving(self, source: Scalar, symbols: Mapping[str, Expr]) -> Expr:
        """The expression of a text that uses other symbols beside the parameters: coordinates, rates, t."""
        return self._parsed(source, lambda name: symbols[name] if name in symbols else self._symbol(name))

    def _parsed(self, source: Scalar, symbol: Callable[[str], Expr]) -> Expr:
        functions = {"sin": sin, "cos": cos, "sqrt": sqrt, "tan": lambda x: sin(x) / cos(x)}
        found: Expr = parse(source, symbol, self.graph.constant, functions)
        return found

    def rotation(self, placement: Placement) -> list[list[Any]]:
        """The rotation matrix of a placement."""
        rotation: list[list[Any]] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
        for fixed in placement.rotations:
            rotation = matmul(rotation, elementary_rotation(fixed.axis, *self.sine_cosine(fixed)))
        return rotation

    def triple(self, source: Triple) -> list[Expr]:
        """The expressions of three components."""
        return [self(component) for component in source]

    def sine_cosine(self, rotation: Rotation) -> tuple[Any, Any]:
        """(sin, cos) of a fixed rotation; exact for multiples of 15 degrees."""
        if rotation.radians is not None:
            angle = self(rotation.radians)
            return sin(angle), cos(angle)
        degrees = Fraction(str(rotation.degrees))
        return self.graph.constant(_sine(degrees)), self.graph.constant(_sine(degrees + 90))

    def _symbol(self, name: str) -> Expr:
        if name not in self.parameters:
            raise UnknownName("parameter", name, self.parameters)
        return self.graph.symbol(name)


def _sine(degrees: Fraction) -> Exact:
    """sin of an angle in degrees: exact for multiples of 15, else the double nearest to it."""
    angle = degrees % 360
    sign = -1 if angle >= 180 else 1
    angle = angle % 180
    angle = min(angle, 180 - angle)
    if angle not in _SINES:
        return Exact.of(sign * sin_float(radians(angle)) if angle <= 45 else sign * cos_float(radians(90 - angle)))
    radicands, divisor = _SINES[int(angle)]
    result = Exact.of(0)
    for radicand in radicands:
        root = Exact.square_root(abs(radicand))
        result = result + root if radicand > 0 else result - root
    return result * Exact.of(Fraction(sign, divisor))
