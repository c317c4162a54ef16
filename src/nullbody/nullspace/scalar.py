"""What the null space needs to know of a scalar type: zero, constant, inverse, and a witness of its value.

The method itself uses only +, -, * and, at the very end, one reciprocal.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from nullbody.errors import InputError
from nullbody.expr import Expr

__all__ = ["exact_rational", "is_constant", "is_zero", "reciprocal", "tidy"]


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
    if isinstance(scalar, float):
        return False
    return exact_rational(scalar) or bool(getattr(scalar, "is_Rational", False))


def reciprocal(scalar: Any) -> Any:
    """1 / scalar, exact for integers."""
    return Fraction(1, scalar) if isinstance(scalar, int) else 1 / scalar


def tidy(scalar: Any) -> Any:
    """A scalar that the method can work with: integers become Fractions, NumPy numbers Python's.

    Raises:
        InputError: not a number (NaN or infinite), or of no known kind.
    """
    if isinstance(scalar, bool | str):
        raise InputError(f"a matrix entry must be a number or an expression, not {scalar!r}")
    if isinstance(scalar, Expr | Fraction):
        return scalar
    if isinstance(scalar, int):
        return Fraction(scalar)
    if hasattr(scalar, "free_symbols"):  # SymPy
        if scalar.is_number and not scalar.is_finite:
            raise InputError(f"a matrix entry must be finite, not {scalar}")
        return scalar
    if hasattr(scalar, "item"):  # NumPy
        scalar = scalar.item()
        if isinstance(scalar, int):
            return Fraction(scalar)
    if isinstance(scalar, float):
        if scalar != scalar or scalar in (float("inf"), float("-inf")):
            raise InputError(f"a matrix entry must be finite, not {scalar}")
        return scalar
    raise InputError(f"a matrix entry must be a number or an expression, not {scalar!r}")
