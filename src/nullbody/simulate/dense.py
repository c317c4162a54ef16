"""Dense output of a step of DOP853: a polynomial of degree 7 through both ends, with both slopes.

y(t0 + x h) = y0 + x (F0 + (1 - x) (F1 + x (F2 + (1 - x) (F3 + x (F4 + (1 - x) (F5 + x F6))))))
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from nullbody.typing import FloatArray

__all__ = ["Dense"]


class Dense:
    """y over a step, and somewhat beyond it.

    Args:
        t0, h: begin and length of the step.
        y0: y at its begin.
        coefficients: F, 7 x n, or a function that gives it, asked when y is needed for the first time.
    """

    __slots__ = ("_coefficients", "h", "t0", "y0")

    def __init__(
        self, t0: float, h: float, y0: FloatArray, coefficients: FloatArray | Callable[[], FloatArray]
    ) -> None:
        self.t0, self.h, self.y0 = t0, h, y0
        self._coefficients = coefficients

    def __call__(self, t: float | FloatArray) -> FloatArray:
        """y at a time, n; at several times, n x times."""
        F = self._coefficients
        if not isinstance(F, np.ndarray):
            F = self._coefficients = F()
        x = (t - self.t0) / self.h
        weights = [x]
        for k in range(1, 7):
            weights.append(weights[-1] * (1 - x if k % 2 else x))
        found: FloatArray = (np.array(weights).T @ F + self.y0).T
        return found
