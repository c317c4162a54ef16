"""The rate of the state in one chart, and the state itself in full: what the integrator integrates.

    y = (q, v, W):   q' = N v + beta,   v' = Mr^-1 (Br u - hr),   W' = power of inputs, loads and drives

v are the rates of the independent coordinates of the chart; inputs see the state in those of the model.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from nullbody.errors import SingularityError
from nullbody.kinematics.newton import close_loops
from nullbody.model import Model, State, rate_jacobian
from nullbody.simulate.native import Native, NativeAttempts
from nullbody.simulate.outcome import Outcome
from nullbody.simulate.stepper import Attempts, ByRate
from nullbody.typing import FloatArray

__all__ = ["Input", "Motion"]

Input = Callable[[float, State], FloatArray]


class Motion:
    """The motion of a model, written in a chart of it.

    Args:
        model: the model.
        chart: the same in the independent coordinates in use.
        u: inputs u(t, x), or constant ones.
        scale: what coordinates are measured in, for |N|.
        tolerances: relative and absolute, of steps.
        fixed: refuse to pass |B| = 0, where the chart may not be changed.

    Attributes:
        refused: why the last rate was refused, or None.
        closing: whether to close the loops before each rate, the independent coordinates held: beside a configuration
            singularity N is right on the manifold only, an error d off it grows to d / distance.
    """

    def __init__(
        self,
        model: Model,
        chart: Model,
        u: Input | FloatArray,
        scale: FloatArray,
        tolerances: tuple[float, float],
        *,
        fixed: bool,
    ) -> None:
        self.model, self.chart, self.u, self.fixed = model, chart, u, fixed
        self.nq, self.nv = len(chart.coordinates), len(chart.independent)
        self.refused: Outcome | None = None
        self.closing = False
        self._free = np.setdiff1d(np.arange(self.nq), chart.independent_columns)
        self._scale, self._tolerances = scale, tolerances
        self._forward: NativeAttempts | None = None
        self._side = 0.0  # sign of |B| where it began
        self._limits = model.limits if np.isfinite(np.concatenate(model.limits)).any() else None

    def start(self, t: float, q: FloatArray, q_dot: FloatArray, work: float) -> FloatArray:
        """y for a configuration and all rates."""
        y = np.concatenate([q, q_dot[self.chart.independent_columns], [work]])
        side = float(np.sign(self.native.landing(t, y).delta))
        if side != self._side:
            self._side, self._forward = side, None
        return y

    def rate(self, t: float, y: FloatArray) -> FloatArray:
        """y', or NaN where the integrator must not go: where the chart or a mass matrix is singular, or an input is
        not finite. It rejects such a step and tries a shorter one, until it stands right before that point.
        """
        if not np.isfinite(y).all():  # a later stage of a step that is refused already
            return np.full(len(y), np.nan)
        if self.closing:
            y = self.closed(t, y)
        if not callable(self.u):
            return self.forward.rate(t, y)
        try:
            u = self._input(t, y)
        except SingularityError:  # of a controller that inverts the model
            return self._none(Outcome.SINGULAR_INDEPENDENT_SET, y)
        if not np.isfinite(u).all():
            return self._none(Outcome.NOT_FINITE, y)
        return self.forward.rate(t, y, u)

    def closed(self, t: float, y: FloatArray) -> FloatArray:
        """y with its loops closed, the independent coordinates held; y itself where Newton does not get there."""
        closed = close_loops(self.chart, y[: self.nq], self._free, t)
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

    @cached_property
    def native(self) -> Native:
        """The kernels of the chart with memory of their own."""
        return Native(self.chart, self._scale)

    @property
    def forward(self) -> NativeAttempts:
        """The forward dynamics of the chart, with what must hold where they are evaluated."""
        if self._forward is None:
            u = np.zeros(len(self.model.inputs)) if callable(self.u) else self._held(self.u)
            side = self._side if self.fixed else None
            self._forward = NativeAttempts(self.chart, self.native, u, side, self._tolerances, self._refuse)
        return self._forward

    def attempts(self) -> Callable[[], Attempts]:
        """Who makes attempts of steps: native code where the inputs are constant and the loops need no closing."""
        by_rate, native = ByRate(self.rate, self.nq + self.nv + 1, self._tolerances), self.forward
        return lambda: by_rate if self.closing or callable(self.u) else native

    def q_dot(self, t: float, y: FloatArray) -> FloatArray:
        """All rates of a state."""
        return self.native.rate(t, y)

    def inputs(self, t: FloatArray, y: FloatArray) -> FloatArray:
        """u(t, x) at many times, or NaN where a controller that inverts the model finds it singular."""
        if not callable(self.u):
            return np.tile(self._held(self.u), (len(t), 1))
        found = np.empty((len(t), len(self.model.inputs)))
        for k, (time, row) in enumerate(zip(t.tolist(), y, strict=True)):
            try:
                found[k] = self._input(time, row)
            except SingularityError:
                found[k] = np.nan
        return found

    def state(self, t: float, y: FloatArray) -> State:
        """The state in the independent coordinates of the model."""
        if self.chart.independent == self.model.independent:
            v = y[self.nq : self.nq + self.nv].copy()
        else:
            v = self.q_dot(t, y)[self.model.independent_columns]
        return self.model.trusted_state(y[: self.nq].copy(), v, t)

    def energy(self, t: float, y: FloatArray) -> float:
        """Kinetic and potential energy together [J], also right before a singularity."""
        return float(self.native.energies(np.array([t]), y[None, : self.nq], self.q_dot(t, y)[None]).sum())

    def _input(self, t: float, y: FloatArray) -> FloatArray:
        return self._held(self.u(t, self.state(t, y)) if callable(self.u) else self.u)

    def _held(self, given: FloatArray) -> FloatArray:
        """Inputs within their limits."""
        if self._limits is None or not np.isfinite(given).all():
            return given
        return np.clip(given, *self._limits)

    def _refuse(self, why: Outcome) -> None:
        self.refused = why

    def _none(self, why: Outcome, y: FloatArray) -> FloatArray:
        """y' where it is refused."""
        self._refuse(why)
        return np.full(len(y), np.nan)
