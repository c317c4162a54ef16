"""Null spaces of a stack of matrices (k, m, n) of one rank: arrays with the stack's index first."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, final, overload

import numpy as np
from numpy.typing import ArrayLike

from nullbody.errors import InputError, UnknownName
from nullbody.nullspace.numeric.chart import Chart, dependent_part
from nullbody.nullspace.numeric.determinant import determinants
from nullbody.nullspace.numeric.equilibrate import Array, Matrices, finite_numbers, shifted
from nullbody.nullspace.numeric.method import Found
from nullbody.nullspace.numeric.orthonormal import orthonormalised, rows_at
from nullbody.nullspace.numeric.rank import CLEAR, combinations, others, singular_values
from nullbody.nullspace.result import FORMS, Form
from nullbody.tolerances import EPS
from nullbody.typing import FloatArray, IndexArray

if TYPE_CHECKING:
    from nullbody.nullspace.numeric.result import ArrayNullSpace

__all__ = ["NullSpaceStack"]

#: Errors measured against exact arithmetic, in regular and nearly singular charts, with nearly dependent rows and with
#: badly scaled rows and columns, were at most 1.4 times eps (condition + s_1 / s_r), typically 0.1 to 0.4 times.
_ERROR_FACTOR = 3

#: The error, relative to the condition, that the judgement of compiled results may let pass.
_LET_PASS = 1e-14

#: How far c of a redundant row may be from what it repeats, in tolerances.
_CONSISTENT = 1e3


@final
@dataclass(frozen=True, eq=False, repr=False)
class NullSpaceStack:
    """Null spaces of the k matrices of a stack, all of one rank r; d = n - r.

    Arrays are read-only and have the type of the matrices (float32 stays float32), figures are doubles. Columns and
    rows may differ from matrix to matrix. `stack[i]` is the null space of matrix i, `stack[a:b]` a part.

    Attributes:
        form: which of `nullbody.nullspace.result.FORMS` `basis` has.
        method: how it was found.
    """

    form: Form
    method: str
    _matrices: Matrices
    _found: Found
    _tolerance: float

    def __len__(self) -> int:
        return len(self._matrices)

    @overload
    def __getitem__(self, index: int) -> ArrayNullSpace: ...
    @overload
    def __getitem__(self, index: slice) -> NullSpaceStack: ...
    def __getitem__(self, index: int | slice) -> ArrayNullSpace | NullSpaceStack:
        from nullbody.nullspace.numeric.result import ArrayNullSpace

        if isinstance(index, slice):
            return self._part(index)
        i = range(len(self))[index]
        return ArrayNullSpace.of(self._part(slice(i, i + 1)))

    def __iter__(self) -> Iterator[ArrayNullSpace]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        n, d = self.shape
        figures = ""
        if len(self):
            figures = f", worst condition {self.condition.max():.3g}"
            if self.form in ("orthogonal", "orthonormal"):
                figures = f", largest subspace error {self.subspace_error.max():.0e}"
            if self.gap.min() < CLEAR:
                figures += f", rank in doubt: gap {self.gap.min():.2g} in matrix {self.gap.argmin()}"
        return f"<NullSpaceStack {len(self)} x {self.form} {n} x {d}, rank {self.rank}, by {self.method}{figures}>"

    def _part(self, which: slice) -> NullSpaceStack:
        chart, Z = self._found.chart, self._found.orthonormal
        part = Chart(chart.independent[which], chart.dependent[which], chart.rows[which])
        found = Found(part, self._found.reduced[which], None if Z is None else Z[which])
        return NullSpaceStack(self.form, self.method, self._matrices.at(which), found, self._tolerance)

    @property
    def matrices(self) -> Array:
        """The matrices themselves (k, m, n), as doubles or complex doubles."""
        return _frozen(shifted(self._matrices.scaled, self._matrices.exponents[:, :, None]))

    @property
    def rank(self) -> int:
        """The rank of every matrix."""
        return self._found.chart.rows.shape[1]

    @property
    def shape(self) -> tuple[int, int]:
        """(n, d) of every basis."""
        _, n, d = self._found.reduced.shape
        return n, d

    @property
    def independent(self) -> IndexArray:
        """k x d: the columns that are free, in the order of the bases' columns."""
        return _frozen(self._found.chart.independent)

    @property
    def dependent(self) -> IndexArray:
        """k x r: the other columns, increasing."""
        return _frozen(self._found.chart.dependent)

    @property
    def rows(self) -> IndexArray:
        """k x r: independent rows that were used."""
        return _frozen(self._found.chart.rows)

    @cached_property
    def redundant(self) -> IndexArray:
        """k x (m - r): rows that repeat others."""
        return _frozen(others(self._found.chart.rows, self._matrices.shape[0]))

    @cached_property
    def delta(self) -> Array:
        """|B| (k,) of B = A[rows][:, dependent]; infinite or 0 where that is outside the range of the type."""
        with np.errstate(over="ignore", under="ignore"):
            return _frozen(self._delta.astype(self._matrices.dtype))

    @cached_property
    def _delta(self) -> Array:
        exponents = np.take_along_axis(self._matrices.exponents, self._found.chart.rows, axis=1)
        return determinants(dependent_part(self._matrices, self._found.chart), exponents)

    @property
    def basis(self) -> Array:
        """The bases in the form that was asked for, k x n x d; errors as `in_form`."""
        return self.in_form(self.form)

    def in_form(self, form: Form) -> Array:
        """The bases in one of the forms, k x n x d.

        Raises:
            UnknownName: there is no such form.
            InputError: the form is "scaled" and |B| or N~ leaves the range of the type.
        """
        if form not in tuple(FORMS):
            raise UnknownName("form", form, FORMS)
        if form not in self._bases:
            self._bases[form] = self._made(form)
        return self._bases[form]

    @cached_property
    def _bases(self) -> dict[Form, Array]:
        return {}

    def _made(self, form: Form) -> Array:
        if form == "reduced":
            return self._typed(self._found.reduced)
        if form == "scaled":
            return self._scaled()
        Z, lengths = self._orthogonal
        return self._typed(Z if form == "orthonormal" else Z * lengths[:, None, :])

    def _scaled(self) -> Array:
        """N~ = |B| N."""
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            result = self._typed(self._delta[:, None, None] * self._found.reduced)
        bad = np.flatnonzero((self.delta == 0) | ~np.isfinite(result).all(axis=(1, 2)))
        if len(bad):
            raise InputError(
                f"N~ = |B| N of {self._matrices.name(bad[0])} leaves the range of {self._matrices.dtype} (|B| = "
                f"{self._delta[bad[0]]:.3g}): scale A's rows, or take the form 'reduced'"
            )
        return result

    @cached_property
    def _orthogonal(self) -> tuple[Array, FloatArray]:
        """(Z, lengths) with N^ = Z diag(lengths)."""
        found = self._found
        if found.orthonormal is None:
            return orthonormalised(found.reduced)
        corner = rows_at(found.orthonormal, found.chart.independent)
        return found.orthonormal, 1 / np.diagonal(corner, axis1=1, axis2=2).real

    @cached_property
    def condition(self) -> FloatArray:
        """(k,): the largest singular value of N = [-B^-1 C; I], 1 at best."""
        N = self._found.reduced
        return _frozen(np.ones(len(N)) if 0 in N.shape else np.linalg.norm(N, 2, axis=(1, 2)))

    @cached_property
    def subspace_error(self) -> FloatArray:
        """(k,): the angle [rad] by which rounding turns the subspaces: 3 eps (condition + s_1 / s_r).

        s are singular values of A with scaled rows; s_1 / s_r is large where rows nearly repeat others. For "qr" and
        "svd" in the orthogonal forms the condition does not enter. Of "compiled", 1e-14 condition may have been let
        pass. float32 adds the rounding of its digits.
        """
        if not self.rank:
            return _frozen(np.zeros(len(self)))
        s, condition = self._singular_values, self.condition
        direct = self._found.orthonormal is not None and self.form in ("orthogonal", "orthonormal")
        error = _ERROR_FACTOR * EPS * (s[:, 0] / s[:, self.rank - 1] + (0 if direct else condition))
        if self.method == "compiled":
            error = np.maximum(error, _LET_PASS * condition)
        eps = float(np.finfo(self._matrices.dtype).eps)
        rounding = eps * (1 if direct else condition) if eps > EPS else 0.0
        return _frozen(np.minimum(error + rounding, np.pi / 2))

    @cached_property
    def gap(self) -> FloatArray:
        """(k,): how clear the ranks are; below 1e3 they are in doubt.

        The smallest singular value that counts, over the tolerance (both of A with scaled rows); where a tolerance was
        given and a value above rounding was dropped, at most the tolerance over that one.
        """
        s, r, size = self._singular_values, self.rank, self._matrices.size
        threshold = self._tolerance * size
        gap = s[:, r - 1] / threshold if r else np.full(len(self), np.inf)
        if r < s.shape[1]:
            dropped = s[:, r]
            above = dropped > float(np.finfo(self._matrices.dtype).eps) * max(*self._matrices.shape, 10) * size
            gap = np.where(above, np.minimum(gap, threshold / np.where(above, dropped, 1)), gap)
        return _frozen(gap)

    @cached_property
    def _singular_values(self) -> FloatArray:
        return singular_values(self._matrices.scaled)

    @cached_property
    def combinations(self) -> Array:
        """K, k x (m - r) x r: the redundant rows are K times the rows used; rounding is set to 0."""
        exponents, rows = self._matrices.exponents, self._found.chart.rows
        e_redundant = np.take_along_axis(exponents, self.redundant, axis=1)
        e_rows = np.take_along_axis(exponents, rows, axis=1)
        return _frozen(shifted(self._combinations, e_redundant[:, :, None] - e_rows[:, None, :]))

    @cached_property
    def _combinations(self) -> Array:
        return combinations(self._matrices.scaled, self._found.chart.rows, self.redundant, self._tolerance)

    def offset(self, c: ArrayLike) -> Array:
        """gamma (k, n) with A gamma + c = 0 and zeros in the independent places: gamma = [-B^-1 c; 0].

        Args:
            c: one vector (m,) for all matrices, or one for each (k, m).

        Raises:
            InputError: the wrong shape, no finite numbers, or a redundant row that c does not repeat.
        """
        values, dtype = finite_numbers(c, "c")
        k, (m, n) = len(self), self._matrices.shape
        if values.shape not in ((m,), (k, m)):
            raise InputError(f"c must have the shape ({m},) or ({k}, {m}), not {values.shape}")
        scaled = shifted(np.broadcast_to(values, (k, m)), -self._matrices.exponents)
        chart = self._found.chart
        right = np.take_along_axis(scaled, chart.rows, axis=1)
        self._require_consistent(scaled, right)
        B = dependent_part(self._matrices, chart)
        gamma = np.zeros((k, n), np.result_type(B, right))
        solved = np.linalg.solve(B, right[:, :, None])[:, :, 0]
        gamma[np.arange(k)[:, None], chart.dependent] = -solved
        complex_numbers = dtype.kind == "c" and self._matrices.dtype.kind == "f"
        return self._typed(gamma, np.result_type(self._matrices.dtype, np.complex64) if complex_numbers else None)

    def _require_consistent(self, scaled: Array, right: Array) -> None:
        """Raise where c of a redundant row is not the combination of the others that the row itself is."""
        if not self.redundant.size:
            return
        found = np.take_along_axis(scaled, self.redundant, axis=1)
        due = np.einsum("kij,kj->ki", self._combinations, right)
        largest = abs(scaled).max(axis=1, initial=0)[:, None] * (1 + abs(self._combinations).sum(axis=2))
        bad = np.argwhere(abs(found - due) > _CONSISTENT * self._tolerance * largest)
        if not len(bad):
            return
        i, j = bad[0]
        row = self.redundant[i, j]
        unit = 2.0 ** np.clip(self._matrices.exponents[i, row], -1000, 1000)
        raise InputError(
            f"c is not consistent, so that A gamma + c = 0 has no solution: row {row} of {self._matrices.name(i)} "
            f"repeats rows {self.rows[i].tolist()}, which makes c[{row}] = {due[i, j] * unit:.9g}, not "
            f"{found[i, j] * unit:.9g} ({abs(found[i, j] - due[i, j]) * unit:.1e} off)"
        )

    def _typed(self, array: Array, dtype: Any = None) -> Array:
        return _frozen(array.astype(self._matrices.dtype if dtype is None else dtype))


def _frozen(array: Any) -> Any:
    """The array, or a view of it, that cannot be written to."""
    view = np.asarray(array).view()
    view.flags.writeable = False
    return view
