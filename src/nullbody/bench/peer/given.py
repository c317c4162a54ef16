"""A matrix of the benchmark in another tool's scalars, and what a method hands back."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.bench.matrix import Matrix
from nullbody.expr import Exact
from nullbody.typing import FloatArray

__all__ = ["Given", "Solved", "written"]


@dataclass(frozen=True)
class Given:
    """What a method gets.

    Attributes:
        matrix: the matrix in this package's own form.
        values: of its symbols, for methods that look at numbers, and for the test of the result.
    """

    matrix: Matrix
    values: Sequence[float]


@dataclass(frozen=True)
class Solved:
    """What a method hands back; counted and evaluated after its time was taken.

    Attributes:
        operations: counts additions, multiplications, divisions, square roots, each shared part once.
        value: gives N, n x d, the independent columns last, at values of the matrix's symbols.
    """

    operations: Callable[[], int]
    value: Callable[[Sequence[float]], FloatArray]


def written(
    matrix: Matrix,
    symbol: Callable[[str], Any],
    constant: Callable[[Exact], Any],
    functions: Mapping[str, Callable[[Any], Any]],
) -> list[list[Any]]:
    """The entries, the independent columns last, in scalars of another tool.

    Args:
        matrix: what to write.
        symbol: makes a scalar of a name.
        constant: makes one of a constant.
        functions: "sin" and "cos" of a scalar, where the matrix has them.
    """
    graph = matrix.rows[0][0].graph
    known: dict[int, Any] = {}

    def read(ref: int) -> Any:
        return -known[ref >> 1] if ref & 1 else known[ref >> 1]

    for node in graph.reachable(entry.ref for row in matrix.rows for entry in row):
        op, a, b = graph.code[node]
        if op == "symbol":
            known[node] = symbol(graph.symbols[a])
        elif op == "const":
            known[node] = constant(graph.constants[a])
        elif op == "mul":
            known[node] = read(a) * read(b)
        elif op in ("add", "sub"):
            known[node] = read(a) + read(b) if op == "add" else read(a) - read(b)
        else:
            known[node] = functions[op](read(a))
    return [[read(row[j].ref) for j in matrix.order] for row in matrix.rows]
