"""How redundant rows of a sparse matrix repeat others: y^T B = a in the dependent columns."""

from __future__ import annotations

from typing import Any

import numpy as np

from nullbody.nullspace.numeric.equilibrate import shifted
from nullbody.nullspace.sparse.factor import Factors
from nullbody.nullspace.sparse.read import Scaled
from nullbody.typing import IndexArray

__all__ = ["repeated_rows"]

#: Entries of the rows that are worked on together.
_BLOCK = 2_000_000


def repeated_rows(
    given: Scaled, factors: Factors, redundant: IndexArray, tolerance: float
) -> dict[int, dict[int, Any]]:
    """For each redundant row i the numbers y with A[i] = sum_k y[k] A[k], over rows k that were used.

    Args:
        given: A.
        factors: of the used rows.
        redundant: the rows.
        tolerance: coefficients of scaled rows up to this part of the largest are rounding, and left out.
    """
    matrix, exponents = given.matrix, given.exponents
    found: dict[int, dict[int, Any]] = {}
    width = max(1, _BLOCK // max(matrix.shape))
    for start in range(0, len(redundant), width):
        chosen = redundant[start : start + width]
        y = factors.transposed(matrix[chosen].T.toarray())[0][factors.rows]
        kept = abs(y) > tolerance * abs(y).max(axis=0, initial=0)
        for column, i in enumerate(chosen):
            places = np.flatnonzero(kept[:, column])
            others = factors.rows[places]
            coefficients = shifted(y[places, column], exponents[i] - exponents[others])
            found[int(i)] = dict(zip(others.tolist(), coefficients.tolist(), strict=True))
    return found
