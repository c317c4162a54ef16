"""The basis of a sparse null space as a function of A's entries, in one chart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np
from numpy.typing import ArrayLike

from nullbody.errors import InputError
from nullbody.kernels import Kernel, Program, compile_programs
from nullbody.nullspace.numeric.equilibrate import Array
from nullbody.nullspace.result import Form
from nullbody.nullspace.sparse.basis import orthogonal_columns
from nullbody.nullspace.sparse.replay import replayed
from nullbody.typing import FloatArray, IndexArray

if TYPE_CHECKING:
    from nullbody.nullspace.sparse.result import SparseNullSpace

__all__ = ["MOST_OPERATIONS", "SparseFunction"]

#: Operations up to which a basis is compiled: some seconds, once; the code is kept in the cache.
MOST_OPERATIONS = 20_000

#: |A N| relative to |A| |N| above which fixed pivots are not trusted.
_TRUSTED = 1e-13


@final
@dataclass(frozen=True, repr=False, eq=False)
class SparseFunction:
    """f(A) -> basis, for matrices with entries in the same places, with the same independent columns.

    Real matrices that need at most `MOST_OPERATIONS` get a compiled straight-line program with the pivots of the
    matrix that it was made from. Where those pivots do not suit (|A N| says so), where the rank may have risen, and for
    larger matrices, A is eliminated anew.

    Attributes:
        form: the form of the basis.
        independent: the columns that are free, in the order of the basis's columns.
        shape: of A.
        places: i n + j of every entry A[i, j], increasing.
        compiled: whether there is a compiled program.
    """

    form: Form
    independent: tuple[int, ...]
    shape: tuple[int, int]
    places: IndexArray
    _program: _Straight | None

    @classmethod
    def of(cls, space: SparseNullSpace) -> SparseFunction:
        """Compile what is small enough.

        Raises:
            CacheError: the cache cannot be written or trusted; NULLBODY_CACHE=off does without.
        """
        given = space._given
        program = None
        if space.form != "scaled" and given.matrix.dtype.kind == "f" and len(given.places) <= MOST_OPERATIONS:
            program = _Straight.of(space)
        return cls(space.form, space.independent, given.shape, given.places, program)

    @property
    def compiled(self) -> bool:
        """Whether there is a compiled program."""
        return self._program is not None

    def __call__(self, A: Any) -> Any:
        """The basis for other entries: a CSC array in the forms "reduced" and "scaled", otherwise a dense array.

        Args:
            A: a sparse matrix (m, n), or the numbers in `places` (row by row, columns increasing).

        Raises:
            InputError: another shape, entries in other places, numbers that are not finite, another rank.
            SingularityError: |B| = 0; the message names columns that would do.
        """
        from nullbody.nullspace.sparse.call import sparse_null_space

        data = self._data(A)
        if self._program is not None and data.dtype.kind == "f":
            N = self._program(data)
            if N is not None:
                return N if self.form == "reduced" else orthogonal_columns(N, self.form == "orthonormal")
        matrix = self._matrix(data)
        return sparse_null_space(matrix, self.independent, self.form).basis

    def __repr__(self) -> str:
        m, n = self.shape
        how = "compiled" if self.compiled else "eliminates anew"
        return f"<SparseFunction ({m} x {n}, {len(self.places)} entries) -> {self.form} basis, {how}>"

    def _data(self, A: Any) -> Array:
        """The numbers in `places`."""
        from scipy.sparse import csr_array, issparse

        if not issparse(A):
            return self._numbers(A)
        if A.shape != self.shape:
            raise InputError(f"A must be {self.shape[0]} x {self.shape[1]}, not of shape {A.shape}")
        matrix = csr_array(A, copy=True)
        matrix.sum_duplicates()
        coordinates = matrix.tocoo()
        places = coordinates.row.astype(np.intp) * self.shape[1] + coordinates.col
        found = np.searchsorted(self.places, places)
        known = np.append(self.places, -1)[found] == places
        strange = np.flatnonzero(~known & (matrix.data != 0))
        if len(strange):
            i, j = divmod(int(places[strange[0]]), self.shape[1])
            raise InputError(
                f"A[{i}, {j}] was not an entry of the matrix of this function ({len(strange)} such entries)"
            )
        data = np.zeros(len(self.places), matrix.dtype)
        data[found[known]] = matrix.data[known]
        return self._numbers(data)

    def _numbers(self, given: ArrayLike) -> Array:
        data = np.asarray(given)
        if data.shape != self.places.shape or data.dtype.kind not in "biufc":
            raise InputError(f"the entries must be {len(self.places)} numbers, not shape {data.shape} of {data.dtype}")
        if not np.isfinite(data).all():
            bad = int(np.flatnonzero(~np.isfinite(data))[0])
            i, j = divmod(int(self.places[bad]), self.shape[1])
            raise InputError(f"A[{i}, {j}] must be finite, not {data[bad]}")
        return data.astype(np.complex128 if data.dtype.kind == "c" else np.float64)

    def _matrix(self, data: Array) -> Any:
        from scipy.sparse import csr_array

        return csr_array((data, np.divmod(self.places, self.shape[1])), shape=self.shape)


@dataclass(frozen=True)
class _Straight:
    """The reduced basis as a straight-line program, with fixed pivots.

    Attributes:
        kernel: from the entries of A to those of N's dependent rows.
        order, starts, indices: where those and the ones of the independent rows go in a CSC array.
        shape: of N.
        rows, columns: of the entries of A.
    """

    kernel: Kernel
    order: IndexArray
    starts: IndexArray
    indices: IndexArray
    shape: tuple[int, int]
    rows: IndexArray
    columns: IndexArray
    lines: int

    @classmethod
    def of(cls, space: SparseNullSpace) -> _Straight | None:
        """None if there is nothing to evaluate, or too much."""
        found = replayed(space._given.places, space._factors, MOST_OPERATIONS)
        if found is None or not found[1]:
            return None
        names, entries = found
        from nullbody.expr import Tape

        tape = Tape.of([entry for _, _, entry in entries], names)
        if tape.operations.arithmetic > MOST_OPERATIONS:
            return None
        program = Program("sparse_null_space", (("a", len(names)),), (("N", (len(entries),)),), tape)
        kernel = compile_programs([program]).kernels["sparse_null_space"]
        m, n = space._given.shape
        place_of = np.argsort(space._places)  # the k-th independent column in increasing order comes at this place
        d = len(place_of)
        i = np.array([entry[0] for entry in entries] + list(space.independent))
        k = np.concatenate([place_of[[entry[1] for entry in entries]], np.arange(d)])
        order = np.lexsort((i, k))
        starts = np.concatenate([[0], np.cumsum(np.bincount(k, minlength=d))])
        rows, columns = np.divmod(space._given.places, n)
        return cls(kernel, order, starts, i[order], (n, d), rows, columns, m)

    def __call__(self, data: FloatArray) -> Any:
        """N as a CSC array, or None where the pivots do not suit these numbers."""
        from scipy.sparse import csc_array, csr_array

        with np.errstate(all="ignore"):
            values = np.concatenate([self.kernel(data)[0], np.ones(self.shape[1])])[self.order]
            if not np.isfinite(values).all():
                return None
            N = csc_array((values, self.indices, self.starts), shape=self.shape)
            A = csr_array((data, (self.rows, self.columns)), shape=(self.lines, self.shape[0]))
            residual = abs(A @ N)
            bound = _TRUSTED * abs(A).sum(axis=1) * abs(values).max()
            suits = (residual.max(axis=1).toarray() <= bound).all() if residual.nnz else True
        return N if suits else None
