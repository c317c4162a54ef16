"""A sparse matrix as it is worked on: doubles in compressed rows, each row scaled by a power of two.

A null space does not change when rows of A are scaled; ranks, pivots and overflow do. So every row is brought to a
largest entry in [1/2, 1), exactly: only its exponent changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from nullbody.errors import InputError
from nullbody.nullspace.numeric.equilibrate import shifted
from nullbody.nullspace.sparse.segment import largest, lines
from nullbody.tolerances import EPS
from nullbody.typing import IndexArray

__all__ = ["Scaled", "columns_of", "relative_tolerance"]

#: Integers up to here are doubles.
_LARGEST_INTEGER = 2**53


@dataclass(frozen=True)
class Scaled:
    """A sparse matrix with scaled rows.

    Attributes:
        matrix: CSR array (m, n); row i of A times 2^-exponents[i].
        exponents: (m,).
        places: i n + j of every stored entry A[i, j], increasing; stored zeros count.
    """

    matrix: Any
    exponents: IndexArray
    places: IndexArray

    @classmethod
    def of(cls, A: Any) -> Scaled:
        """Read a SciPy sparse matrix of any format; entries given twice are added, zeros left out.

        Raises:
            InputError: no columns, entries that are no numbers, not finite, or integers above 2^53.
        """
        from scipy.sparse import csr_array, issparse

        if not issparse(A) or len(A.shape) != 2:
            what = f"of shape {A.shape}" if issparse(A) else f"a {type(A).__name__}"
            raise InputError(f"A must be a SciPy sparse matrix (m, n), not {what}")
        if A.shape[1] == 0:
            raise InputError(f"A is {A.shape[0]} x 0: without columns there are no unknowns")
        matrix = csr_array(A, copy=True)
        if matrix.dtype.kind not in "biufc":
            raise InputError(f"A must hold real or complex numbers, not {matrix.dtype}")
        if matrix.dtype.kind in "iu" and matrix.nnz and abs(matrix).max() > _LARGEST_INTEGER:
            raise InputError("A holds integers above 2^53, which doubles round: give rows of int for an exact result")
        with np.errstate(over="ignore", invalid="ignore"):
            matrix = matrix.astype(np.complex128 if matrix.dtype.kind == "c" else np.float64)
            matrix.sum_duplicates()
        bad = np.flatnonzero(~np.isfinite(matrix.data))
        if len(bad):
            place = f"A[{lines(matrix)[bad[0]]}, {matrix.indices[bad[0]]}]"
            raise InputError(f"{place} must be finite, not {matrix.data[bad[0]]} ({len(bad)} such entries)")
        places = lines(matrix) * matrix.shape[1] + matrix.indices
        matrix.eliminate_zeros()
        size = largest(np.maximum(abs(matrix.data.real), abs(matrix.data.imag)), matrix.indptr)
        exponents = np.frexp(size)[1].astype(np.intp)
        matrix.data = shifted(matrix.data, -exponents[lines(matrix)])
        return cls(matrix, exponents, places)

    @property
    def shape(self) -> tuple[int, int]:
        """(m, n)"""
        m, n = self.matrix.shape
        return int(m), int(n)


def columns_of(given: Sequence[int], n: int, kind: str) -> IndexArray:
    """Distinct column numbers.

    Raises:
        InputError: they are not.
    """
    try:
        columns = list(given)
    except TypeError:
        raise InputError(f"{kind} columns must be a list of column numbers, not {given!r}") from None
    whole = all(hasattr(j, "__index__") and not isinstance(j, bool) and 0 <= j < n for j in columns)
    if not whole or len(set(columns)) != len(columns):
        shown = columns if len(columns) <= 12 else f"[{', '.join(map(repr, columns[:5]))}, ...] ({len(columns)})"
        raise InputError(f"{kind} columns must be distinct and in 0..{n - 1}, not {shown}")
    return np.array(columns, np.intp)


def relative_tolerance(shape: tuple[int, int], given: float | None) -> float:
    """What counts as zero in a row, relative to the largest entry that it had; 30 eps max(m, n) by default.

    Raises:
        InputError: the given one is not in 0..1.
    """
    if given is None:
        return 30 * EPS * max(shape)
    if not 0 < given < 1:
        raise InputError(f"the tolerance is relative: a number above 0 and below 1, not {given!r}")
    return float(given)
