"""How large expressions are at a few configurations: pivots that vanish where the loops are closed are not to be taken.

An expression can be zero on the whole constraint manifold and yet not be the constant 0. The rows that keep the
platform of a delta robot from turning are such: for a platform that is not turned their entries in the arms' columns
are zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from nullbody.expr import Expr
from nullbody.typing import FloatArray

__all__ = ["Sizes", "sizes_at"]


class Sizes:
    """Absolute values of expressions of one graph at some points; nodes are evaluated once, in their order.

    Args:
        points: the values of symbols by name, one array for each symbol, all of the same length.
    """

    def __init__(self, points: Mapping[str, FloatArray]) -> None:
        self._points = points
        self._unknown = np.full(next((len(array) for array in points.values()), 0), np.nan)
        self._values: list[FloatArray] = []

    def __call__(self, entry: object) -> FloatArray:
        """|entry| at every point; a number is the same at all of them, NaN stands for a symbol without a value."""
        if not isinstance(entry, Expr):
            return np.abs(np.full(len(self._unknown), float(entry)))  # type: ignore[arg-type]
        code = entry.graph.code
        with np.errstate(all="ignore"):
            for node in range(len(self._values), (entry.ref >> 1) + 1):
                self._values.append(self._evaluated(entry, *code[node]))
        return np.abs(self._values[entry.ref >> 1])

    def _evaluated(self, entry: Expr, op: str, a: int, b: int) -> FloatArray:
        graph = entry.graph
        if op == "symbol":
            return self._points.get(graph.symbols[a], self._unknown)
        if op == "const":
            return np.full(len(self._unknown), float(graph.constants[a]))
        left = self._read(a)
        if op in ("add", "sub", "mul"):
            right = self._read(b)
            return left + right if op == "add" else left - right if op == "sub" else left * right
        found: FloatArray = {"inv": np.reciprocal, "sin": np.sin, "cos": np.cos, "sqrt": np.sqrt}[op](left)
        return found

    def _read(self, ref: int) -> FloatArray:
        return -self._values[ref >> 1] if ref & 1 else self._values[ref >> 1]


def sizes_at(names: Sequence[str], rows: Sequence[FloatArray], parameters: Mapping[str, float]) -> Sizes | None:
    """The same from configurations, row by row, and the parameters that all of them share; None without any."""
    if not rows:
        return None
    columns = np.array(rows).T
    shared = {name: np.full(len(rows), value) for name, value in parameters.items()}
    return Sizes({**dict(zip(names, columns, strict=True)), "t": np.zeros(len(rows)), **shared})
