"""Null spaces by FLINT: N~ = [-adj(B) C; |B| I] as expanded polynomials, each minor once.

Sines, cosines and sqrt(3) are symbols of their own: FLINT has polynomials, no functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from nullbody.bench.peer.given import Given, Solved, written
from nullbody.expr import Exact
from nullbody.typing import FloatArray

__all__ = ["METHODS"]


def _minors(given: Given) -> Callable[[], Solved]:
    """Write A in a polynomial ring; the work is all maximal minors that N~ needs."""
    import flint

    names = [*given.matrix.inputs, *(f"{f}_{name}" for f in ("sin", "cos") for name in given.matrix.inputs), "root3"]
    ring = flint.fmpq_mpoly_ctx.get(names, flint.Ordering.lex)
    symbols = dict(zip(names, ring.gens(), strict=True))
    place = {str(symbol): name for name, symbol in symbols.items()}

    def constant(number: Exact) -> Any:
        terms = (
            symbols["root3"] ** (k == 3) * flint.fmpq(part.numerator, part.denominator) for k, part in number.terms
        )
        return sum(terms, ring.constant(0))

    functions = {f: (lambda x, f=f: symbols[f"{f}_{place[str(x)]}"]) for f in ("sin", "cos")}
    A = written(given.matrix, symbols.__getitem__, constant, functions)

    def solve() -> Solved:
        N = _scaled(A, ring.constant(1))

        def value(values: Sequence[float]) -> FloatArray:
            point = [*values, *map(math.sin, values), *map(math.cos, values), math.sqrt(3)]
            return np.array([[_value(entry, point) for entry in row] for row in N])

        return Solved(lambda: _operations([entry for row in N for entry in row]), value)

    return solve


def _scaled(A: list[list[Any]], one: Any) -> list[list[Any]]:
    """[-adj(B) C; |B| I], minors of the first rows by the set of their columns."""
    m, n = len(A), len(A[0])
    known: dict[tuple[int, ...], Any] = {(): one}

    def minor(columns: tuple[int, ...]) -> Any:
        if columns not in known:
            row = A[len(columns) - 1]
            total = 0 * one
            for k, column in enumerate(columns):
                if row[column] != 0:
                    term = row[column] * minor(columns[:k] + columns[k + 1 :])
                    total = total + term if (len(columns) - 1 - k) % 2 == 0 else total - term
            known[columns] = total
        return known[columns]

    N = [[0 * one] * (n - m) for _ in range(n)]
    for j in range(m, n):
        N[j][j - m] = minor(tuple(range(m)))
        for i in range(m):
            others = tuple(k for k in range(m) if k != i)
            N[i][j - m] = minor((*others, j)) * (-1 if (m - 1 - i) % 2 == 0 else 1)
    return N


def _value(polynomial: Any, point: Sequence[float]) -> float:
    """The value of a polynomial, term by term."""
    terms = polynomial.to_dict().items()
    return math.fsum(
        float(factor.p) / float(factor.q) * math.prod(x ** int(e) for x, e in zip(point, exponents, strict=True) if e)
        for exponents, factor in terms
    )


def _operations(polynomials: Sequence[Any]) -> int:
    """Additions of terms, products with factors, and products of symbols, those that begin alike once."""
    starts: set[tuple[int, ...]] = set()
    count = 0
    for terms in {str(p): p.to_dict() for p in polynomials}.values():
        count += max(0, len(terms) - 1)
        for exponents, factor in terms.items():
            count += abs(factor) != 1
            product = [k for k, e in enumerate(exponents) for _ in range(int(e))]
            starts |= {tuple(product[:length]) for length in range(2, len(product) + 1)}
    return count + len(starts)


#: For each method: given -> the function that is timed.
METHODS: dict[str, Callable[[Given], Callable[[], Solved]]] = {"flint_minors": _minors}
