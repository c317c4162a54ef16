"""Random expressions as programs, so that the same one can be built in any algebra."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from hypothesis import strategies as st

from nullbody.expr import Graph, cos, sin, sqrt

__all__ = ["FLOATS", "NAMES", "RATIONAL", "SMOOTH", "Algebra", "build", "graph_algebra", "points", "programs"]

NAMES = ("x", "y", "z")
Step = tuple[str, int, int]


@dataclass(frozen=True)
class Algebra:
    """The leaves and the functions of one number type."""

    leaves: Sequence[Any]
    constant: Callable[[Fraction], Any]
    functions: Mapping[str, Callable[[Any], Any]]


FLOATS = {"sin": math.sin, "cos": math.cos, "sqrt": math.sqrt}
RATIONAL = ("add", "sub", "mul", "neg")
SMOOTH = (*RATIONAL, "sin", "cos", "inv", "sqrt")


def programs(operations: Sequence[str] = SMOOTH, longest: int = 12) -> st.SearchStrategy[list[Step]]:
    """Programs over x, y, z; each step names an operation and two earlier results, counted from the end."""
    step = st.tuples(st.sampled_from(operations), st.integers(0, 6), st.integers(0, 6))
    return st.lists(step, min_size=1, max_size=longest)


def points() -> st.SearchStrategy[list[float]]:
    """Values of x, y, z."""
    return st.lists(st.floats(-2, 2).map(lambda x: round(x, 3)), min_size=3, max_size=3)


def build(program: Sequence[Step], algebra: Algebra) -> Any:
    """The last result; inverses and roots are taken of arguments of at least 1."""
    pool = [algebra.constant(Fraction(-3, 2)), algebra.constant(Fraction(1)), *algebra.leaves]
    for operation, i, j in program:
        a, b = pool[-1 - i % len(pool)], pool[-1 - j % len(pool)]
        pool.append(_result(operation, a, b, algebra))
    return pool[-1]


def _result(operation: str, a: Any, b: Any, algebra: Algebra) -> Any:
    binary = {"add": lambda: a + b, "sub": lambda: a - b, "mul": lambda: a * b, "neg": lambda: -a}
    if operation in binary:
        return binary[operation]()
    if operation in ("sin", "cos"):
        return algebra.functions[operation](a)
    bounded = algebra.functions["sin"](a) * b
    positive = bounded * bounded + algebra.constant(Fraction(1))
    return algebra.functions["sqrt"](positive) if operation == "sqrt" else algebra.constant(Fraction(1)) / positive


def graph_algebra(graph: Graph) -> Algebra:
    """Expressions of a graph."""
    leaves = [graph.symbol(name) for name in NAMES]
    return Algebra(leaves, graph.constant, {"sin": sin, "cos": cos, "sqrt": sqrt})
