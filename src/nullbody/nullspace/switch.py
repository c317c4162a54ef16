"""When to change the independent columns at a state, and to which.

With an orthonormal basis Z of the null space of A at a point,

    N = Z Z[v]^-1,        largest singular value of N = 1 / smallest singular value of Z[v],

where Z[v] are the rows of the independent columns v. One singular value decomposition of A serves all choices of
columns, and keeps its accuracy however close to |B| = 0 some of them are.
"""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike

from nullbody.errors import InputError, SingularityError
from nullbody.nullspace.given import checked_columns
from nullbody.nullspace.numeric.equilibrate import Array, Matrices
from nullbody.nullspace.numeric.rank import relative_tolerance
from nullbody.tolerances import EPS
from nullbody.typing import FloatArray, IndexArray

__all__ = ["better_chart", "conditions", "orthonormal"]

_TIE = 1e-9  # relative: lengths that differ by less are equal, and the first of them is taken
_REPEATED = 1e-6  # relative: a singular value above belongs to a row that does not repeat others


def better_chart(values: ArrayLike, independent: Sequence[int], bound: float = 1e-13) -> tuple[int, ...]:
    """The independent columns to go on with at a state: those at hand while they are good enough, else good ones.

    Good enough: EPS times the largest singular value of N is within the bound. Otherwise columns are picked one by one
    where what is left of Z is longest: complete pivoting, not influenced by the scales of A's rows. The entries of N
    are small there, and its error is some EPS.

    Args:
        values: A at the state, m x n numbers; rows may repeat others.
        independent: the columns at hand.
        bound: the largest subspace error [rad] that is borne.

    Raises:
        InputError: no matrix of finite numbers, columns that are wrong or too few for its rank, or a bound that is no
            positive number.
        SingularityError: the rank of A itself drops at this state, so that no columns will do.
    """
    if isinstance(bound, bool) or not isinstance(bound, Real) or not bound > 0:
        raise InputError(f"bound is an angle [rad], a number above 0, not {bound!r}")
    matrices = Matrices.of(values)
    if not matrices.single:
        raise InputError(f"expected A at one state, m x n, not {len(matrices)} matrices")
    n = matrices.shape[1]
    chosen = checked_columns(independent, n, "independent")
    Z = orthonormal(matrices, n - len(chosen))[0]
    if Z is None:
        raise SingularityError(f"A loses rank at this state: it has not {n - len(chosen)} independent rows there")
    if chosen and EPS * conditions(Z, np.array([chosen]))[0] > bound:
        return _longest_rows(Z)
    return chosen


def orthonormal(matrices: Matrices, rank: int) -> list[Array | None]:
    """Z, n x (n - rank), for each matrix; None where its rank is lower.

    Raises:
        InputError: a rank is clearly higher.
    """
    n = matrices.shape[1]
    limit = relative_tolerance(matrices) * matrices.size
    found: list[Array | None] = []
    for matrix, least in zip(matrices.scaled, limit, strict=True):
        _, sizes, right = np.linalg.svd(matrix)
        if len(sizes) > rank and sizes[rank] > _REPEATED * sizes[0]:
            raise InputError(f"A has a rank above {rank}: {n - rank} independent columns are too many")
        short = rank and (len(sizes) < rank or sizes[rank - 1] <= least)
        found.append(None if short else right[rank:].conj().T)
    return found


def conditions(Z: Array, choices: IndexArray) -> FloatArray:
    """The largest singular value of N for each choice of independent columns (k, d); infinite where |B| is rounding."""
    smallest = np.linalg.svd(Z[choices], compute_uv=False)[:, -1].astype(float)
    with np.errstate(divide="ignore"):
        return np.where(smallest > len(Z) * np.finfo(Z.dtype).eps, 1 / smallest, np.inf)


def _longest_rows(Z: Array) -> tuple[int, ...]:
    """d rows of Z, each the longest of what those before it leave (pivoted Gram-Schmidt)."""
    left, found = Z, []
    for _ in range(Z.shape[1]):
        lengths = np.linalg.norm(left, axis=1)
        row = int(np.argmax(lengths >= (1 - _TIE) * lengths.max()))
        direction = left[row] / lengths[row]
        left = left - np.outer(left @ direction.conj(), direction)
        found.append(row)
    return tuple(sorted(found))
