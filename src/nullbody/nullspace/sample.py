"""Expressions and exact numbers as doubles at points: what a null space is worth is seen there.

Symbols that a point leaves out get generic numbers in 0.5..1.5 from a hash of their name, the same ones everywhere.
Stand-ins of the SymPy bridge are symbols like any other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from hashlib import blake2b
from math import inf, isfinite
from typing import Any

import numpy as np

from nullbody.errors import InputError, UnknownName
from nullbody.expr import Exact, Expr, Tape
from nullbody.expr.matrix import Matrix
from nullbody.kernels.reference import FUNCTIONS
from nullbody.typing import FloatArray

__all__ = ["double", "generic_point", "largest_singular_value", "sampled"]


def generic_point(names: Iterable[str]) -> dict[str, float]:
    """A number in 0.5..1.5 for each name; it depends on the name only."""
    return {name: 0.5 + _fraction_of_one(name) for name in names}


def double(number: Any) -> float:
    """A number as a double; infinite where it is too large for one."""
    try:
        return float(number)
    except OverflowError:
        return -inf if (number.negative if isinstance(number, Exact) else number < 0) else inf


def sampled(rows: Matrix, points: Sequence[Mapping[str, float]]) -> FloatArray:
    """Rows of expressions of one graph and of exact numbers at k points: an array k x m x n.

    Entries are infinite or NaN where a division by zero or a number beyond the doubles is met.

    Args:
        rows: m x n.
        points: for each a number for every symbol of the graph; those that are left out get generic ones.

    Raises:
        UnknownName: the graph has no such symbol.
        InputError: a value is no finite number.
    """
    entries = [entry for row in rows for entry in row]
    expressions = [entry for entry in entries if isinstance(entry, Expr)]
    names = expressions[0].graph.symbols if expressions else []
    inputs = _inputs(names, points)
    result = np.empty((len(entries), len(points)))
    for k, entry in enumerate(entries):
        if not isinstance(entry, Expr):
            result[k] = double(entry)
    if expressions:
        places = [k for k, entry in enumerate(entries) if isinstance(entry, Expr)]
        try:
            tape = Tape.of(expressions, names)
        except OverflowError:  # a constant of the graph is beyond the doubles
            result[places] = inf
        else:
            with np.errstate(all="ignore"):
                for k, value in zip(places, tape.run(inputs, FUNCTIONS), strict=True):
                    result[k] = value
    return np.ascontiguousarray(result.T).reshape(len(points), len(rows), len(rows[0]) if rows else 0)


def largest_singular_value(rows: Matrix, values: Mapping[str, float]) -> float:
    """The largest singular value of a matrix at a point; infinite where an entry is not finite there.

    Args:
        rows: m x n expressions of one graph and exact numbers.
        values: numbers for the symbols of the graph; those that are left out get generic ones.

    Raises:
        UnknownName: the graph has no such symbol.
        InputError: a value is no finite number.
    """
    (matrix,) = sampled(rows, [values])
    if not matrix.size:
        return 0.0
    if not np.isfinite(matrix).all():
        return inf
    return float(np.linalg.svd(matrix, compute_uv=False)[0])


def _fraction_of_one(name: str) -> float:
    digest = blake2b(f"point {name}".encode(), digest_size=6).digest()
    return int.from_bytes(digest, "big") / 2.0**48


def _inputs(names: Sequence[str], points: Sequence[Mapping[str, float]]) -> list[FloatArray]:
    """For every name its values at the points."""
    known = set(names)
    points = [_by_name(point) for point in points]
    for point in points:
        for name, value in point.items():
            if name not in known:
                raise UnknownName("symbol", name, names, place="the point")
            if not _real(value):
                raise InputError(f"the point: {name} must be a finite number, not {value!r}")
    generic = generic_point(names)
    return [np.array([float(point.get(name, generic[name])) for point in points]) for name in names]


def _by_name(point: Any) -> dict[str, Any]:
    """A point with names for keys; SymPy's symbols are known by theirs."""
    if not isinstance(point, Mapping):
        raise InputError(f"a point is a mapping from symbols to numbers, not {point!r}")
    return {str(name): value for name, value in point.items()}


def _real(value: Any) -> bool:
    try:
        return isfinite(value) and not isinstance(value, bool)
    except (TypeError, OverflowError):
        return False
