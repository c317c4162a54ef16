"""The desired motion of the whole mechanism along a reference, assembled on one branch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nullbody.control.reference import AbstractReference, Demand
from nullbody.errors import InputError
from nullbody.kinematics import assemble, sweep
from nullbody.kinematics.newton import close_loops
from nullbody.model import Model, State
from nullbody.typing import FloatArray

__all__ = ["DesiredMotion", "desired_motion"]

_KNOTS_PER_SECOND = 50


@dataclass(frozen=True, eq=False)
class DesiredMotion:
    """States of the mechanism along a reference; made by `desired_motion`.

    Attributes:
        model: the model.
        reference: desired motion of the independent coordinates.
        times: knots [s], at which the branch was followed.
        knots: assembled states there.
        rates: all rates q' there; with the knots they predict every state in between.
    """

    model: Model
    reference: AbstractReference
    times: FloatArray
    knots: tuple[State, ...]
    rates: tuple[FloatArray, ...]

    def state(self, t: float) -> State:
        """The state in which the independent coordinates and rates are the desired ones.

        Raises:
            InputError: a time outside those that were prepared; far from the knots the branch is not known.
        """
        begin, end, slack = self.times[0], self.times[-1], self.times[1] - self.times[0]
        if not begin - slack <= t <= end + slack:
            raise InputError(f"the desired motion was prepared for t = {begin:g}..{end:g} s, not for {t:g} s")
        demand, model = self.reference(t), self.model
        q = self._predicted(t)
        q[model.independent_columns] = demand.position
        closed = close_loops(model, q, np.setdiff1d(np.arange(len(q)), model.independent_columns))
        if not closed.converged:
            known = dict(zip(model.independent, demand.position.tolist(), strict=True))
            return assemble(model, known, v=demand.rate, guess=self.knots[self._before(t)])
        return model.trusted_state(closed.q, demand.rate.copy())

    def _before(self, t: float) -> int:
        """The last knot at or before t, but not the last of all."""
        return min(max(int(np.searchsorted(self.times, t, side="right")) - 1, 0), len(self.times) - 2)

    def _predicted(self, t: float) -> FloatArray:
        """Cubic Hermite interpolation of all coordinates between two knots; within 1e-9 of the manifold."""
        k = self._before(t)
        left, right, dt = self.knots[k], self.knots[k + 1], self.times[k + 1] - self.times[k]
        x = min(max((t - self.times[k]) / dt, -1.0), 2.0)
        h, g = x * x * (3 - 2 * x), x * (1 - x)
        slopes = g * ((1 - x) * self.rates[k] - x * self.rates[k + 1])
        predicted: FloatArray = left.q * (1 - h) + right.q * h + dt * slopes
        return predicted

    def demand(self, t: float) -> Demand:
        """The desired independent coordinates, rates and accelerations."""
        return self.reference(t)

    def inputs(self, t: float) -> FloatArray:
        """Inverse dynamics along the reference: u = Br^-1 (Mr v'_d + hr) [42]."""
        return self.model.inverse_dynamics(self.state(t), self.reference(t).acceleration)


def desired_motion(
    model: Model, reference: AbstractReference, t1: float, *, t0: float = 0.0, guess: State | None = None
) -> DesiredMotion:
    """Follow a reference from t0 to t1 on one branch.

    Args:
        model: the model.
        reference: desired motion of the independent coordinates, in the order of `model.independent`.
        t1, t0: times between which it will be used [s].
        guess: near the branch at t0; the mechanism's home by default.

    Raises:
        InputError: wrong times, or the reference has another number of coordinates.
        AssemblyError: the reference leaves the reachable set.
    """
    if not (np.isfinite(t0) and np.isfinite(t1) and t1 > t0):
        raise InputError(f"the end time t1 = {t1} must be finite and after the start t0 = {t0}")
    if len(reference(t0).position) != len(model.independent):
        raise InputError(
            f"the reference moves {len(reference(t0).position)} coordinates, the model has {len(model.independent)} "
            f"independent ones: {', '.join(model.independent)}"
        )
    times = np.linspace(t0, t1, max(2, int(np.ceil((t1 - t0) * _KNOTS_PER_SECOND)) + 1))
    path = [dict(zip(model.independent, reference(float(t)).position.tolist(), strict=True)) for t in times]
    states = sweep(model, path, guess=guess)
    knots = [model.trusted_state(x.q.copy(), reference(float(t)).rate) for t, x in zip(times, states, strict=True)]
    return DesiredMotion(model, reference, times, tuple(knots), tuple(model.velocity(x) for x in knots))
