"""How fast small errors grow along the desired motion: the linearised equations.

d/dt (ds, ds') = J(t) (ds, ds'),   J = [0 I; ds''/ds ds''/ds'],   forces as functions of time alone
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nullbody.kinematics.newton import close_loops
from nullbody.report.case import Case
from nullbody.typing import FloatArray

__all__ = ["Growth", "linear_growth"]

_STEP = 1e-6  # of the central differences [m, m/s]
_STEPS_PER_SECOND = 50


@dataclass(frozen=True, eq=False)
class Growth:
    """Largest |ds(t)| for a unit ds'(0) in the worst direction, and the growth rate.

    Attributes:
        times: [s]
        factor: amplification at these times [m per m/s].
        rate: the fitted slope of log factor from 0.5 s on [1/s].
    """

    times: FloatArray
    factor: FloatArray
    rate: float

    def at(self, t: float) -> float | None:
        """The amplification at a time, or nothing outside."""
        return float(np.exp(np.interp(t, self.times[1:], np.log(self.factor[1:])))) if t <= self.times[-1] else None


def linear_growth(case: Case) -> Growth:
    """Integrate the linearised equations along the desired motion by the classical Runge-Kutta method."""
    count = max(4, round(case.settings.duration * _STEPS_PER_SECOND))
    knots = np.linspace(0.0, case.settings.duration, 2 * count + 1)
    J = [_jacobian(case, float(t)) for t in knots]
    h = float(knots[2] - knots[0])
    n = len(case.model.independent)
    found, factor = np.eye(2 * n), [0.0]
    for k in range(count):
        left, middle, right = J[2 * k : 2 * k + 3]
        k1 = left @ found
        k2 = middle @ (found + h / 2 * k1)
        k3 = middle @ (found + h / 2 * k2)
        k4 = right @ (found + h * k3)
        found = found + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        factor.append(float(np.linalg.norm(found[:n, n:], 2)))
    times, values = knots[::2], np.array(factor)
    late = times >= min(0.5, times[-1] / 2)
    rate = float(np.polyfit(times[late], np.log(values[late]), 1)[0])
    return Growth(times, values, rate)


def _jacobian(case: Case, t: float) -> FloatArray:
    """J at a time, by central differences of the forward dynamics with the loops closed again."""
    model = case.model
    n = len(model.independent)
    free = model.independent_columns
    rest = np.setdiff1d(np.arange(len(model.coordinates)), free)
    x, F = case.desired.state(t), case.desired.inputs(t)
    J = np.zeros((2 * n, 2 * n))
    J[:n, n:] = np.eye(n)
    for k in range(2 * n):
        sides = []
        for sign in (1, -1):
            q, v = x.q.copy(), x.v.copy()
            if k < n:
                q[free[k]] += sign * _STEP
                q = close_loops(model, q, rest).q
            else:
                v[k - n] += sign * _STEP
            sides.append(model.evaluate("forward_dynamics", q, v, F)[0][free])
        J[n:, k] = (sides[0] - sides[1]) / (2 * _STEP)
    return J
