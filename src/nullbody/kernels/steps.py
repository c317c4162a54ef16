"""Many steps as one native call: attempts, their control, and Newton's method at the end of each step.

    error < 1:   the next h is 0.9 error^(-1/8) times this one, 10 times at most
    otherwise:   again with 0.9 error^(-1/8) h, at least h / 5
    at the end:  r(t, y) = 0 by Newton (`Closing`), and y' once more where that moved y

It ends before a step of which an attempt is refused or that would become too short, and after one whose end remains
open: whoever called it looks into these.
"""

from __future__ import annotations

import ctypes
from typing import NamedTuple

import numpy as np

from nullbody.kernels.attempt import Attempt
from nullbody.kernels.closing import Closing
from nullbody.kernels.evaluation import address
from nullbody.kernels.steps_ir import NUMBERS, Run, functions
from nullbody.typing import FloatArray

__all__ = ["Made", "Steps"]


class Made(NamedTuple):
    """Steps that were made, a row for each.

    Attributes:
        numbers: t1, h, h of the next step, attempts, |r| before and after, the weighted sum, Newton steps, then the
            watched outputs.
        raw, y, f: y at the end as the method gave it; with the loops closed; y' there.
        stages: the stages that were to be kept, a matrix for each step.
    """

    numbers: list[list[float]]
    raw: FloatArray
    y: FloatArray
    f: FloatArray
    stages: FloatArray


class Steps:
    """Native steps. Not for several threads at a time.

    Args:
        attempt, closing: what they are made of.
        watched: places of outputs of the closing's matrix program to report, three.
        used: the stages to keep.
    """

    def __init__(self, attempt: Attempt, closing: Closing, watched: tuple[int, int, int], used: slice) -> None:
        tableau = attempt.tableau
        self._function = functions(tableau).steps
        self._kept = closing
        self._attempt = attempt
        row = attempt.job.vectors * 64
        self._stages = used.stop - used.start
        self._run = Run(
            attempt=ctypes.addressof(attempt.job),
            closing=ctypes.addressof(closing.job),
            watched=watched,
            used=used.start * row,
            kept=self._stages * row,
            last=(tableau.stages - 1) * row,
            row=row,
        )
        self._address = ctypes.addressof(self._run)

    def __call__(
        self, t: float, y: FloatArray, f: FloatArray, end: float, lengths: tuple[float, float], count: int
    ) -> Made:
        """Make steps.

        Args:
            t, y, f: where they begin, and y' there.
            end: where they end.
            lengths: of the first step, and of the longest one.
            count: how many are made at most.
        """
        n, row = len(y), self._run.row // 8
        self._attempt.y[:] = y
        self._attempt.stages[0] = f
        numbers = np.empty((count, NUMBERS))
        raw, closed, rates = (np.zeros((count, row)) for _ in range(3))
        stages = np.zeros((count, self._stages, row))
        run = self._run
        run.capacity, run.end, run.longest = count, end, lengths[1]
        run.numbers, run.raw, run.y, run.f, run.stages = map(address, (numbers, raw, closed, rates, stages))
        made = int(self._function(self._address, t, lengths[0]))
        kept = [rows if made == count else rows[:made].copy() for rows in (raw, closed, rates, stages)]
        return Made(numbers[:made].tolist(), *(rows[..., :n] for rows in kept))
