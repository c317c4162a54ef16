"""Derivatives of bases of the null space along a motion, A' = dA/dt.

From A N = 0 follows A N' = -A' N: N' is given up to columns of the null space, and each form has its own share.

    N  = [-B^-1 C; I]          N' = [-B^-1 A' N; 0]                                    `basis_rate`
    N~ = |B| N                 N~' = tr(B^-1 B') N~ + [-B^-1 A' N~; 0]                 `scaled_rate`
    N^ = N T                   N^' = N' T + N^ S, S strictly upper triangular          `orthogonal_rate`
    Z  = N R^-1                Z' = N' R^-1 - Z Phi(W + W^H), W = Z^H N' R^-1          `gram_schmidt_rate`
    Z, as still as it can be   Z' = -A^+ A' Z, with Z^H Z' = 0                         `orthonormal_rate`

The paper takes N' = -A^+ A' N for its reduced N [41]. That matrix solves the same equation, but its rows in the
independent places are not zero: it differs from N' by N times those rows. gamma = N' v made with it is no derivative
of q' = N v, and v'' solved with it is not that of the independent coordinates.

Units: those of the basis per unit of time. Entries of one graph can also be differentiated directly
(`nullbody.expr.directional`), which gives the same functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nullbody.errors import InputError, SingularityError
from nullbody.expr.matrix import Matrix, dot, matmul, total, transpose
from nullbody.nullspace.given import scalar_rows
from nullbody.nullspace.gram import orthogonal
from nullbody.nullspace.result import NullSpace
from nullbody.nullspace.scalar import is_zero, reciprocal
from nullbody.tolerances import EPS

if TYPE_CHECKING:
    from nullbody.nullspace.numeric import NullSpaceStack

__all__ = [
    "basis_rate",
    "delta_rate",
    "gram_schmidt_rate",
    "orthogonal_rate",
    "orthonormal_rate",
    "scaled_rate",
]

#: Z counts as an orthonormal basis of A's null space up to this: coarse enough for single precision.
_NO_BASIS = 1e-4

_Array = NDArray[Any]


def basis_rate(space: NullSpace | NullSpaceStack, A_dot: Any) -> Any:
    """N' = [-B^-1 A' N; 0], the derivative of the reduced basis; gamma = N' v of q'' = N v'' + gamma   [41 corrected].

    Args:
        space: the null space of A in any form, or those of a stack of arrays.
        A_dot: A' along the motion, m x n (k x m x n for a stack), scalars of A's kind.
            Rows of A that repeat others now must do so throughout the motion.

    Returns:
        n x d: rows of scalars, or an array where `space` is one of arrays. Rows in independent places are zero.

    Raises:
        InputError: A_dot has another shape, or entries that are not finite.
    """
    if not isinstance(space, NullSpace):
        return _stacked(basis_rate, space, A_dot)
    return _solved(space, _product(_rate(space, A_dot), _reduced(space)))


def delta_rate(space: NullSpace | NullSpaceStack, A_dot: Any) -> Any:
    """delta' = |B| tr(B^-1 B') (Jacobi's formula); arguments and errors as `basis_rate`."""
    if not isinstance(space, NullSpace):
        return _stacked(delta_rate, space, A_dot)
    return _relative_delta_rate(space, _rate(space, A_dot)) * space.delta


def scaled_rate(space: NullSpace | NullSpaceStack, A_dot: Any) -> Any:
    """N~' = tr(B^-1 B') N~ + [-B^-1 A' N~; 0], the derivative of N~ = |B| N; arguments and errors as `basis_rate`."""
    if not isinstance(space, NullSpace):
        return _stacked(scaled_rate, space, A_dot)
    rate, N = _rate(space, A_dot), _reduced(space)
    share, rest = _relative_delta_rate(space, rate), _solved(space, _product(rate, N))
    delta = space.delta
    if isinstance(N, np.ndarray):
        return delta * (share * N + rest)
    return tuple(
        tuple(delta * total((share * a, b)) if not is_zero(a) else delta * b for a, b in zip(*pair, strict=True))
        for pair in zip(N, rest, strict=True)
    )


def orthogonal_rate(N: Matrix, N_dot: Matrix) -> tuple[tuple[Any, ...], ...]:
    """N^' of the orthogonal basis N^ = N T (T unit upper triangular), from N and N'.

        N^' = X + N^ S,   X = N' T,   S_ij = -(W_ij + W_ji) / d_i for i < j,   W = N^^T X,   d_i = N^_i . N^_i

    S keeps N^^T N^ diagonal; the first column is N'_1.

    Args:
        N: n x d, independent columns of exact numbers, floats or expressions of a graph.
        N_dot: its derivative, for instance from `basis_rate`.

    Raises:
        InputError: sizes that differ, or columns that are not independent.
    """
    N, N_dot = (scalar_rows(rows, "N and its derivative must be rows of scalars") for rows in (N, N_dot))
    if [len(row) for row in N] != [len(row) for row in N_dot]:
        raise InputError("N and its derivative must have one shape")
    found, columns = transpose(orthogonal(N)), transpose(N)
    inverses = [reciprocal(dot(u, u)) for u in found]
    moved: list[list[Any]] = []
    for k, rate in enumerate(transpose(N_dot)):
        shares = [-(dot(found[j], columns[k]) * inverses[j]) for j in range(k)]
        moved.append(_sum(rate, shares, moved))
    result = []
    for k, column in enumerate(moved):
        shares = [-(total((dot(found[i], column), dot(found[k], moved[i]))) * inverses[i]) for i in range(k)]
        result.append(_sum(column, shares, found))
    return tuple(zip(*result, strict=True))


def gram_schmidt_rate(N: ArrayLike, N_dot: ArrayLike) -> _Array:
    """Z' of the orthonormal basis Z = N R^-1 with R upper triangular and its diagonal positive, from N and N'.

        Z' = N' R^-1 - Z Phi(W + W^H),   W = Z^H N' R^-1

    Phi takes the upper triangle, the diagonal halved: it is R' R^-1, the derivative of the Cholesky factor of
    N^H N = R^H R. Z is the form "orthonormal" of `null_space`, which is tied to its independent columns.

    Args:
        N: (n, d) or a stack (k, n, d), real or complex, columns independent.
        N_dot: its derivative, of the same shape, for instance from `basis_rate`.

    Raises:
        InputError: wrong shapes, entries that are not finite, or dependent columns.

    Source: for the factor, I. Murray, Differentiation of the Cholesky decomposition, arXiv:1602.07527, 2016.
    """
    N, N_dot = _finite(N, "N"), _finite(N_dot, "N_dot")
    if N.shape != N_dot.shape or N.ndim not in (2, 3):
        raise InputError(f"N and its derivative must be (n, d) or stacks (k, n, d), not {N.shape} and {N_dot.shape}")
    if N.shape[-2] < N.shape[-1]:
        raise InputError(f"{N.shape[-1]} columns of length {N.shape[-2]} are not independent")
    Q, R = np.linalg.qr(N)
    diagonal = np.diagonal(R, axis1=-2, axis2=-1)
    size = abs(diagonal)
    if N.size and (size <= EPS * np.linalg.norm(N, axis=-2)).any():
        raise InputError("the columns of N are dependent to rounding: no orthonormal basis is tied to them")
    phase = diagonal / size
    Z, R = Q * phase[..., None, :], R * phase.conj()[..., :, None]
    X = np.linalg.solve(R.swapaxes(-1, -2), N_dot.swapaxes(-1, -2)).swapaxes(-1, -2)
    W = Z.conj().swapaxes(-1, -2) @ X
    halved = np.triu(np.ones(W.shape[-2:])) - np.eye(W.shape[-1]) / 2
    return np.asarray(X - Z @ (halved * (W + W.conj().swapaxes(-1, -2))))


def orthonormal_rate(A: ArrayLike, A_dot: ArrayLike, Z: ArrayLike) -> _Array:
    """Z' = -A^+ A' Z: of all orthonormal bases that begin with Z, the one that turns least.

    A Z' = -A' Z and Z^H Z' = 0. No determinant enters: it is smooth wherever A keeps its rank, whichever columns are
    independent. It is no derivative of a function of the coordinates: after a closed path the basis may come back
    turned. The basis that a chart defines has the derivative `gram_schmidt_rate`.

    Args:
        A: (m, n) or a stack (k, m, n), real or complex; rows may repeat others.
        A_dot: its derivative, of the same shape.
        Z: (n, d) or (k, n, d), an orthonormal basis of the null space: d = n - rank A.

    Raises:
        InputError: wrong shapes, entries that are not finite, or Z is no orthonormal basis of A's null space.
        SingularityError: the rank of A drops here; its null space is larger than Z.

    Source: from the derivative of the projector I - A^+ A, G. H. Golub, V. Pereyra, SIAM Journal on Numerical
        Analysis 10 (1973) 413-432.
    """
    A, A_dot, Z = _finite(A, "A"), _finite(A_dot, "A_dot"), _finite(Z, "Z")
    fitting = A.ndim in (2, 3) and A.shape == A_dot.shape and Z.shape[:-1] == (*A.shape[:-2], A.shape[-1])
    if not fitting or Z.shape[-1] > A.shape[-1]:
        raise InputError(f"A, A' and Z must be (m, n), (m, n), (n, d), not {A.shape}, {A_dot.shape}, {Z.shape}")
    rank = A.shape[-1] - Z.shape[-1]
    if rank > A.shape[-2]:
        raise InputError(f"A has {A.shape[-2]} rows and rank {rank} at most {A.shape[-2]}: Z has too few columns")
    U, sizes, V = np.linalg.svd(A, full_matrices=False)
    largest = sizes[..., :1]
    drift = np.linalg.norm(A @ Z, axis=(-2, -1)) / np.where(largest[..., 0] > 0, largest[..., 0], 1)
    turn = np.linalg.norm(Z.conj().swapaxes(-1, -2) @ Z - np.eye(Z.shape[-1]), axis=(-2, -1))
    if (np.maximum(drift, turn) > _NO_BASIS).any():
        raise InputError(
            f"Z is no orthonormal basis of A's null space: |A Z| / |A| = {np.max(drift):.1g}, "
            f"|Z^H Z - I| = {np.max(turn):.1g}"
        )
    if (sizes[..., :rank] <= EPS * max(A.shape[-2:]) * largest).any():
        raise SingularityError(
            f"A has a rank below {rank} here: its null space has more than Z's {Z.shape[-1]} columns"
        )
    right = U[..., :rank].conj().swapaxes(-1, -2) @ (A_dot @ Z)
    return np.asarray(-V[..., :rank, :].conj().swapaxes(-1, -2) @ (right / sizes[..., :rank, None]))


def _stacked(derivative: Callable[[Any, Any], Any], spaces: NullSpaceStack, A_dot: Any) -> _Array:
    """The derivative for each matrix of a stack."""
    if not hasattr(spaces, "matrices"):
        raise InputError(f"expected what `null_space` returns, not {type(spaces).__name__}")
    rates = _finite(A_dot, "A_dot")
    if rates.ndim != 3 or len(rates) != len(spaces):
        raise InputError(f"A_dot must be a stack of {len(spaces)} matrices, not of shape {rates.shape}")
    return np.array([derivative(space, rate) for space, rate in zip(spaces, rates, strict=True)])


def _rate(space: NullSpace, A_dot: Any) -> Any:
    """A' in the shape of A: an array where the basis is one, else rows of scalars.

    Raises:
        InputError: another shape, or entries that are not finite.
    """
    m, n = len(space.rows) + len(space.redundant), space.shape[0]
    rate: Any
    shape: tuple[int, ...]
    if isinstance(space.reduced, np.ndarray):
        rate = _finite(A_dot, "A_dot")
        shape = rate.shape
    else:
        try:
            rate = [list(row) for row in (A_dot.tolist() if hasattr(A_dot, "tolist") else A_dot)]
        except TypeError:
            raise InputError(f"A_dot must have the shape of A, {m} x {n}: rows of scalars") from None
        shape = (len(rate), *{len(row) for row in rate})
        if any(isinstance(entry, float) and not math.isfinite(entry) for row in rate for entry in row):
            raise InputError("A_dot must be finite")
    if shape != (m, n):
        raise InputError(f"A_dot must have the shape of A, {m} x {n}, not {' x '.join(map(str, shape))}")
    return rate


def _reduced(space: NullSpace) -> Any:
    """N, as an array or as rows of scalars."""
    N = space.reduced
    return N if isinstance(N, np.ndarray) or not hasattr(N, "tolist") else N.tolist()


def _solved(space: NullSpace, right: Any) -> Any:
    """[-B^-1 c; 0] for every column c of the right-hand side."""
    if isinstance(right, np.ndarray):
        return np.stack([space.offset(c) for c in right.T], axis=1)
    return tuple(zip(*(space.offset(c) for c in transpose(right)), strict=True))


def _relative_delta_rate(space: NullSpace, rate: Any) -> Any:
    """tr(B^-1 B'), with the rows of B' that were used; the others are given what they have to be."""
    terms = []
    for j in space.dependent:
        column = [row[j] for row in rate]
        for i, factors in space.repeats.items():
            column[i] = total(factor * column[k] for k, factor in factors.items())
        if not all(is_zero(entry) for entry in column):
            terms.append(-space.offset(column)[j])
    return total(terms)


def _product(left: Any, right: Any) -> Any:
    return left @ right if isinstance(right, np.ndarray) else matmul(left, right)


def _sum(vector: Sequence[Any], factors: Sequence[Any], others: Sequence[Sequence[Any]]) -> list[Any]:
    """vector + sum_k factors[k] others[k]"""
    result = list(vector)
    for factor, other in zip(factors, others, strict=False):
        if not is_zero(factor):
            result = [a if is_zero(b) else total((a, factor * b)) for a, b in zip(result, other, strict=True)]
    return result


def _finite(given: ArrayLike, name: str) -> _Array:
    from nullbody.nullspace.numeric.equilibrate import finite_numbers

    return finite_numbers(given, name)[0]
