"""Radau IIA of order 5 with the exact Jacobian at constant inputs: SciPy's, for stiff motions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from nullbody.simulate.motion import Motion
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from scipy.integrate import Radau

__all__ = ["stiff"]


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

        def move(self, y: FloatArray) -> None:
            self.y, self.f = y, motion.rate(self.t, y)

        def step(self) -> Any:
            with np.errstate(all="ignore"):
                return super().step()

    rtol, atol = tolerances
    with np.errstate(all="ignore"):
        return Quiet(
            motion.rate, t, y, t1, jac=motion.jacobian, rtol=rtol, atol=atol, max_step=max_step, first_step=first_step
        )
