"""All charts of a null space: which are singular, what each costs, and how good it is.

A chart is a choice of d = n - rank columns of A that stay free. It is singular where |B|, the determinant of the
others, is identically zero. With any basis N0 of the null space, |B| is a constant times |N0[chart]|: one echelon form
and a d x d determinant for each chart decide it, exactly for numbers, by value at two random points for expressions.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb, inf, log10
from typing import Any

import numpy as np

from nullbody.errors import InputError, UnknownName
from nullbody.expr import Expr, Graph, Operations, operations
from nullbody.expr.matrix import Matrix
from nullbody.expr.transplant import transplant
from nullbody.nullspace.atlas import Atlas, Chart
from nullbody.nullspace.call import METHODS
from nullbody.nullspace.elimination import eliminate
from nullbody.nullspace.given import checked_columns, read
from nullbody.nullspace.numeric.call import array_null_space
from nullbody.nullspace.numeric.equilibrate import Array, Matrices
from nullbody.nullspace.plan import Plan
from nullbody.nullspace.residue import determinant, null_basis
from nullbody.nullspace.sample import double, sampled
from nullbody.nullspace.steps import sparse_rows
from nullbody.nullspace.switch import conditions, orthonormal
from nullbody.typing import FloatArray

__all__ = ["charts"]

_SECOND_SEED = 20_221  # of the graph whose random point confirms the first one's
_LEGIBLE = 10**9  # larger counts are rounded in messages

Columns = tuple[int, ...]
Point = Mapping[str, float]


@dataclass(frozen=True)
class _Request:
    """What the caller asked for, see `charts`."""

    columns: Sequence[int] | None
    plan: Plan
    points: Sequence[Point]
    limit: int
    progress: Callable[[int], None] | None

    def choices(self, n: int, d: int) -> list[Columns]:
        """All choices of d columns, in order."""
        candidates = range(n) if self.columns is None else sorted(checked_columns(self.columns, n, "candidate"))
        if len(candidates) < d:
            raise InputError(f"{d} columns of A are independent: columns= must hold at least {d}, not {candidates}")
        count = comb(len(candidates), d)
        if count > self.limit:
            raise InputError(
                f"there are {_shown(count)} choices of {d} of {len(candidates)} columns, more than the limit of "
                f"{self.limit}: restrict the candidates with columns=[...], or raise limit="
            )
        return list(combinations(candidates, d))


def charts(
    A: Any,
    *,
    columns: Sequence[int] | None = None,
    method: str = "auto",
    at: Point | Sequence[Point] | None = None,
    limit: int = 2000,
    progress: Callable[[int], None] | None = None,
) -> Atlas:
    """The atlas of A: all charts.

    Args:
        A: a matrix of any kind that `null_space` takes, but no stack.
        columns: the columns that may be independent; all of them by default.
        method: how N and N~ of expressions are made whose operations are counted: "auto", "minors", "elimination", see
            `null_space`. Each chart has a graph of its own: none takes over what another one has made.
        at: the point for the conditions of expressions, numbers by symbol; or several points, the worst of which
            counts. Symbols that are left out get generic numbers in 0.5..1.5.
        limit: the most charts.
        progress: called with the number of charts of expressions that are done.

    Raises:
        InputError: a bad matrix, bad columns, more charts than the limit, or only 0 in the null space.
        UnknownName: A has no symbol that `at` names, or there is no such method.
        ArithmeticError: two random points disagree on the singular charts (a chance of about 1e-15).
    """
    if method not in tuple(METHODS):
        raise UnknownName("method", method, METHODS, place="charts")
    points: Any = [at] if isinstance(at, Mapping) else at or [{}]
    if not isinstance(points, Sequence) or not all(isinstance(point, Mapping) for point in points):
        raise InputError(f"at must be a point, numbers by symbol, or a list of points, not {at!r}")
    if type(limit) is not int or limit < 1:
        raise InputError(f"limit is a number of charts, 1 or more, not {limit!r}")
    if progress is not None and not callable(progress):
        raise InputError(f"progress is called with a number, and {progress!r} cannot be")
    request = _Request(columns, Plan(largest=METHODS[method]), points, limit, progress)
    given = read(A)
    if given.kind == "sparse":
        request.choices(given.columns, 1)  # there are no fewer, and they have to fit before A is filled in
        return _of_array(given.matrix.toarray(), request)
    if given.kind == "array":
        return _of_array(given.matrix, request)
    if given.kind == "expressions":
        return _of_expressions(given.dense, request)
    return _of_numbers(given.dense, given.columns, request)


def _shown(count: int) -> str:
    return str(count) if count <= _LEGIBLE else f"about 1e{log10(count):.0f}"


def _of_expressions(rows: Sequence[Sequence[Expr]], request: _Request) -> Atlas:
    kept, choices, regular = _regular(rows, request)
    if (kept, regular) != _regular(_written_anew(rows, Graph(seed=_SECOND_SEED)), request)[::2]:
        raise ArithmeticError("two random points disagree on the singular charts; write A in a graph with another seed")
    used = [rows[i] for i in kept]
    values = sampled(used, request.points)
    finite = np.isfinite(values).all(axis=(1, 2))
    bases = orthonormal(Matrices.of(values[finite]), len(kept)) + [None] * int((~finite).sum())
    worst = _worst(bases, choices)
    fresh = _written_anew(used, Graph())
    found = []
    for k, choice in enumerate(choices):
        if regular[k]:
            found.append(Chart(choice, False, *_counts(fresh, choice, request.plan), float(worst[k])))
        else:
            found.append(Chart(choice, True, None, None, inf))
        if request.progress is not None:
            request.progress(k + 1)
    return Atlas(tuple(found), len(rows[0]))


def _regular(rows: Sequence[Sequence[Expr]], request: _Request) -> tuple[list[int], list[Columns], list[bool]]:
    """(independent rows, choices of columns, which are regular), by the values at the graph's random point."""
    graph = rows[0][0].graph
    values = [[graph.value(entry.ref) for entry in row] for row in rows]
    kept, basis = null_basis(values, range(len(rows[0])), graph.prime)
    choices = request.choices(len(basis), len(basis[0]))
    return kept, choices, [bool(determinant([basis[j] for j in choice], graph.prime)) for choice in choices]


def _written_anew(rows: Sequence[Sequence[Expr]], graph: Graph) -> list[list[Expr]]:
    moved = iter(transplant([entry for row in rows for entry in row], graph))
    return [[next(moved) for _ in row] for row in rows]


def _counts(rows: Sequence[Sequence[Expr]], independent: Columns, plan: Plan) -> tuple[Operations, Operations]:
    """The operations of N and of N~, made in a graph of their own."""
    if not rows:
        return Operations(), Operations()
    graph = rows[0][0].graph.copy()
    own = [[Expr(graph, entry.ref) for entry in row] for row in rows]
    factors = eliminate(sparse_rows(own), [j for j in range(len(own[0])) if j not in independent], plan)
    reduced = [entry for j in independent for entry in factors.solve_column(j)]
    scaled = [entry for j in independent for entry in factors.solve_column_scaled(j)] + [factors.delta]
    N, N_scaled = (operations([e for e in basis if isinstance(e, Expr)]) for basis in (reduced, scaled))
    return N, N_scaled


def _of_numbers(rows: Matrix, n: int, request: _Request) -> Atlas:
    """The conditions come from the exact N of the allowed chart with the largest |B|.

    If all columns are allowed, none of its entries exceeds 1.
    """
    sampled([], request.points)  # numbers have no symbols: a point that names one is refused
    _, basis = null_basis(rows, range(n))
    choices = request.choices(n, len(basis[0]))
    volumes = [abs(determinant([basis[j] for j in choice])) for choice in choices]
    largest = choices[max(range(len(choices)), key=volumes.__getitem__)]
    worst = np.full(len(choices), inf)
    if any(volumes):
        _, basis = null_basis(rows, [*(j for j in range(n) if j not in largest), *largest])
        Z, _ = np.linalg.qr(np.array([[double(entry) for entry in row] for row in basis]))
        worst = _worst([Z], choices)
    return _uncounted(choices, worst, [not volume for volume in volumes], n)


def _of_array(A: Any, request: _Request) -> Atlas:
    sampled([], request.points)
    if A.ndim != 2:
        raise InputError(f"charts of one matrix (m, n) are wanted, not of an array of shape {A.shape}")
    Z = array_null_space(A, form="orthonormal", method="svd").basis
    choices = request.choices(*Z.shape)
    worst = _worst([Z], choices)
    return _uncounted(choices, worst, [condition == inf for condition in worst.tolist()], len(Z))


def _uncounted(choices: Sequence[Columns], worst: FloatArray, singular: Sequence[bool], n: int) -> Atlas:
    found = zip(choices, singular, worst.tolist(), strict=True)
    return Atlas(tuple(Chart(c, empty, None, None, inf if empty else figure) for c, empty, figure in found), n)


def _worst(bases: Sequence[Array | None], choices: Sequence[Columns]) -> FloatArray:
    """The largest condition of each choice, infinite where a basis is missing."""
    index = np.array(choices, dtype=np.intp)
    every = [np.full(len(choices), inf) if Z is None else conditions(Z, index) for Z in bases]
    result: FloatArray = np.max(every, axis=0)
    return result
