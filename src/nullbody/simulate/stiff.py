"""Radau IIA of order 5 with the exact Jacobian at constant inputs: SciPy's, for stiff motions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from nullbody.simulate.motion import Motion
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from scipy.integrate import Radau

__all__ = ["stiff"]


class _Vanishing(Exception):
    """1 / h is not finite: at t = 0 steps may become as short as that."""


def stiff(
    motion: Motion,
    t: float,
    y: FloatArray,
    t1: float,
    tolerances: tuple[float, float],
    max_step: float,
    first_step: float | None,
) -> Radau:
    """An integrator at a state, used like a `Stepper`."""
    from scipy.integrate import Radau

    class Quiet(Radau):  # trial steps into a singularity are rejected
        landing = None
        h_abs: float

        def move(self, y: FloatArray) -> None:
            self.y, self.f = y, motion.rate(self.t, y)

        def step(self) -> Any:
            if not np.isfinite(self.f).all():
                self.status = "failed"
                return None
            if not np.isfinite(self.h_abs):  # y' is refused where Radau tried it, in search of a first step
                self.h_abs = 0.0  # the shortest one
            try:
                with np.errstate(all="ignore"):
                    return super().step()
            except _Vanishing:
                self.status = "failed"
                return None

    rtol, atol = tolerances
    with np.errstate(all="ignore"):
        solver = Quiet(
            motion.rate, t, y, t1, jac=motion.jacobian, rtol=rtol, atol=atol, max_step=max_step, first_step=first_step
        )
    factors = solver.lu

    def lu(matrix: FloatArray) -> Any:
        if not np.isfinite(matrix).all():
            raise _Vanishing
        return factors(matrix)

    solver.lu = lu
    return solver
