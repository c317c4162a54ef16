"""Numbers and arrays that carry exact derivatives: no differences, no symbols.

For a function x of the state (q, q', t), derivatives along K directions d_k, and of those along the motion:

    first_k = dx/dd_k,   second_k = d^2 x / dd_k dm        the last direction is the motion m itself

so that with the motion (q', 0, 1), first[-1] is x' and second[-1] is x'' for q'' = 0. Products and functions follow
the product and chain rules.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, isfinite, sin, sqrt
from typing import Any

import numpy as np

from nullbody.errors import VerificationError
from nullbody.typing import FloatArray

__all__ = ["FUNCTIONS", "Moving", "Taylor", "cosine", "root", "sine", "tangent"]


class Taylor:
    """A number with derivatives.

    Attributes:
        value: x.
        first: dx/dd_k, one entry for each direction.
        second: d^2 x / dd_k dm, one entry for each direction.
    """

    __array_ufunc__ = None  # numbers of NumPy leave the arithmetic to this class
    __slots__ = ("first", "second", "value")

    def __init__(self, value: float, first: FloatArray, second: FloatArray) -> None:
        self.value, self.first, self.second = float(value), first, second

    def __add__(self, other: Any) -> Taylor:
        if not isinstance(other, Taylor):
            return Taylor(self.value + float(other), self.first, self.second)
        return Taylor(self.value + other.value, self.first + other.first, self.second + other.second)

    def __mul__(self, other: Any) -> Taylor:
        if not isinstance(other, Taylor):
            factor = float(other)
            return Taylor(self.value * factor, self.first * factor, self.second * factor)
        a, b = self, other
        second = a.second * b.value + a.first * b.first[-1] + a.first[-1] * b.first + a.value * b.second
        return Taylor(a.value * b.value, a.first * b.value + a.value * b.first, second)

    def __neg__(self) -> Taylor:
        return Taylor(-self.value, -self.first, -self.second)

    def __sub__(self, other: Any) -> Taylor:
        return self + -other

    def __rsub__(self, other: Any) -> Taylor:
        return -self + other

    def __truediv__(self, other: Any) -> Taylor:
        return self * (_reciprocal(other) if isinstance(other, Taylor) else 1 / float(other))

    def __rtruediv__(self, other: Any) -> Taylor:
        return _reciprocal(self) * other

    __radd__ = __add__
    __rmul__ = __mul__

    def of(self, value: float, slope: float, curvature: float) -> Taylor:
        """f(x) for f, f', f'' at x: f(x)'' = f' x'' + f'' x'^2."""
        second = slope * self.second + curvature * self.first[-1] * self.first
        return Taylor(value, slope * self.first, second)


def _reciprocal(x: Taylor) -> Taylor:
    """1/x"""
    if x.value == 0:
        raise VerificationError("an expression of the mechanism divides by zero in this state")
    inverse = 1 / x.value
    return x.of(inverse, -(inverse**2), 2 * inverse**3)


def sine(x: Any) -> Any:
    """sin x: (sin x)'' = x'' cos x - x'^2 sin x"""
    if not isinstance(x, Taylor):
        return sin(x)
    s, c = sin(x.value), cos(x.value)
    return x.of(s, c, -s)


def cosine(x: Any) -> Any:
    """cos x: (cos x)'' = -x'' sin x - x'^2 cos x"""
    if not isinstance(x, Taylor):
        return cos(x)
    s, c = sin(x.value), cos(x.value)
    return x.of(c, -s, -c)


def tangent(x: Any) -> Any:
    """sin x / cos x"""
    return sine(x) / cosine(x)


def root(x: Any) -> Any:
    """sqrt x: (sqrt x)' = x' / (2 sqrt x)

    Raises:
        VerificationError: x is not positive, where the root has no derivative.
    """
    value = x.value if isinstance(x, Taylor) else float(x)
    if not isfinite(value) or value < 0 or (value == 0 and isinstance(x, Taylor)):
        raise VerificationError(f"an expression of the mechanism takes the square root of {value:g} in this state")
    found = sqrt(value)
    return x.of(found, 0.5 / found, -0.25 / (found * value)) if isinstance(x, Taylor) else found


#: The functions of the grammar of expressions.
FUNCTIONS: dict[str, Callable[[Any], Any]] = {"sqrt": root, "sin": sine, "cos": cosine, "tan": tangent}


@dataclass(frozen=True, eq=False)
class Moving:
    """An array with derivatives.

    Attributes:
        value: of any shape.
        first: the first derivatives, one such array for each direction.
        second: the second derivatives, likewise.
    """

    value: FloatArray
    first: FloatArray
    second: FloatArray

    @staticmethod
    def of(entries: Any, directions: int) -> Moving:
        """An array of numbers, with or without derivatives."""
        array = np.array(entries, dtype=object)
        none = np.zeros(directions)
        flat = [x if isinstance(x, Taylor) else Taylor(x, none, none) for x in array.ravel()]
        value, first, second = (np.array([getattr(x, part) for x in flat]) for part in ("value", "first", "second"))
        shape = (directions, *array.shape)
        return Moving(value.reshape(array.shape), first.T.reshape(shape), second.T.reshape(shape))

    @staticmethod
    def fixed(value: FloatArray, directions: int) -> Moving:
        """An array that does not move."""
        none = np.zeros((directions, *value.shape))
        return Moving(value, none, none)

    def __add__(self, other: Moving) -> Moving:
        return Moving(self.value + other.value, self.first + other.first, self.second + other.second)

    def __matmul__(self, other: Moving | FloatArray) -> Moving:
        """The product of a matrix with a matrix or a vector."""
        if not isinstance(other, Moving):
            return Moving(self.value @ other, self.first @ other, self.second @ other)
        if other.value.ndim == 1:
            column = Moving(other.value[:, None], other.first[..., None], other.second[..., None])
            product = self @ column
            return Moving(product.value[:, 0], product.first[..., 0], product.second[..., 0])
        a, b = self, other
        second = a.second @ b.value + a.first @ b.first[-1] + a.first[-1] @ b.first + a.value @ b.second
        return Moving(a.value @ b.value, a.first @ b.value + a.value @ b.first, second)

    def entries(self) -> Any:
        """The numbers as nested lists."""
        if self.value.ndim == 0:
            return Taylor(float(self.value), self.first, self.second)
        return [self[k].entries() for k in range(len(self.value))]

    def __getitem__(self, k: int) -> Moving:
        return Moving(self.value[k], self.first[:, k], self.second[:, k])
