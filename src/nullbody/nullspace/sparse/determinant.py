"""The determinant of the dependent part of a sparse matrix, in a form that neither overflows nor underflows."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from nullbody.nullspace.numeric.equilibrate import shifted
from nullbody.nullspace.sparse.factor import Factors
from nullbody.typing import IndexArray

__all__ = ["Determinant"]

_LOG2 = math.log(2)


class Determinant:
    """mantissa 2^exponent.

    Attributes:
        mantissa: real or complex, of absolute value in [1/2, 1).
        exponent: an integer.
    """

    def __init__(self, factors: Factors, exponents: IndexArray) -> None:
        """|B| of the used rows and dependent columns, both in increasing order; row i was scaled by 2^-exponents[i]."""
        triangle, swaps = factors.core.factors
        pivots = np.concatenate([*(step.pivots for step in factors.steps), np.diagonal(triangle)])
        odd = np.count_nonzero(swaps != np.arange(len(swaps))) % 2
        for order in factors.order:
            odd ^= _odd(np.argsort(np.argsort(order)))
        mantissa, exponent = _product(pivots)
        self.mantissa: Any = -mantissa if odd else mantissa
        self.exponent = exponent + int(exponents[factors.rows].sum())

    @property
    def value(self) -> Any:
        """The number itself: infinite or 0 beyond the range of doubles."""
        return shifted(np.asarray(self.mantissa), self.exponent)[()]

    @property
    def logarithm(self) -> tuple[Any, float]:
        """(sign, log |B|); the sign of a complex determinant is a number of absolute value 1."""
        size = abs(self.mantissa)
        return self.mantissa / size, math.log(size) + self.exponent * _LOG2


def _product(numbers: Any) -> tuple[Any, int]:
    """A product as mantissa and exponent, by halves."""
    exponent = 0
    while True:
        shifts = np.frexp(abs(numbers))[1].astype(np.intp)
        numbers = shifted(numbers, -shifts)
        exponent += int(shifts.sum())
        if len(numbers) <= 1:
            return (numbers[0] if len(numbers) else 0.5), exponent if len(numbers) else 1
        if len(numbers) % 2:
            numbers = np.append(numbers, 1)
        numbers = numbers[::2] * numbers[1::2]


def _odd(order: IndexArray) -> int:
    """1 if a permutation is odd: n less the number of its cycles."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    n = len(order)
    if not n:
        return 0
    graph = csr_array((np.ones(n, np.int8), order, np.arange(n + 1)), shape=(n, n))
    return (n - int(connected_components(graph, directed=False, return_labels=False))) % 2
