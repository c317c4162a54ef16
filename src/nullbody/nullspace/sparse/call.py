"""The null space of a sparse matrix: read it, choose rows and columns, factor."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from nullbody.errors import InputError, UnknownName
from nullbody.nullspace.result import FORMS, Form
from nullbody.nullspace.sparse.chart import in_chart, preferred
from nullbody.nullspace.sparse.elimination import eliminated
from nullbody.nullspace.sparse.read import Scaled, columns_of, relative_tolerance
from nullbody.nullspace.sparse.result import SparseNullSpace

__all__ = ["sparse_null_space"]

#: What `method` may be; there is one.
_METHODS = ("auto", "sparse")


def sparse_null_space(
    A: Any,
    independent: Sequence[int] | None = None,
    form: Form = "reduced",
    method: str = "auto",
    *,
    prefer: Sequence[int] | None = None,
    tolerance: float | None = None,
) -> SparseNullSpace:
    """The null space of a SciPy sparse matrix, up to some 10^4 columns.

    Args:
        A: m x n, real or complex, any format; rows may repeat others. No rows: N is the identity.
        independent: the d = n - rank columns that stay free; by default the elimination chooses well-conditioned ones.
        form: "reduced" and "scaled" bases are sparse, "orthogonal" and "orthonormal" ones dense.
        method: "auto" or "sparse": threshold Markowitz elimination with a dense end.
        prefer: columns in the order in which they should become independent, as far as they can.
        tolerance: what counts as zero in a row, relative to the largest entry that it had during the elimination;
            30 eps max(m, n) by default.

    Raises:
        InputError: entries that are no finite numbers, no columns, wrong columns, only 0 in the null space, a dense
            form of more than 2 10^7 entries, a scaled form whose determinant is outside the range of doubles.
        SingularityError: the chosen columns leave |B| = 0; the message names columns that would do.
    """
    if form not in FORMS:
        raise UnknownName("form", form, FORMS, place="null_space")
    if method not in _METHODS:
        raise UnknownName("method", method, _METHODS, place="null_space of a sparse matrix (A.toarray() has others)")
    if independent is not None and prefer is not None:
        raise InputError("give the independent columns or a preference among columns, not both")
    given = Scaled.of(A)
    m, n = given.shape
    limit = relative_tolerance((m, n), tolerance)
    chosen = None if independent is None else columns_of(independent, n, "independent")
    if chosen is not None:
        factors = in_chart(given.matrix, chosen, limit)
    elif prefer is not None and len(wanted := columns_of(prefer, n, "preferred")):
        factors = preferred(given.matrix, wanted, limit)
    else:
        factors = eliminated(given.matrix, limit).factors
    if len(factors.rows) == n:
        raise InputError(f"only 0 is in the null space: A has rank {n}, as many as columns")
    if chosen is None:
        chosen = factors.independent
    space = SparseNullSpace(
        form,
        "sparse elimination",
        tuple(chosen.tolist()),
        tuple(factors.dependent.tolist()),
        tuple(factors.rows.tolist()),
        tuple(np.setdiff1d(np.arange(m), factors.rows).tolist()),
        given,
        factors,
        tuple(np.searchsorted(factors.independent, chosen).tolist()),
        limit,
    )
    space.check(form)
    return space
