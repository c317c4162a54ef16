"""Arrays as they are worked on: stacks of doubles whose rows are scaled by powers of two.

A null space does not change when rows of A are scaled; ranks, pivots and overflow do. So every row is brought to a
largest entry in [1/2, 1), exactly: only its exponent changes. (An entry below 1e-308 of its row's largest becomes 0.)
"""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Number
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nullbody.errors import InputError
from nullbody.typing import FloatArray, IndexArray

__all__ = ["Array", "Matrices", "finite_numbers", "shifted"]

#: An array of real or complex numbers.
Array = NDArray[Any]


@dataclass(frozen=True)
class Matrices:
    """A stack of matrices A, k x m x n, and its scaled rows.

    Attributes:
        scaled: row i of every matrix times 2^-exponents[i], as doubles or complex doubles.
        exponents: k x m.
        labels: (k,), the numbers of the matrices in the stack that was given, for messages.
        dtype: the type of results: float32, float64, complex64 or complex128.
        single: whether one matrix was given, not a stack.
    """

    scaled: Array
    exponents: IndexArray
    labels: IndexArray
    dtype: np.dtype[Any]
    single: bool

    @classmethod
    def of(cls, A: ArrayLike) -> Matrices:
        """The matrices of an array (m, n) or (k, m, n); integers become doubles, float32 is worked on in double.

        Raises:
            InputError: another shape, no column, entries that are no numbers or not finite.
        """
        values, dtype = finite_numbers(A, "A")
        if values.ndim not in (2, 3) or values.shape[-1] == 0:
            raise InputError(f"A must be a matrix (m, n) or a stack (k, m, n) with n >= 1, not of shape {values.shape}")
        stack = values[None] if values.ndim == 2 else values
        sizes = np.maximum(abs(stack.real), abs(stack.imag)) if np.iscomplexobj(stack) else abs(stack)
        size = sizes.max(axis=2)
        exponents = np.frexp(size)[1].astype(np.intp)
        return cls(shifted(stack, -exponents[:, :, None]), exponents, np.arange(len(stack)), dtype, values.ndim == 2)

    def __len__(self) -> int:
        return len(self.scaled)

    @property
    def shape(self) -> tuple[int, int]:
        """(m, n)"""
        _, m, n = self.scaled.shape
        return m, n

    @property
    def size(self) -> FloatArray:
        """Frobenius norms of the scaled matrices: what pivots and singular values are compared with."""
        return np.sqrt((abs(self.scaled) ** 2).sum(axis=(1, 2)))

    def at(self, which: Any) -> Matrices:
        """Some of the matrices: a slice, a mask or indices."""
        parts = self.scaled[which], self.exponents[which], self.labels[which]
        return Matrices(*parts, self.dtype, self.single)

    def name(self, index: int) -> str:
        """One of the matrices in words: "A", "matrix 3 of the stack"."""
        return "A" if self.single else f"matrix {self.labels[index]} of the stack"


def finite_numbers(given: ArrayLike, name: str) -> tuple[Array, np.dtype[Any]]:
    """An array as doubles or complex doubles, and the type that results have.

    Raises:
        InputError: entries that are no numbers, NaN or infinite; the message says where.
    """
    if np.ma.is_masked(given):
        raise InputError(f"{name} has masked entries: fill them with .filled(value), or leave out their rows")
    try:
        array = np.asarray(given)
        if array.dtype == object and all(isinstance(x, Number) and not isinstance(x, bool) for x in array.flat):
            array = array.astype(complex if any(isinstance(x, complex) for x in array.flat) else float)
    except (ValueError, TypeError, OverflowError) as error:
        raise InputError(f"{name} is no array of numbers: {error}") from None
    if array.dtype == object and any(hasattr(x, "tocsr") or hasattr(x, "free_symbols") for x in array.flat):
        raise InputError(f"{name} needs numbers at one state: evaluate it there; {name}.toarray() of a sparse matrix")
    if array.dtype.kind not in "iufc":
        raise InputError(f"{name} must hold real or complex numbers, not {array.dtype}")
    finite = np.isfinite(array)
    if not finite.all():
        place = np.argwhere(~finite)[0]
        raise InputError(f"{name} must be finite; {_place(place)} holds {array[tuple(place)]}")
    complex_numbers = array.dtype.kind == "c"
    short = array.dtype.kind in "fc" and array.dtype.itemsize <= (8 if complex_numbers else 4)
    names = ("complex64", "complex128") if complex_numbers else ("float32", "float64")
    with np.errstate(over="ignore"):
        values = array.astype(np.complex128 if complex_numbers else np.float64)
    if not np.isfinite(values).all():
        raise InputError(f"{name} holds numbers outside the range of doubles")
    return values, np.dtype(names[0] if short else names[1])


def shifted(numbers: Array, exponents: Any) -> Array:
    """numbers * 2^exponents, exact within the range of doubles, infinite or zero beyond."""
    with np.errstate(over="ignore", under="ignore"):
        if np.iscomplexobj(numbers):
            result = np.empty(np.broadcast_shapes(numbers.shape, np.shape(exponents)), np.complex128)
            result.real, result.imag = np.ldexp(numbers.real, exponents), np.ldexp(numbers.imag, exponents)
            return result
        if np.abs(exponents).max(initial=0) < 1000:  # a product is as exact, and faster
            return np.asarray(numbers * np.ldexp(1.0, exponents))
        return np.asarray(np.ldexp(numbers, exponents))


def _place(index: Any) -> str:
    """An index in words: "row 1, column 2", "matrix 4 of the stack, row 1, column 2"."""
    words = {1: ("entry",), 2: ("row", "column"), 3: ("matrix", "row", "column")}.get(len(index), ())
    return ", ".join(f"{word} {i}" for word, i in zip(words, index, strict=True)) or f"entry {list(map(int, index))}"
