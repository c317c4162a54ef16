"""The methods: from a stack of matrices and a request to charts and bases.

Those that need the columns first (complete, lu, minors) give the reduced N; those that find the subspace first (qr,
svd) give an orthonormal Z, which stays accurate whatever the chart.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from nullbody.errors import InputError
from nullbody.nullspace.numeric.chart import Chart, Request, chosen, dependent_part, preferred, refused
from nullbody.nullspace.numeric.complete import eliminated
from nullbody.nullspace.numeric.equilibrate import Array, Matrices
from nullbody.nullspace.numeric.orthonormal import (
    by_householder,
    by_singular_values,
    reduced_of,
    rows_at,
    turned,
    well_spread,
)
from nullbody.nullspace.numeric.rank import one_rank, others
from nullbody.typing import IndexArray

__all__ = ["METHODS", "Found", "complete", "lu", "reduced_basis"]


@dataclass(frozen=True)
class Found:
    """What a method found, in doubles.

    Attributes:
        chart: columns and rows.
        reduced: N, k x n x d.
        orthonormal: Z, k x n x d, where the method found it directly; else None.
    """

    chart: Chart
    reduced: Array
    orthonormal: Array | None = None


def complete(matrices: Matrices, request: Request) -> Found:
    """Gaussian elimination with complete pivoting: of all columns, or inside B where the columns are chosen."""
    chart, N = chosen(matrices, request)
    if N is not None:
        return Found(chart, N)
    rank = chart.rows.shape[1]
    found = eliminated(matrices.scaled, chart.order, rank)
    weak = np.flatnonzero(found.ranks(request.threshold(matrices)) < rank)
    if len(weak):
        raise refused(matrices, chart, int(weak[0]), request)
    return Found(chart, found.null_space(rank))


def lu(matrices: Matrices, request: Request) -> Found:
    """B [X | B^-1] = [C | I] by LAPACK's LU with row pivoting; |B^-1| tells how near to singular B is."""
    chart, _ = chosen(matrices, request)
    B, C = dependent_part(matrices, chart), _independent_part(matrices, chart)
    rank, d = C.shape[1:]
    right = np.concatenate([C, np.broadcast_to(np.eye(rank), B.shape)], axis=2)
    try:
        solved = np.linalg.solve(B, right)
    except np.linalg.LinAlgError:  # one of them is exactly singular: complete pivoting says which one
        return complete(matrices, request)
    with np.errstate(over="ignore"):
        size = np.linalg.norm(solved[:, :, d:], axis=(1, 2))
    weak = np.flatnonzero(~(size * request.threshold(matrices) < 1))
    if len(weak):
        raise refused(matrices, chart, int(weak[0]), request)
    return Found(chart, reduced_basis(solved[:, :, :d], chart))


def minors(matrices: Matrices, request: Request) -> Found:
    """Cramer's rule, N = -adj(B) C / |B|, each minor once: the determinant-based method in floats, one by one."""
    from nullbody.nullspace.minors import adjugate

    chart, _ = chosen(matrices, request)
    B, C = dependent_part(matrices, chart), _independent_part(matrices, chart)
    X = np.empty_like(C)
    for i in range(len(B)):
        adjoint, determinant = adjugate(B[i].tolist())
        if not abs(determinant) > 0 or np.linalg.norm(adjoint) * request.threshold(matrices)[i] >= abs(determinant):
            raise refused(matrices, chart, i, request)
        X[i] = np.array(adjoint, C.dtype).reshape(B[i].shape) @ C[i] / determinant
    return Found(chart, reduced_basis(X, chart))


def qr(matrices: Matrices, request: Request) -> Found:
    """Householder QR of A^H: the last columns of Q."""
    Q, ranks, order = by_householder(matrices.scaled, request.threshold(matrices))
    rank = one_rank(ranks, matrices)
    return _charted(matrices, request, Q[:, :, rank:], np.sort(order[:, :rank], axis=1))


def svd(matrices: Matrices, request: Request) -> Found:
    """Singular value decomposition: the right singular vectors of those that are zero."""
    V, ranks = by_singular_values(matrices.scaled, request.threshold(matrices))
    rank, (m, _) = one_rank(ranks, matrices), matrices.shape
    rows = np.tile(np.arange(m), (len(V), 1))
    if rank < m:
        rows = np.sort(eliminated(matrices.scaled).rows[:, :rank], axis=1)
    return _charted(matrices, request, V[:, :, rank:], rows)


def _charted(matrices: Matrices, request: Request, Z: Array, rows: IndexArray) -> Found:
    """Columns for an orthonormal basis: those asked for or preferred, else well spread ones."""
    (k, n, d), given = Z.shape, request.independent
    if given is not None and len(given) != d:
        raise InputError(f"A has {n} columns and rank {n - d}: choose {d} independent columns, not {len(given)}")
    if given is not None:
        free = np.tile(np.array(given, np.intp), (k, 1))
    else:
        free = well_spread(Z)
        if request.prefer:
            free = preferred(reduced_of(Z, free), free, request.prefer)
        free = np.sort(free, axis=1)
    chart = Chart(free, others(free, n), rows)
    least = np.linalg.svd(rows_at(Z, free), compute_uv=False)[:, -1]
    weak = np.flatnonzero(least <= request.tolerance)
    if len(weak):
        raise refused(matrices, chart, int(weak[0]), request)
    Z = turned(Z, free)
    return Found(chart, reduced_of(Z, free), Z)


def _independent_part(matrices: Matrices, chart: Chart) -> Array:
    """C (k, r, d), rows scaled."""
    kept = np.take_along_axis(matrices.scaled, chart.rows[:, :, None], axis=1)
    return np.take_along_axis(kept, chart.independent[:, None, :], axis=2)


def reduced_basis(X: Array, chart: Chart) -> Array:
    """N with -X at the dependent columns and the identity at the independent ones."""
    k, r, d = X.shape
    N = np.zeros((k, r + d, d), X.dtype)
    every = np.arange(k)[:, None]
    N[every, chart.dependent] = -X
    N[every, chart.independent] = np.eye(d)
    return N


#: The methods by name; "compiled" is in `compiled`, which builds on these.
METHODS: Mapping[str, Callable[[Matrices, Request], Found]] = {
    "complete": complete,
    "lu": lu,
    "qr": qr,
    "svd": svd,
    "minors": minors,
}
