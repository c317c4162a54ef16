"""Null spaces by SymPy.

gauss_jordan      fixed order, pivot = first entry of the column that `simplify` does not show to be zero
structural        the same with SymPy's structural zero test: what is not written as 0 is a pivot
by_value          the same with the zero test and the pivot chosen by value at a state
nullspace, rref   of Matrix, SymPy's own
cramer_solve      Matrix.cramer_solve: determinants by Laplace expansion (SymPy 1.13; pull request 25179)
lu_solve          Matrix.LUsolve
domain_...        DomainMatrix over a polynomial ring, sqrt(3) being one more symbol
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nullbody.bench.peer.given import Given, Solved, written
from nullbody.bench.peer.tree import evaluated, operations
from nullbody.expr import Exact

__all__ = ["METHODS"]

_SMALL = 1e-9  # value of an entry that is taken for zero at a state

Method = Callable[[Any, Given], Any]


def _run(method: Method, given: Given, *, plain_roots: bool = False) -> Callable[[], Solved]:
    """Write A for SymPy; what is returned does the work that is timed."""
    from sympy import Matrix, Rational, Symbol, cos, sin, sqrt

    root = Symbol("root3") if plain_roots else sqrt(3)

    def constant(number: Exact) -> Any:
        terms = [
            Rational(part.numerator, part.denominator) * (1 if k == 1 else root if k == 3 else sqrt(k))
            for k, part in number.terms
        ]
        return sum(terms, Rational(0))

    names = {name: Symbol(name, real=True) for name in given.matrix.inputs}
    A = Matrix(written(given.matrix, names.__getitem__, constant, {"sin": sin, "cos": cos}))

    def solve() -> Solved:
        N = method(A, given)
        rows = [list(N.row(i)) for i in range(N.rows)]

        def value(values: Any) -> Any:
            known = {names[name]: float(number) for name, number in zip(given.matrix.inputs, values, strict=True)}
            return evaluated(rows, known | ({root: 3**0.5} if plain_roots else {}))

        return Solved(lambda: operations(entry for row in rows for entry in row), value)

    return solve


def _eliminated(A: Any, is_zero: Callable[[Any, int, int], bool], shadow: list[list[float]] | None) -> Any:
    """[B | C] to [I | B^-1 C] by row operations in fixed order; N = [-B^-1 C; I]."""
    from sympy import Matrix, eye

    rows, size = A.shape
    R = [list(A.row(i)) for i in range(rows)]
    for k in range(rows):
        order = list(range(k, rows))
        if shadow is not None:
            order.sort(key=lambda i: -abs(shadow[i][k]))
        pivot = next(i for i in order if not is_zero(R[i][k], i, k))
        for table in (R,) if shadow is None else (R, shadow):
            table[k], table[pivot] = table[pivot], table[k]
            head = table[k][k]
            table[k] = [entry / head for entry in table[k]]
            for i in range(rows):
                factor = table[i][k]
                if i != k and factor != 0:
                    table[i] = [entry - factor * lead for entry, lead in zip(table[i], table[k], strict=True)]
    return Matrix(rows, size - rows, lambda i, j: -R[i][rows + j]).col_join(eye(size - rows))


def _by_simplify(A: Any, given: Given) -> Any:
    from sympy import simplify

    return _eliminated(A, lambda entry, i, k: entry == 0 or simplify(entry) == 0, None)


def _structural(A: Any, given: Given) -> Any:
    return _eliminated(A, lambda entry, i, k: entry == 0, None)


def _by_value(A: Any, given: Given) -> Any:
    import numpy as np

    numbers = given.matrix.numbers(np.array([given.values]))[0][:, given.matrix.order]
    shadow: list[list[float]] = numbers.tolist()
    return _eliminated(A, lambda entry, i, k: entry == 0 or abs(shadow[i][k]) < _SMALL, shadow)


def _nullspace(A: Any, given: Given) -> Any:
    from sympy import Matrix

    return Matrix.hstack(*A.nullspace())


def _rref(A: Any, given: Given) -> Any:
    from sympy import zeros

    R, pivots = A.rref()
    free = [j for j in range(A.cols) if j not in pivots]
    N = zeros(A.cols, len(free))
    for k, j in enumerate(free):
        N[j, k] = 1
        for i, pivot in enumerate(pivots):
            N[pivot, k] = -R[i, j]
    return N


def _cramer(A: Any, given: Given) -> Any:
    return _completed(A, A[:, : A.rows].cramer_solve(A[:, A.rows :]))


def _lu(A: Any, given: Given) -> Any:
    return _completed(A, A[:, : A.rows].LUsolve(A[:, A.rows :]))


def _completed(A: Any, solution: Any) -> Any:
    from sympy import eye

    return (-solution).col_join(eye(A.cols - A.rows))


def _domain_nullspace(A: Any, given: Given) -> Any:
    from sympy.polys.matrices import DomainMatrix

    return DomainMatrix.from_Matrix(A).nullspace().to_Matrix().T


def _domain_adjugate(A: Any, given: Given) -> Any:
    """[-adj(B) C; |B| I]"""
    from sympy import eye
    from sympy.polys.matrices import DomainMatrix

    whole = DomainMatrix.from_Matrix(A)
    adjugate, delta = whole[:, : A.rows].adj_det()
    numerators = (adjugate * whole[:, A.rows :]).to_Matrix()
    return (-numerators).col_join(whole.domain.to_sympy(delta) * eye(A.cols - A.rows))


#: For each method: given -> the function that is timed.
METHODS: dict[str, Callable[[Given], Callable[[], Solved]]] = {
    "gauss_jordan": lambda given: _run(_by_simplify, given),
    "structural": lambda given: _run(_structural, given),
    "by_value": lambda given: _run(_by_value, given),
    "nullspace": lambda given: _run(_nullspace, given),
    "rref": lambda given: _run(_rref, given),
    "cramer_solve": lambda given: _run(_cramer, given),
    "lu_solve": lambda given: _run(_lu, given),
    "domain_nullspace": lambda given: _run(_domain_nullspace, given, plain_roots=True),
    "domain_adjugate": lambda given: _run(_domain_adjugate, given, plain_roots=True),
}
