"""An orthogonal basis N^ from any basis N, by the Gram matrix of its columns.

    G = N^T N = L D L^T          L unit lower triangular, D diagonal
    N^ = N L^-T                  N^^T N^ = D, the first column unchanged          "orthogonal"
    Z = N^ D^(-1/2)              Z^T Z = I                                        "orthonormal"
    v_k = |G_(k-1)| N^_k         a polynomial in N, no division                   `division_free`

The factors are found column by column (Gram and Schmidt, in the order that keeps rounding small: each column is
made orthogonal to one finished column after the other, l_kj = N^_j . N_k / d_j). That takes as many operations as
factoring G, one reciprocal for each d_j but the last.

Two things keep expressions small. The independent places of N hold ones and zeros. And a row of N that is a
multiple k of another one stays that multiple: the pair counts 1 + k^2 times in every product, and only the first of
the two is transformed (for the 3-PRS x' = b cos(theta) theta').

Near |B| = 0 the columns of N become parallel and rounding tilts N^ by about eps cond(N): take arrays there and the
form "orthonormal", which goes by Householder's reflections (`nullbody.nullspace.numeric`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

from nullbody.errors import InputError
from nullbody.expr import Exact, Expr, sqrt
from nullbody.expr.matrix import Matrix, total, transpose
from nullbody.nullspace.given import checked_columns, scalar_rows
from nullbody.nullspace.minors import LARGEST
from nullbody.nullspace.scalar import is_zero, reciprocal
from nullbody.tolerances import EPS

__all__ = ["division_free", "orthogonal", "orthonormal", "paper_scaled"]

_LOST = (16 * EPS) ** 2  # of a column's squared length: what is left of it is nothing but rounding

Rows = tuple[tuple[Any, ...], ...]


def orthogonal(N: Matrix) -> Rows:
    """N^ = N L^-T: orthogonal columns, the first one unchanged, L unit lower triangular          [14-18].

    q' = N^ u, where the quasi-velocities u = L^T v are combinations of the independent velocities.

    Args:
        N: n x d, independent columns of exact numbers, floats or expressions of a graph.

    Returns:
        Rows of the same scalars.

    Raises:
        InputError: the columns are not independent.
    """
    fold = _Fold.of(N)
    return fold.unfolded(_orthogonalised(fold)[0])


def orthonormal(N: Matrix) -> Rows:
    """Z = N^ D^(-1/2): the columns of `orthogonal` with length 1, Z^T Z = I.

    Args:
        N: n x d, independent columns.

    Returns:
        Rows of expressions, of floats, or for exact numbers of `Exact`: rational multiples of square roots.

    Raises:
        InputError: the columns are not independent, or a length of exact numbers is not kept exactly.
    """
    fold = _Fold.of(N)
    columns, squares = _orthogonalised(fold)
    scaled = []
    for column, square in zip(columns, squares, strict=True):
        inverse = _inverse_root(square)
        exact = isinstance(inverse, Exact)
        scaled.append([inverse * (Exact.of(entry) if exact else entry) for entry in column])
    return fold.unfolded(scaled)


def division_free(N: Matrix) -> Rows:
    """Orthogonal columns v_k = |G_(k-1)| N^_k, without any division.

    G_k is the Gram matrix of the first k columns, |G_0| = 1, and v_k the determinant

             | g_11 ..  g_1k     |
        v_k =| ..                |     v_1 = N_1,   v_2 = g_11 N_2 - g_12 N_1,   ...     v_k . v_k = |G_(k-1)| |G_k|
             | g_(k-1)1 ..       |
             | N_1  ..  N_k      |

    Args:
        N: n x d, usually the scaled basis N~, which is free of divisions itself; d at most 14.

    Raises:
        InputError: too many columns. (Dependent ones give a column of zeros.)

    Source: U. Erlingsson, E. Kaltofen, D. Musser, Generic Gram-Schmidt orthogonalization by exact division,
        ISSAC 1996, 275-282.
    """
    fold = _Fold.of(N)
    return fold.unfolded(_division_free(fold))


def paper_scaled(N: Matrix, delta: Any, independent: Sequence[int]) -> Rows:
    """The columns of the paper's procedure, `orthogonal_basis(A, scaled=True)`, the cheap way: b_k N^_k.

    The procedure appends the columns that it has as rows to A, and takes determinants. Those rows are orthogonal to
    the columns before them, so that the determinant b_k of step k is a product (d_k = N^_k . N^_k):

        b_1 = delta,     b_k = s_k b_(k-1)^2 d_(k-1)

    with s_k = 1 or -1 by the places of the independent columns. In terms of `division_free(N~)` and the Gram matrix g
    of N~ = delta N the columns are v_1, s_2 v_2 / delta, s_3 g_11 v_3 / delta^3, s_4 g_11^2 |g_2| v_4 / delta^7, ...

    Args:
        N: the reduced basis, n x d.
        delta: |B|.
        independent: the columns of A that are free, in the order of N's columns.

    Raises:
        InputError: the sizes do not fit.
    """
    fold = _Fold.of(N)
    independent = checked_columns(independent, len(N), "independent")
    if len(fold.columns) != len(independent):
        raise InputError(f"a basis of {len(fold.columns)} columns has as many independent places, not {independent}")
    if _no_scalar(delta):
        raise InputError(f"delta must be a scalar, not {delta!r}")
    scale = delta
    result = []
    for k, (column, square) in enumerate(zip(*_orthogonalised(fold), strict=True)):
        result.append([scale * entry if not is_zero(entry) else 0 for entry in column])
        if k + 1 < len(independent):
            scale = _sign(len(N), independent, k) * (scale * scale * square)
    return fold.unfolded(result)


def _orthogonalised(fold: _Fold) -> tuple[list[list[Any]], list[Any]]:
    """The columns of N^ and their squared lengths d_k."""
    done: list[list[Any]] = []
    squares: list[Any] = []
    for k, column in enumerate(fold.columns):
        rest = column
        for earlier, square in zip(done, squares, strict=True):
            share = fold.dot(earlier, rest)
            if not is_zero(share):
                rest = _minus(rest, share * reciprocal(square), earlier)
        square = fold.dot(rest, rest)
        lost = isinstance(square, float) and k > 0 and square <= _LOST * fold.dot(column, column)
        if lost or is_zero(square):
            raise InputError(f"column {k} of the basis is a combination of the columns before it")
        done.append(rest)
        squares.append(square)
    return done, squares


def _division_free(fold: _Fold) -> list[list[Any]]:
    """The columns v_k, each the sum of N's columns times minors of their Gram matrix."""
    columns = fold.columns
    if len(columns) > LARGEST:
        raise InputError(f"{len(columns)} columns are too many for minors (at most {LARGEST}): take `orthogonal`")
    gram = cache(lambda i, j: fold.dot(columns[i], columns[j]))

    @cache
    def minor(chosen: tuple[int, ...]) -> Any:
        """The minor of the first rows and the chosen columns of G, by its last row."""
        last = len(chosen) - 1
        if last < 0:
            return 1
        rest = [chosen[:p] + chosen[p + 1 :] for p in range(len(chosen))]
        return total(
            (-1) ** (last + p) * (gram(min(last, j), max(last, j)) * minor(rest[p]))
            for p, j in enumerate(chosen)
            if not (is_zero(gram(min(last, j), max(last, j))) or is_zero(minor(rest[p])))
        )

    result = []
    for k in range(len(columns)):
        factors = [(-1) ** (k - j) * minor(tuple(i for i in range(k + 1) if i != j)) for j in range(k + 1)]
        result.append(
            [
                total(f * e for f, e in zip(factors, entries, strict=True) if not (is_zero(f) or is_zero(e)))
                for entries in zip(*columns[: k + 1], strict=True)
            ]
        )
    return result


@dataclass(frozen=True)
class _Fold:
    """The columns of a basis without the rows that are multiples of others.

    Attributes:
        columns: the columns, with the rows that were kept.
        weights: how often each of these rows counts in a product of columns: 1 + the squares of its multiples.
        kept: which rows these are.
        multiples: for every other row its factor and the kept row that it is a multiple of.
    """

    columns: list[list[Any]]
    weights: list[Any]
    kept: list[int]
    multiples: dict[int, tuple[Any, int]]

    @classmethod
    def of(cls, N: Matrix) -> _Fold:
        wanted = "a basis is a non-empty list of rows of equal length"
        rows = scalar_rows(N, wanted)
        if not rows or not rows[0] or any(len(row) != len(rows[0]) for row in rows):
            raise InputError(wanted)
        if any(_no_scalar(entry) for row in rows for entry in row):
            raise InputError(f"{wanted}, of scalars")
        multiples = _multiples(rows)
        kept = [i for i in range(len(rows)) if i not in multiples]
        weights: dict[int, Any] = dict.fromkeys(kept, 1)
        for factor, source in multiples.values():
            weights[source] = weights[source] + factor * factor
        return cls(transpose([rows[i] for i in kept]), list(weights.values()), kept, multiples)

    def dot(self, left: Sequence[Any], right: Sequence[Any]) -> Any:
        """left . right, over all rows of the basis."""
        return total(
            (a if isinstance(weight, int) else a * weight) * b
            for a, b, weight in zip(left, right, self.weights, strict=True)
            if not (is_zero(a) or is_zero(b))
        )

    def unfolded(self, columns: Sequence[Sequence[Any]]) -> Rows:
        """The rows of all columns, with the multiples in their places."""
        found = dict(zip(self.kept, zip(*columns, strict=True), strict=True))
        for i, (factor, source) in self.multiples.items():
            found[i] = tuple(0 if is_zero(entry) else factor * entry for entry in found[source])
        return tuple(found[i] for i in range(len(found)))


def _no_scalar(entry: Any) -> bool:
    return entry is None or hasattr(entry, "__len__")


def _multiples(rows: list[list[Any]]) -> dict[int, tuple[Any, int]]:
    """Rows of expressions that are multiples of another row, by a factor that is needed for them anyway.

    Two rows are proportional if their values agree after division by the first non-zero one. The ratio is used only if
    it is a constant or already a sub-expression of N, so that it costs nothing. Of each family the source that explains
    most rows is taken.
    """
    expressions = [entry for row in rows for entry in row if isinstance(entry, Expr)]
    if not expressions:
        return {}
    graph = expressions[0].graph
    near = set(graph.reachable(entry.ref for entry in expressions))
    alike: dict[tuple[int, ...], list[tuple[int, int]]] = {}
    for i, row in enumerate(rows):
        values = [graph.value(e.ref) if isinstance(e, Expr) else graph.residue(Exact.of(e)) for e in row]
        pivot = next((value for value in values if value), None)
        if pivot is not None:
            inverse = pow(pivot, -1, graph.prime)
            alike.setdefault(tuple(value * inverse % graph.prime for value in values), []).append((i, pivot))
    found: dict[int, tuple[Any, int]] = {}
    for rays in alike.values():
        best: dict[int, tuple[Any, int]] = {}
        for source, unit in rays:
            inverse = pow(unit, -1, graph.prime)
            factors = {i: graph.find(size * inverse % graph.prime, -1) for i, size in rays if i != source}
            usable = {
                i: (Expr(graph, ref), source)
                for i, ref in factors.items()
                if ref is not None and (ref >> 1 in near or graph.constant_of(ref) is not None)
            }
            best = max(best, usable, key=len)
        found |= best
    return found


def _minus(vector: Sequence[Any], factor: Any, other: Sequence[Any]) -> list[Any]:
    """vector - factor other"""
    return [a if is_zero(b) else total((a, -(factor * b))) for a, b in zip(vector, other, strict=True)]


def _inverse_root(square: Any) -> Any:
    """1 / sqrt(square)"""
    if isinstance(square, Expr):
        return sqrt(reciprocal(square))
    if not isinstance(square, int | Fraction):
        return 1 / math.sqrt(square)
    try:
        return Exact.square_root(reciprocal(square))
    except InputError as error:
        raise InputError(f"{error}; take the form 'orthogonal', or floats") from None


def _sign(n: int, independent: Sequence[int], k: int) -> int:
    """s_(k+1): the parity of the columns that independent column k passes when it joins the dependent ones.

    In the paper's determinants the columns stand in increasing order, and the row that is new stands last.
    """
    passed = sum(j > independent[k] for j in set(range(n)) - set(independent[k:]))
    return -1 if passed % 2 else 1
