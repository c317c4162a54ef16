"""Null spaces by SymEngine: N = [-B^-1 C; I] by its LU, its inverse, or one determinant for each entry."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nullbody.bench.peer.given import Given, Solved, written
from nullbody.bench.peer.tree import evaluated, operations
from nullbody.expr import Exact

__all__ = ["METHODS"]


def _run(method: Callable[[Any, Any], Any], given: Given) -> Callable[[], Solved]:
    """Write [B | C] for SymEngine; `method` takes B and C to B^-1 C."""
    import symengine

    def constant(number: Exact) -> Any:
        terms = (
            symengine.Rational(part.numerator, part.denominator) * (1 if k == 1 else symengine.sqrt(k))
            for k, part in number.terms
        )
        return sum(terms, symengine.Integer(0))

    names = {name: symengine.Symbol(name) for name in given.matrix.inputs}
    functions = {"sin": symengine.sin, "cos": symengine.cos}
    A = written(given.matrix, names.__getitem__, constant, functions)
    m, n = given.matrix.shape
    B = symengine.DenseMatrix([row[:m] for row in A])
    C = symengine.DenseMatrix([row[m:] for row in A])

    def solve() -> Solved:
        X = method(B, C)
        rows = [[-X[i, j] for j in range(n - m)] for i in range(m)]
        rows += [[symengine.Integer(i == j) for j in range(n - m)] for i in range(n - m)]

        def value(values: Any) -> Any:
            return evaluated(rows, {names[name]: x for name, x in zip(given.matrix.inputs, values, strict=True)})

        return Solved(lambda: operations(entry for row in rows for entry in row), value)

    return solve


def _lu(B: Any, C: Any) -> Any:
    return B.LUsolve(C)


def _inverse(B: Any, C: Any) -> Any:
    return B.inv() * C


def _determinants(B: Any, C: Any) -> Any:
    """|B(i <- C_j)| / |B| [11]"""
    import symengine

    rows = range(B.nrows())
    delta = B.det()

    def replaced(i: int, j: int) -> Any:
        return symengine.DenseMatrix([[C[r, j] if c == i else B[r, c] for c in rows] for r in rows])

    return symengine.DenseMatrix([[replaced(i, j).det() / delta for j in range(C.ncols())] for i in rows])


#: For each method: given -> the function that is timed.
METHODS: dict[str, Callable[[Given], Callable[[], Solved]]] = {
    "symengine_lu": lambda given: _run(_lu, given),
    "symengine_inverse": lambda given: _run(_inverse, given),
    "symengine_determinants": lambda given: _run(_determinants, given),
}
