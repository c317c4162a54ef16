"""The null space of one array of numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, final

import numpy as np

from nullbody.errors import InputError
from nullbody.nullspace.numeric.equilibrate import Array
from nullbody.nullspace.numeric.rank import CLEAR
from nullbody.nullspace.numeric.stack import NullSpaceStack
from nullbody.nullspace.result import Form, NullSpace

if TYPE_CHECKING:
    from nullbody.nullspace.numeric.compiled import ArrayFunction

__all__ = ["ArrayNullSpace"]


@final
@dataclass(frozen=True, eq=False, repr=False)
class ArrayNullSpace(NullSpace):
    """A null space in floating point; see `NullSpace` for what it holds. Arrays are read-only."""

    _stack: NullSpaceStack

    @classmethod
    def of(cls, stack: NullSpaceStack) -> ArrayNullSpace:
        """The only null space of a stack of one."""
        numbers = (stack.independent, stack.dependent, stack.rows, stack.redundant)
        independent, dependent, rows, redundant = (tuple(map(int, array[0])) for array in numbers)
        return cls(stack.form, stack.method, independent, dependent, rows, redundant, stack)

    @property
    def delta(self) -> Any:
        """|B| of B = A[rows][:, dependent]; infinite or 0 where that is outside the range of the type."""
        return self._stack.delta[0]

    def in_form(self, form: Form) -> Array:
        """The basis in one of the forms, n x d, in the type of A.

        Raises:
            UnknownName: there is no such form.
            InputError: the form is "scaled" and |B| or N~ leaves the range of the type.
        """
        return self._stack.in_form(form)[0]

    @cached_property
    def repeats(self) -> Mapping[int, Mapping[int, Any]]:
        """How redundant rows repeat others, by least squares; coefficients that are only rounding are left out."""
        table = {
            i: MappingProxyType({k: value for k, value in zip(self.rows, row, strict=True) if value != 0})
            for i, row in zip(self.redundant, self._stack.combinations[0].tolist(), strict=True)
        }
        return MappingProxyType(table)

    @property
    def condition(self) -> float:
        """The largest singular value of N = [-B^-1 C; I]: 1 at best, infinite where |B| = 0."""
        return float(self._stack.condition[0])

    @property
    def subspace_error(self) -> float:
        """The angle [rad] by which rounding turns the subspace, at most; see `NullSpaceStack.subspace_error`."""
        return float(self._stack.subspace_error[0])

    @property
    def gap(self) -> float:
        """How clear the rank is: below 1e3 it is in doubt; see `NullSpaceStack.gap`."""
        return float(self._stack.gap[0])

    def offset(self, c: Sequence[Any]) -> Array:
        """gamma (n,) with A gamma + c = 0 and zeros in the independent places: gamma = [-B^-1 c; 0].

        Raises:
            InputError: the wrong length, no finite numbers, or a redundant row that c does not repeat.
        """
        if np.shape(c) != (len(self.rows) + len(self.redundant),):
            raise InputError(f"c must have one entry for each of A's {len(self.rows) + len(self.redundant)} rows")
        return self._stack.offset(c)[0]

    @property
    def operations(self) -> None:
        """None: nothing is left to evaluate."""
        return

    def to_function(self, *, keep_constants: bool = False) -> ArrayFunction:
        """A compiled function A -> N, for matrices with zeros where A has them and these independent columns.

        Args:
            keep_constants: entries of A that are whole numbers never change; fewer operations.

        Raises:
            InputError: A is complex.
        """
        from nullbody.nullspace.numeric.compiled import ArrayFunction

        return ArrayFunction.of(self._stack, keep_constants=keep_constants)

    def to_sympy(self) -> Any:
        """The basis as a SymPy matrix of floats.

        Raises:
            InputError: SymPy is not installed.
        """
        try:
            import sympy
        except ImportError:
            raise InputError("SymPy is not installed; run: python -m pip install 'nullbody[symbolic]'") from None
        return sympy.Matrix(*self.shape, self.basis.ravel().tolist())

    def latex(self) -> str:
        """The basis in LaTeX, six digits."""
        rows = " \\\\ ".join(" & ".join(map(_latex, row)) for row in self.basis.tolist())
        return f"\\begin{{bmatrix}} {rows} \\end{{bmatrix}}"

    @property
    def _figure(self) -> str:
        doubt = f", rank in doubt: gap {self.gap:.2g}" if self.gap < CLEAR else ""
        if self.form in ("orthogonal", "orthonormal"):  # how good its columns are does not hang on the chart
            return f"subspace error {self.subspace_error:.0e}{doubt}"
        return f"condition {self.condition:.3g}{doubt}"


def _latex(number: complex | float) -> str:
    r"""A number with six digits: -0.5, 2 \cdot 10^{-9}, 1 + 2 i."""
    if isinstance(number, complex):
        if number.imag == 0:
            return _latex(number.real)
        return f"{_latex(number.real)} {'+' if number.imag > 0 else '-'} {_latex(abs(number.imag))} \\mathrm{{i}}"
    mantissa, _, exponent = f"{number + 0.0:.6g}".partition("e")
    return f"{mantissa} \\cdot 10^{{{int(exponent)}}}" if exponent else mantissa
