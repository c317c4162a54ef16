"""Values of the nodes of a graph at one random point of a prime field."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nullbody.expr.field import Field

if TYPE_CHECKING:
    from nullbody.expr.graph import Graph

__all__ = ["Witness"]

_LARGEST_MULTIPLE = 64  # of an angle that is followed by the addition theorems


class Witness:
    """The values of a graph's nodes at one point: the evidence on which nodes are merged.

    sin and cos of a sum follow the addition theorems; the square root of anything but a constant is an
    independent random number (its sign in F_p would be arbitrary, and sqrt(x^2) is not x).
    """

    def __init__(self, graph: Graph, field: Field) -> None:
        self.graph = graph
        self.field = field
        self.values: list[int] = []
        self._circles: dict[int, tuple[int, int]] = {}

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
        if op == "mul":
            return self.of_ref(a) * self.of_ref(b) % p
        if op == "add":
            return (self.of_ref(a) + self.of_ref(b)) % p
        if op == "sub":
            return (self.of_ref(a) - self.of_ref(b)) % p
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
        """(cos, sin) of an angle: a point of the circle, homomorphic in sums and integer multiples."""
        node = ref >> 1
        if node not in self._circles:
            self._find_circle(node)
        c, s = self._circles[node]
        return (c, self.field.prime - s) if ref & 1 and s else (c, s)

    def _find_circle(self, node: int) -> None:
        """The point of an angle: turned by its parts, theirs first, or a random one."""
        pending = [node]
        while pending:
            current = pending[-1]
            parts = self._parts(current)
            missing = [ref >> 1 for ref, _ in parts if ref >> 1 not in self._circles]
            if missing:
                pending += missing
                continue
            point = (1, 0) if parts else self.field.circle(str(self.values[current]))
            for ref, times in parts:
                for _ in range(times):
                    point = self._turn(point, self._circle(ref))
            self._circles[current] = point
            pending.pop()

    def _parts(self, node: int) -> tuple[tuple[int, int], ...]:
        """An angle as a sum of (angle, how often), where it is one of whole multiples."""
        op, a, b = self.graph.code[node]
        if op in ("add", "sub"):
            return (a, 1), (b ^ 1 if op == "sub" else b, 1)
        number = self.graph.constant_of(a) if op == "mul" else None
        if number is None or number.fraction is None or number.fraction.denominator != 1:
            return ()
        times = abs(number.fraction.numerator)
        return ((b, times),) if times <= _LARGEST_MULTIPLE else ()

    def _turn(self, one: tuple[int, int], two: tuple[int, int]) -> tuple[int, int]:
        p = self.field.prime
        return (one[0] * two[0] - one[1] * two[1]) % p, (one[1] * two[0] + one[0] * two[1]) % p
