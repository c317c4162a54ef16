"""What the null space needs to know of a scalar type: zero, constant, inverse, and a witness of its value.

The method itself uses only +, -, * and, at the very end, one reciprocal.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from nullbody.expr import Expr

__all__ = ["exact_rational", "is_constant", "is_unit", "is_zero", "reciprocal"]


def is_zero(scalar: Any) -> bool:
    """Whether the scalar is zero: exactly for numbers and graph expressions, by structure for SymPy."""
    return bool(scalar == 0)


def exact_rational(scalar: Any) -> bool:
    """Whether the scalar is an int or a Fraction."""
    return isinstance(scalar, int | Fraction) and not isinstance(scalar, bool)


def is_constant(scalar: Any) -> bool:
    """Whether dividing by this non-zero scalar is safe everywhere: exact numbers, constants of expressions.

    A float is not: it may be a value that vanishes elsewhere, or one that is only almost zero.
    """
    if isinstance(scalar, Expr):
        return scalar.constant is not None
    return exact_rational(scalar)


def is_unit(scalar: Any) -> bool:
    """Whether a product with this scalar costs nothing: 1 or -1."""
    return bool(scalar == 1 or scalar == -1)


def reciprocal(scalar: Any) -> Any:
    """1 / scalar, exact for integers."""
    return Fraction(1, scalar) if isinstance(scalar, int) else 1 / scalar
