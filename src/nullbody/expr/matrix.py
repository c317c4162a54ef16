"""Small matrices of any scalar type as nested sequences: products, transposes, cross products.

Terms that are identically zero are left out, so that sparse matrices of expressions stay cheap.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

__all__ = ["Matrix", "Vector", "add", "cross", "dot", "matmul", "matvec", "scale", "skew", "total", "transpose"]

Vector = Sequence[Any]
Matrix = Sequence[Sequence[Any]]


def total(terms: Iterable[Any]) -> Any:
    """The sum of the terms, 0 for none; a plain 0 is never added to an expression."""
    result: Any = 0
    for term in terms:
        result = term if isinstance(result, int) and result == 0 else result + term
    return result


def dot(left: Vector, right: Vector) -> Any:
    """left . right"""
    return total(a * b for a, b in zip(left, right, strict=True) if not (_zero(a) or _zero(b)))


def matvec(matrix: Matrix, vector: Vector) -> list[Any]:
    """matrix vector"""
    return [dot(row, vector) for row in matrix]


def matmul(left: Matrix, right: Matrix) -> list[list[Any]]:
    """left right"""
    columns = transpose(right)
    return [[dot(row, column) for column in columns] for row in left]


def transpose(matrix: Matrix) -> list[list[Any]]:
    """The transpose; of a matrix without rows, a matrix without rows."""
    return [list(column) for column in zip(*matrix, strict=True)]


def add(left: Vector, right: Vector) -> list[Any]:
    """left + right"""
    return [total((a, b)) for a, b in zip(left, right, strict=True)]


def scale(factor: Any, vector: Vector) -> list[Any]:
    """factor vector"""
    return [factor * a for a in vector]


def cross(left: Vector, right: Vector) -> list[Any]:
    """left x right, in space."""
    return matvec(skew(left), right)


def skew(vector: Vector) -> list[list[Any]]:
    """The matrix S with S b = vector x b."""
    x, y, z = vector
    return [[0, -z, y], [z, 0, -x], [-y, x, 0]]


def _zero(scalar: Any) -> bool:
    return bool(scalar == 0)
