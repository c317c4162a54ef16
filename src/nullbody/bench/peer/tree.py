"""Counting and evaluating expressions of SymPy and SymEngine, each shared part once."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from nullbody.typing import FloatArray

__all__ = ["evaluated", "operations"]


def operations(expressions: Iterable[Any]) -> int:
    """Additions, multiplications, divisions and square roots of all parts that differ; signs and sin, cos are free."""
    seen: set[Any] = set()
    front, count = list(expressions), 0
    while front:
        expression = front.pop()
        if expression in seen or not expression.args:
            continue
        seen.add(expression)
        front += expression.args
        count += _own(expression)
    return count


def _own(expression: Any) -> int:
    """What the outermost operation costs; nothing where it is a constant."""
    if expression.is_Add:
        return len(expression.args) - 1
    if expression.is_Mul:
        constants = [factor for factor in expression.args if _constant(factor)]
        return len(expression.args) - len(constants) + (constants not in ([], [-1])) - 1
    if not expression.is_Pow or _constant(expression):
        return 0
    exponent = float(expression.args[1])
    whole = int(abs(exponent))
    powers = whole.bit_length() + whole.bit_count() - 2 if whole else 0
    return powers + (abs(exponent) != whole) * (1 + (whole > 0)) + (exponent < 0)


def _constant(expression: Any) -> bool:
    """Whether it is a number, or a power of one such as sqrt(3)."""
    return bool(expression.is_Number or (expression.is_Pow and expression.args[0].is_Number))


def evaluated(rows: Iterable[Iterable[Any]], values: Mapping[Any, float]) -> FloatArray:
    """The expressions at values of their symbols.

    Raises:
        ZeroDivisionError, OverflowError: they are not finite there.
    """
    known: dict[Any, float] = dict(values)
    return np.array([[_value(entry, known) for entry in row] for row in rows], dtype=np.float64)


def _value(expression: Any, known: dict[Any, float]) -> float:
    """The value of one expression; parts come before the whole, without recursion: expressions may be deep."""
    front = [expression]
    while front:
        part = front[-1]
        if part in known:
            front.pop()
        elif missing := [inner for inner in part.args if inner not in known]:
            front += missing
        else:
            known[front.pop()] = _apply(part, [known[inner] for inner in part.args])
    return known[expression]


def _apply(expression: Any, parts: list[float]) -> float:
    if not parts:
        return float(expression)
    if expression.is_Add:
        return math.fsum(parts)
    if expression.is_Mul:
        return math.prod(parts)
    if expression.is_Pow:
        return float(parts[0] ** parts[1])
    return float(getattr(math, type(expression).__name__)(*parts))
