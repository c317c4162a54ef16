"""The symbols of the inputs of routines: q, v, u, v_dot, q_ddot, t, parameters."""

from __future__ import annotations

from nullbody.expr import Expr, Graph
from nullbody.expr.matrix import total
from nullbody.mechanism import Mechanism

__all__ = ["Symbols"]


class Symbols:
    """The symbols of a mechanism in a graph.

    Args:
        graph: where they are.
        mechanism: whose they are.
        independent: names of the independent coordinates.

    Attributes:
        groups: names in each group of inputs.
        q, rates, v, u: symbols.
        Q: generalized forces of the inputs.
        input_columns: the columns of S in Q = S u.
    """

    def __init__(self, graph: Graph, mechanism: Mechanism, independent: tuple[str, ...]) -> None:
        names = mechanism.coordinates
        self.graph = graph
        self.mechanism, self.independent = mechanism, independent
        self.groups = {
            "q": names,
            "v": tuple(f"{name}_dot" for name in independent),
            "q_dot": tuple(f"{name}_dot" for name in names),
            "u": mechanism.inputs,
            "v_dot": tuple(f"{name}_ddot" for name in independent),
            "q_ddot": tuple(f"{name}_ddot" for name in names),
            "t": ("t",) if mechanism.rheonomic else (),
            "p": tuple(p.name for p in mechanism.parameters),
        }
        self.q = [graph.symbol(name) for name in names]
        self.rates = [graph.symbol(f"{name}_dot") for name in names]
        self.v, self.u = self.group("v"), self.group("u")
        acting = [(actuator.coordinate, graph.symbol(actuator.name)) for actuator in mechanism.actuators]
        self.Q = [self.zero + total(u for coordinate, u in acting if coordinate == name) for name in names]
        self.input_columns = [[1 if a.coordinate == name else 0 for name in names] for a in mechanism.actuators]

    def of(self, graph: Graph) -> Symbols:
        """The same symbols in another graph."""
        return Symbols(graph, self.mechanism, self.independent)

    @property
    def zero(self) -> Expr:
        """The expression 0."""
        return self.graph.constant(0)

    def group(self, name: str) -> list[Expr]:
        """The symbols of a group of inputs."""
        return [self.graph.symbol(symbol) for symbol in self.groups[name]]

    def places(self, names: tuple[str, ...]) -> list[int]:
        """Places of coordinates in q."""
        return [self.groups["q"].index(name) for name in names]
