"""The rate of the state in one chart, and the state itself in full: what the integrator integrates.

    y = (q, v, W):   q' = N v + beta,   v' = Mr^-1 (Br u - hr),   W' = power of inputs, loads and drives

v are the rates of the independent coordinates of the chart; inputs see the state in those of the model.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from nullbody.errors import SingularityError
from nullbody.kinematics.newton import close_loops
from nullbody.model import Model, State, rate_jacobian
from nullbody.simulate.outcome import Outcome
from nullbody.tolerances import LARGE_SPREAD, REGULAR_DOUBT, REGULAR_LOSS
from nullbody.typing import FloatArray

__all__ = ["Full", "Input", "Motion"]

Input = Callable[[float, State], FloatArray]


@dataclass(frozen=True, eq=False)
class Full:
    """Coordinates, all rates, and the work done so far [J]."""

    q: FloatArray
    q_dot: FloatArray
    work: float


class Motion:
    """The motion of a model, written in a chart of it.

    Args:
        model: the model.
        chart: the same in the independent coordinates in use.
        u: inputs u(t, x), or constant ones.
        fixed: refuse to pass |B| = 0, where the chart may not be changed.

    Attributes:
        refused: why the last rate was refused, or None.
        closing: whether to close the loops before each rate, the independent coordinates held: beside a configuration
            singularity N is right on the manifold only, an error d off it grows to d / distance.
    """

    def __init__(self, model: Model, chart: Model, u: Input | FloatArray, *, fixed: bool) -> None:
        self.model, self.chart, self.u, self.fixed = model, chart, u, fixed
        self.nq, self.nv = len(chart.coordinates), len(chart.independent)
        self.refused: Outcome | None = None
        self.closing = False
        self._side = 0.0  # sign of |B| where it began
        self._limits = model.limits if np.isfinite(np.concatenate(model.limits)).any() else None

    def start(self, t: float, q: FloatArray, q_dot: FloatArray, work: float) -> FloatArray:
        """y for a configuration and all rates."""
        y = np.concatenate([q, q_dot[self.chart.independent_columns], [work]])
        self._side = float(np.sign(self._kinematics(t, y)[3]))
        return y

    def rate(self, t: float, y: FloatArray) -> FloatArray:
        """y', or NaN where the integrator must not go: where the chart or a mass matrix is singular, or an input is
        not finite. It rejects such a step and tries a shorter one, until it stands right before that point.
        """
        if not np.isfinite(y).all():  # a later stage of a step that is refused already
            return np.full(len(y), np.nan)
        if self.closing:
            y = self.closed(t, y)
        q, v = y[: self.nq], y[self.nq : self.nq + self.nv]
        try:
            u = self._input(t, y)
        except SingularityError:  # of a controller that inverts the model
            return self._refuse(Outcome.SINGULAR_INDEPENDENT_SET, y)
        if not np.isfinite(u).all():
            return self._refuse(Outcome.NOT_FINITE, y)
        q_ddot, q_dot, delta, spread, doubt, loss, power = self.chart.evaluate("forward_dynamics", q, v, u, t=t)
        if (self.fixed and np.sign(delta) != self._side) or not doubt < REGULAR_DOUBT:
            return self._refuse(Outcome.SINGULAR_INDEPENDENT_SET, y)
        if not (abs(loss) < REGULAR_LOSS and np.isfinite(q_ddot).all()):
            massless = spread < LARGE_SPREAD
            return self._refuse(Outcome.SINGULAR_MASS_MATRIX if massless else Outcome.SINGULAR_INDEPENDENT_SET, y)
        return np.concatenate([q_dot, q_ddot[self.chart.independent_columns], [power]])

    def closed(self, t: float, y: FloatArray) -> FloatArray:
        """y with its loops closed, the independent coordinates held; y itself where Newton does not get there."""
        free = np.setdiff1d(np.arange(self.nq), self.chart.independent_columns)
        closed = close_loops(self.chart, y[: self.nq], free, t)
        return np.concatenate([closed.q, y[self.nq :]]) if closed.converged else y

    def jacobian(self, t: float, y: FloatArray) -> FloatArray:
        """dy'/dy at constant inputs."""
        J = np.zeros((len(y), len(y)))
        q, v = y[: self.nq], y[self.nq : self.nq + self.nv]
        try:
            u = self._input(t, y)
        except SingularityError:
            u = np.zeros(len(self.model.inputs))
        J[:, :-1] = rate_jacobian(self.chart, q, v, u, t)
        return np.nan_to_num(J)

    def measures(self, t: float, y: FloatArray) -> tuple[FloatArray, float, float, float]:
        """N, delta, |N|^2 and doubt."""
        N, _, _, delta, spread, doubt = self._kinematics(t, y)
        return N, float(delta), float(spread), float(doubt)

    def full(self, t: float, y: FloatArray) -> Full:
        """All rates of a state."""
        q_dot = self._kinematics(t, y)[2]
        return Full(y[: self.nq].copy(), q_dot, float(y[-1]))

    def inputs(self, t: float, y: FloatArray) -> FloatArray:
        """u(t, x), or NaN where a controller that inverts the model finds it singular."""
        try:
            return self._input(t, y)
        except SingularityError:
            return np.full(len(self.model.inputs), np.nan)

    def state(self, t: float, y: FloatArray) -> State:
        """The state in the independent coordinates of the model."""
        if self.chart.independent == self.model.independent:
            v = y[self.nq : self.nq + self.nv].copy()
        else:
            v = self._kinematics(t, y)[2][self.model.independent_columns]
        return self.model.trusted_state(y[: self.nq].copy(), v, t)

    def energy(self, t: float, full: Full) -> tuple[float, float]:
        """Kinetic and potential energy [J], also right before a singularity."""
        T, U = self.chart.evaluate("energy", full.q, full.q_dot, t=t)
        return float(T), float(U)

    def _input(self, t: float, y: FloatArray) -> FloatArray:
        given = self.u(t, self.state(t, y)) if callable(self.u) else self.u
        if self._limits is None or not np.isfinite(given).all():
            return given
        return np.clip(given, *self._limits)

    def _kinematics(self, t: float, y: FloatArray) -> tuple[FloatArray, ...]:
        return self.chart.evaluate("kinematics", y[: self.nq], y[self.nq : self.nq + self.nv], t=t)

    def _refuse(self, why: Outcome, y: FloatArray) -> FloatArray:
        self.refused = why
        return np.full(len(y), np.nan)
