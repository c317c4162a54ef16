"""The basis N = [-B^-1 C; I] as a sparse matrix, from the factors, some columns at a time.

One step of refinement follows where a residual is above rounding. Entries are dropped where no row of A notices:

    |a_ki x_i| <= 4 eps sum_j |a_kj x_j|  for all rows k

which leaves the columns exact for a matrix that differs from A by rounding, entry by entry.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from nullbody.errors import InputError
from nullbody.nullspace.numeric.equilibrate import Array
from nullbody.nullspace.sparse.factor import Factors
from nullbody.nullspace.sparse.segment import largest
from nullbody.tolerances import EPS

__all__ = ["DENSE_ENTRIES", "orthogonal_columns", "reduced_basis", "tidied"]

#: Entries of a dense result that are affordable: 160 MB.
DENSE_ENTRIES = 20_000_000

#: Entries of a sparse result that are affordable: 1.6 GB.
_SPARSE_ENTRIES = 100_000_000

#: Entries of the columns that are worked on together.
_BLOCK = 2_000_000

#: Entries below this part of their column's largest may be rounding; the rows of A decide.
_SUSPICIOUS = 1e-9

#: Residuals |a_k x| up to this multiple of eps |a_k| |x| are rounding.
_REFINED_ABOVE = 2


def reduced_basis(matrix: Any, factors: Factors) -> Any:
    """N, n x d, CSC, with the identity in the independent places.

    Args:
        matrix: the CSR array that was factored.
        factors: of its used rows.

    Raises:
        InputError: N has more non-zero entries than fit into memory.
    """
    from scipy.sparse import csc_array, hstack

    used = matrix[factors.rows]
    n, d = factors.shape[1], len(factors.independent)
    size, blocks, count = abs(used), [], 0
    sums = size.sum(axis=1)
    by_columns = size.tocsc()
    width = max(1, _BLOCK // n)
    for start in range(0, d, width):
        x = factors.null_columns(np.arange(start, min(start + width, d)))
        _refine(used, sums, factors, x)
        x[factors.dependent] = tidied(size, by_columns, x)[factors.dependent]
        blocks.append(csc_array(x))
        count += blocks[-1].nnz
        if count > _SPARSE_ENTRIES:
            raise InputError(
                f"the basis of this {factors.shape[0]} x {n} matrix is not sparse: {start + len(x.T)} of its {d} "
                f"columns have {count:.1e} entries; choose other independent columns, or work with parts of A"
            )
    return hstack(blocks, format="csc") if len(blocks) > 1 else blocks[0]


def _refine(used: Any, sums: Array, factors: Factors, x: Array) -> None:
    """x -= B^-1 A x, where A x is above rounding."""
    residual = used @ x
    bound = _REFINED_ABOVE * EPS * sums[:, None] * abs(x).max(axis=0)
    if not (abs(residual) > bound).any():
        return
    right = np.zeros((factors.shape[0], x.shape[1]), x.dtype)
    right[factors.rows] = residual
    x -= factors.solve(right)


def tidied(size: Any, by_columns: Any, x: Array) -> Array:
    """x without the entries that no row of A notices.

    Args:
        size: |A|, CSR.
        by_columns: the same, CSC.
        x: n x p, changed in place.
    """
    weight = abs(x)
    i, k = np.nonzero((weight > 0) & (weight <= _SUSPICIOUS * weight.max(axis=0, initial=0)))
    if not len(i):
        return x
    starts, counts = by_columns.indptr[i], np.diff(by_columns.indptr)[i]
    ends = np.concatenate([[0], np.cumsum(counts)])
    entries = np.repeat(starts - ends[:-1], counts) + np.arange(ends[-1])
    sums = (size @ weight)[by_columns.indices[entries], np.repeat(k, counts)]
    noticed = by_columns.data[entries] * np.repeat(weight[i, k], counts) > 4 * EPS * sums
    silent = (largest(noticed.astype(float), ends) == 0) & (counts > 0)
    x[i[silent], k[silent]] = 0
    return x


def orthogonal_columns(basis: Any, normal: bool) -> Array:
    """Dense columns at right angles that span the same space, by Householder QR: N = Z R.

    Args:
        basis: N, n x d, sparse.
        normal: columns of length 1; otherwise Z diag(R) = N T, T unit upper triangular. The columns of both have the
            same directions, so that they change with A as N does.
    """
    from scipy.linalg import qr

    Z, R = qr(basis.toarray(), mode="economic", check_finite=False)
    diagonal = np.diagonal(R)
    return Z * (diagonal / abs(diagonal) if normal else diagonal)
