"""How redundant rows of a sparse matrix repeat others: y^T B = a in the dependent columns."""

from __future__ import annotations

from typing import Any

import numpy as np

from nullbody.nullspace.numeric.equilibrate import shifted
from nullbody.nullspace.sparse.basis import tidied
from nullbody.nullspace.sparse.factor import Factors
from nullbody.typing import IndexArray

__all__ = ["repeated_rows"]

#: Entries of the rows that are worked on together.
_BLOCK = 2_000_000


def repeated_rows(
    matrix: Any, exponents: IndexArray, factors: Factors, redundant: IndexArray
) -> dict[int, dict[int, Any]]:
    """For each redundant row i the numbers y with A[i] = sum_k y[k] A[k], over rows k that were used.

    Coefficients that are rounding, in that no column of A notices them, are left out.

    Args:
        matrix: CSR array with scaled rows.
        exponents: of the rows.
        factors: of the used rows.
        redundant: the rows.
    """
    used = matrix[factors.rows]
    size = abs(used).T.tocsr()
    by_rows = size.tocsc()
    found: dict[int, dict[int, Any]] = {}
    width = max(1, _BLOCK // max(matrix.shape))
    for start in range(0, len(redundant), width):
        chosen = redundant[start : start + width]
        y = factors.transposed(matrix[chosen].T.toarray())[0]
        y = tidied(size, by_rows, y[factors.rows])
        for column, i in enumerate(chosen):
            places = np.flatnonzero(y[:, column])
            others = factors.rows[places]
            coefficients = shifted(y[places, column], exponents[i] - exponents[others])
            found[int(i)] = dict(zip(others.tolist(), coefficients.tolist(), strict=True))
    return found
