"""Values of the nodes of a graph at one random point of a prime field."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from nullbody.expr.field import Field

if TYPE_CHECKING:
    from nullbody.expr.graph import Graph

__all__ = ["Witness"]

_ONE = 1  # the node of the constant 1

#: The finest fraction of an angle that is followed by the addition theorems together with the angle itself: halves,
#: thirds, quarters, sixths and twelfths. Other fractions of an angle are followed among themselves.
_FINEST = 12


class Witness:
    """The values of a graph's nodes at one point: the evidence on which nodes are merged.

    sin and cos of sums and rational multiples follow the addition theorems; the square root of anything but a
    constant is an independent random number (its sign in F_p would be arbitrary, and sqrt(x^2) is not x).
    """

    def __init__(self, graph: Graph, field: Field) -> None:
        self.graph = graph
        self.field = field
        self.values: list[int] = []
        self._circles: dict[tuple[int, Fraction], tuple[int, int]] = {}

    def copy(self, graph: Graph) -> Witness:
        """The same values, for a copy of the graph."""
        twin = Witness(graph, self.field)
        twin.values, twin._circles = self.values.copy(), self._circles.copy()
        return twin

    def of_ref(self, ref: int) -> int:
        """Value of a signed reference."""
        value = self.values[ref >> 1]
        return self.field.prime - value if ref & 1 and value else value

    def of_operation(self, key: tuple[str, int, int]) -> int:
        """Value of an operation on nodes that have theirs already."""
        op, a, b = key
        p = self.field.prime
        if op in ("mul", "add", "sub"):  # their operands carry no signs
            left, right = self.values[a >> 1], self.values[b >> 1]
            return (left * right if op == "mul" else left + right if op == "add" else left - right) % p
        if op == "sin":
            return self._circle(a)[1]
        if op == "cos":
            return self._circle(a)[0]
        if op == "inv":
            return pow(self.of_ref(a), -1, p)
        if op == "symbol":
            return self.field.random("symbol " + self.graph.symbols[a])
        if op == "const":
            return self.field.constant(self.graph.constants[a])
        return self.field.random(f"sqrt of {self.of_ref(a)}")

    def _circle(self, ref: int) -> tuple[int, int]:
        """(cos, sin) of an angle: a point of the circle, homomorphic in sums and rational multiples of angles."""
        return self._mirrored(self._point(ref >> 1, Fraction(1)), bool(ref & 1))

    def _point(self, node: int, share: Fraction) -> tuple[int, int]:
        """The point of a positive multiple of a node: turned by its parts, theirs first, or a random one."""
        pending = [(node, share)]
        while pending:
            wanted = pending[-1]
            parts = self._parts(*wanted)
            missing = [part for part, _ in parts if part not in self._circles]
            if missing:
                pending += missing
                continue
            point = (1, 0) if parts else self._leaf(*wanted)
            for part, negative in parts:
                point = self._turn(point, self._mirrored(self._circles[part], negative))
            self._circles[wanted] = point
            pending.pop()
        return self._circles[node, share]

    def _parts(self, node: int, share: Fraction) -> list[tuple[tuple[int, Fraction], bool]]:
        """A multiple of a sum or of a rational multiple as positive multiples of its operands, each with its sign."""
        op, a, b = self.graph.code[node]
        if op in ("add", "sub"):
            terms = [(a, share), (b, share if op == "add" else -share)]
        else:
            number = self.graph.constant_of(2 * node if op == "const" else a) if op in ("const", "mul") else None
            if number is None or number.fraction is None or node == _ONE:
                return []
            terms = [(2 * _ONE if op == "const" else b, share * number.fraction)]
        return [((ref >> 1, abs(times)), (times < 0) ^ bool(ref & 1)) for ref, times in terms if times]

    def _leaf(self, node: int, share: Fraction) -> tuple[int, int]:
        """A point for what is no sum: `_FINEST` times its own fraction, so that an angle and its half are linked."""
        if self.values[node] == 0:
            return (1, 0)
        times = share * _FINEST
        tag = str(self.values[node])
        return self._turned(tag if times.denominator == 1 else f"{tag} / {times.denominator}", times.numerator)

    def _mirrored(self, point: tuple[int, int], negative: bool) -> tuple[int, int]:
        return (point[0], self.field.prime - point[1]) if negative and point[1] else point

    def _turned(self, tag: str, times: int) -> tuple[int, int]:
        """A random point, turned that often: by repeated squaring."""
        point, result = self.field.circle(tag), (1, 0)
        rest = times
        while rest:
            result = self._turn(result, point) if rest & 1 else result
            point, rest = self._turn(point, point), rest >> 1
        return result

    def _turn(self, one: tuple[int, int], two: tuple[int, int]) -> tuple[int, int]:
        p = self.field.prime
        return (one[0] * two[0] - one[1] * two[1]) % p, (one[1] * two[0] + one[0] * two[1]) % p
