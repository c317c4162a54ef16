"""One attempt of an explicit Runge-Kutta method as one native call; y' comes from a program.

    k_1 = f(t, y),   k_s = f(t + c_s h, y + h sum_j a_sj k_j),   y1 = y + h sum_j b_j k_j,   k_last = f(t + h, y1)
    error = |h| |e5|^2 / sqrt((|e5|^2 + 0.01 |e3|^2) n),   e = sum_j E_j k_j / (atol + rtol max(|y|, |y1|))

The code knows the method's coefficients and no program: it is compiled once for all of them. After each evaluation
guards are checked, parts of the program's outputs that must lie within bounds.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import numpy as np

from nullbody.kernels.attempt_ir import Guard, Job, Tableau
from nullbody.kernels.evaluation import LANES, Evaluation, address, padded
from nullbody.kernels.steps_ir import functions
from nullbody.typing import IndexArray

__all__ = ["Attempt"]


class Attempt:
    """Native attempts for one program. Not for several threads at a time.

    Args:
        tableau: the method.
        evaluation: the program.
        places: of y' among its outputs.
        guards: what must hold after each evaluation.
        rtol, atol: tolerances of the error.

    Attributes:
        y: where the attempt begins; the caller fills it in, and `stages[0]` with y' there.
        stages: all k.
        y1: where it ends.
    """

    def __init__(
        self,
        tableau: Tableau,
        evaluation: Evaluation,
        places: IndexArray,
        guards: Sequence[Guard],
        rtol: float,
        atol: float,
    ) -> None:
        n = len(places)
        self._functions = functions(tableau)
        y, y1, self._inner = padded(n), padded(n), padded(n)
        stages = padded(tableau.stages + len(tableau.C_more), n)
        self.y, self.y1, self.stages = y[:n], y1[:n], stages[:, :n]
        self._guards = (Guard * max(1, len(guards)))(*guards)
        self._places = np.ascontiguousarray(places, dtype=np.int64)
        self._kept = evaluation
        self.job = Job(
            call=evaluation.call,
            places=address(self._places),
            size=n,
            vectors=len(y) // LANES,
            guards=ctypes.addressof(self._guards),
            guard_count=len(guards),
            rtol=rtol,
            atol=atol,
            y=address(y),
            stages=address(stages),
            inner=address(self._inner),
            y1=address(y1),
        )
        self.tableau = tableau
        self._address = ctypes.addressof(self.job)

    def __call__(self, t: float, h: float) -> int:
        """Attempt a step from `y`.

        Returns:
            0: y1 and all stages are there; k > 0: guard k - 1 does not hold; -1: y within the step is not finite.
        """
        return int(self._functions.attempt(self._address, t, h))

    def rate(self, t: float) -> int:
        """y' at `y` as the first stage; returns what an attempt does."""
        return int(self._functions.rate(self._address, t, 0.0))

    def more(self, t: float, h: float) -> int:
        """The stages for dense output, after an attempt, or after the others were put back; returns what it does."""
        return int(self._functions.more(self._address, t, h))

    @property
    def error(self) -> float:
        """The norm of the error estimate of the last attempt, 1 at the tolerance."""
        return float(self.job.error)
