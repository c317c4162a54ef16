"""The null space of a sparse matrix: factors of the chosen rows and columns, and what follows from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from types import MappingProxyType
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from nullbody.errors import InputError, UnknownName
from nullbody.expr import Operations
from nullbody.nullspace.numeric.equilibrate import Array, shifted
from nullbody.nullspace.result import FORMS, Form, NullSpace
from nullbody.nullspace.sparse.basis import DENSE_ENTRIES, orthogonal_columns, reduced_basis
from nullbody.nullspace.sparse.condition import largest_of_basis, largest_of_inverse
from nullbody.nullspace.sparse.determinant import Determinant
from nullbody.nullspace.sparse.factor import Factors
from nullbody.nullspace.sparse.read import Scaled
from nullbody.nullspace.sparse.repeat import repeated_rows
from nullbody.tolerances import EPS

__all__ = ["SparseNullSpace"]

#: Entries of a basis that can be read as symbols or LaTeX.
_CONSISTENT = 1e3  # times the tolerance: what A gamma + c may leave
_READABLE = 400


@final
@dataclass(frozen=True, repr=False, eq=False)
class SparseNullSpace(NullSpace):
    """The null space of a sparse matrix; attributes as `NullSpace`.

    The basis is a CSC array in the forms "reduced" and "scaled", a dense array in the forms "orthogonal" and
    "orthonormal". Nothing of it is made before it is asked for; `move` and `offset` need the factors only.
    """

    _given: Scaled
    _factors: Factors
    _places: tuple[int, ...]
    _tolerance: float

    def in_form(self, form: Form) -> Any:
        """The basis in one of the forms, n x d: CSC array if "reduced" or "scaled", else a dense array.

        Raises:
            UnknownName: there is no such form.
            InputError: the basis does not fit into memory, or delta is outside the range of doubles ("scaled").
        """
        self.check(form)
        if form not in self._bases:
            self._bases[form] = self._made(form)
        return self._bases[form]

    def check(self, form: Form) -> None:
        """Raise the errors of `in_form` that can be told before anything is made."""
        n, d = self.shape
        if form not in tuple(FORMS):
            raise UnknownName("form", form, FORMS)
        if form in ("orthogonal", "orthonormal") and n * d > DENSE_ENTRIES:
            raise InputError(
                f"the {form} basis is dense, {n} x {d} = {n * d:.1e} entries; at most {DENSE_ENTRIES:.0e} are "
                'affordable: take the form "reduced", which is sparse'
            )
        if form == "scaled" and not 0 < abs(self.delta) < np.inf:
            sign, logarithm = self.log_delta
            raise InputError(
                f"delta = {sign:.3g} exp({logarithm:.6g}) is outside the range of doubles, so there is no scaled "
                'basis: take the form "reduced" and `log_delta`'
            )

    @cached_property
    def _bases(self) -> dict[Form, Any]:
        return {}

    def _made(self, form: Form) -> Any:
        if form == "reduced":
            return self._reduced
        if form == "scaled":
            return self._reduced * self.delta
        return orthogonal_columns(self._reduced, form == "orthonormal")

    @cached_property
    def _reduced(self) -> Any:
        reduced = reduced_basis(self._given.matrix, self._factors)
        return reduced if self._places == tuple(range(len(self._places))) else reduced[:, list(self._places)]

    def move(self, v: ArrayLike) -> Array:
        """q' = N v in the reduced form, without forming N.

        Args:
            v: one velocity for each of `independent`, (d,) or (d, p).
        """
        given = np.asarray(v)
        if given.ndim not in (1, 2) or len(given) != len(self.independent) or given.dtype.kind not in "biufc":
            raise InputError(f"v must hold {len(self.independent)} numbers, or so many rows, not shape {given.shape}")
        sorted_v = np.zeros((len(given), given[0].size), np.result_type(given, float))
        sorted_v[list(self._places)] = given.reshape(len(given), -1)
        return self._factors.move(sorted_v).reshape(-1, *given.shape[1:])

    @cached_property
    def _determinant(self) -> Determinant:
        return Determinant(self._factors, self._given.exponents)

    @property
    def delta(self) -> Any:
        """|B|, infinite or 0 where that is outside the range of doubles, as is usual for large A: see `log_delta`."""
        return self._determinant.value

    @property
    def log_delta(self) -> tuple[Any, float]:
        """(sign, log |delta|), at any size of A; the sign of a complex delta is a number of absolute value 1."""
        return self._determinant.logarithm

    @cached_property
    def repeats(self) -> Mapping[int, Mapping[int, Any]]:
        """How redundant rows repeat others: A[i] = sum_k repeats[i][k] A[k]; coefficients at rounding are left out."""
        redundant = np.array(self.redundant, np.intp)
        table = repeated_rows(self._given, self._factors, redundant, self._tolerance)
        return MappingProxyType({i: MappingProxyType(combination) for i, combination in table.items()})

    @cached_property
    def condition(self) -> float:
        """The largest singular value of N = [-B^-1 C; I], to about three digits."""
        return largest_of_basis(self._factors)

    @cached_property
    def subspace_error(self) -> float:
        """The angle [rad] by which rounding turns the subspace, at most about eps max(|N|, |B^-1|).

        B^-1 is that of rows scaled to a largest entry near 1: it also shows rows of A that nearly repeat others,
        which no choice of columns can help. Ten times less is usual.
        """
        return EPS * max(self.condition, largest_of_inverse(self._factors))

    def offset(self, c: Sequence[Any] | Array) -> Array:
        """gamma (n,) with A gamma + c = 0 and zeros in the independent places: gamma = [-B^-1 c; 0].

        Args:
            c: one number for each row of A; those of redundant rows repeat the others as the rows do.

        Raises:
            InputError: c has another size, or A gamma + c = 0 has no solution.
        """
        given = np.asarray(c)
        if given.dtype == object:
            given = np.array([float(entry) if isinstance(entry, Fraction) else entry for entry in given.ravel()])
        m = self._given.shape[0]
        if given.shape != (m,) or given.dtype.kind not in "biufc" or not np.isfinite(given).all():
            raise InputError(f"c must hold {m} finite numbers, one for each row of A, not shape {given.shape}")
        right = shifted(-np.asarray(given, np.result_type(given, float)), -self._given.exponents)[:, None]
        gamma = self._factors.solve(right)
        gamma = gamma + self._factors.solve(right - self._given.matrix @ gamma)
        left = abs(right - self._given.matrix @ gamma)[:, 0]
        size = (abs(self._given.matrix) @ abs(gamma))[:, 0] + abs(right)[:, 0]
        if (left > _CONSISTENT * self._tolerance * size.max(initial=0.0)).any():
            row = int(np.argmax(left))
            raise InputError(
                f"A gamma + c = 0 has no solution: row {row} of A repeats others, its entry of c does not by "
                f"{left[row] / max(float(size.max()), 1e-300):.1e} relative"
            )
        return gamma[:, 0]

    @property
    def operations(self) -> Operations | None:
        """None: nothing is left to evaluate."""
        return None

    def to_function(self) -> Callable[[Any], Any]:
        """f(A) -> basis, for other matrices with the entries of A in the same places, in the same chart.

        See `SparseFunction`.
        """
        from nullbody.nullspace.sparse.function import SparseFunction

        return SparseFunction.of(self)

    def to_sympy(self) -> Any:
        """The basis as a SymPy matrix of floats.

        Raises:
            InputError: it has more than 400 entries.
        """
        from sympy import ImmutableMatrix

        return ImmutableMatrix(self._readable("a SymPy matrix"))

    def latex(self) -> str:
        """The basis in LaTeX, numbers with 6 digits.

        Raises:
            InputError: it has more than 400 entries.
        """
        lines = [" & ".join(_number(entry) for entry in row) for row in self._readable("LaTeX")]
        return "\\begin{bmatrix}" + " \\\\ ".join(lines) + "\\end{bmatrix}"

    def _readable(self, what: str) -> list[list[Any]]:
        n, d = self.shape
        if n * d > _READABLE:
            raise InputError(f"a basis of {n} x {d} is too large for {what} (at most {_READABLE} entries)")
        basis = self.basis
        rows: list[list[Any]] = (basis if isinstance(basis, np.ndarray) else basis.toarray()).tolist()
        return rows

    @property
    def _figure(self) -> str:
        return f"subspace error {self.subspace_error:.0e}"


def _number(number: Any) -> str:
    """A number in LaTeX."""
    text = f"{number:.6g}"
    if "e" not in text:
        return text
    mantissa, exponent = text.split("e")
    return f"{mantissa} \\cdot 10^{{{int(exponent)}}}"
