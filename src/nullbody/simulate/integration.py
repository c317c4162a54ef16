"""The integration itself: Dormand-Prince 8(5,3) steps, projection, and why it stops."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from nullbody.errors import SingularityError
from nullbody.kinematics import project
from nullbody.kinematics.newton import closed_to
from nullbody.model import Model, State
from nullbody.simulate.outcome import Outcome
from nullbody.tolerances import CLOSED_STEP, LARGE_SPREAD, REGULAR_DOUBT, REGULAR_LOSS, SIMULATED_SPREAD
from nullbody.typing import FloatArray

__all__ = ["Integration", "Run", "interpolated"]

Input = Callable[[float, State], FloatArray]
Piece = Callable[[float], FloatArray]


@dataclass(frozen=True)
class Run:
    """What the integrator did: knots t, states y = (q, v, work) there, and the interpolant of each step."""

    knots: FloatArray
    states: FloatArray
    pieces: tuple[Piece, ...]
    outcome: Outcome
    note: str
    evaluations: int
    projections: int
    energy: float

    def at(self, t: float) -> FloatArray:
        """y at a time, from the interpolant of the step that it lies in."""
        return interpolated(self.knots, self.pieces, t) if self.pieces else self.states[0].copy()


def interpolated(knots: FloatArray, pieces: Sequence[Piece], t: float) -> FloatArray:
    """The interpolant of the step that a time lies in, at that time."""
    piece = min(max(int(np.searchsorted(knots, t)) - 1, 0), len(pieces) - 1)
    return pieces[piece](t)


class Integration:
    """y = (q, v, W): q' = N v, v' = Mr^-1 (Br u - hr), W' = u . (rates of the actuated coordinates).

    Args:
        model: the model.
        u: inputs u(t, x).
        rtol, atol: tolerances of the local error.
        max_step: longest step [s].
        max_steps: most steps.
    """

    def __init__(self, model: Model, u: Input, *, rtol: float, atol: float, max_step: float, max_steps: int) -> None:
        self.model = model
        self.u = u
        self.rtol, self.atol, self.max_step, self.max_steps = rtol, atol, max_step, max_steps
        self.nq, self.nv = len(model.coordinates), len(model.independent)
        self._side = 0.0  # sign of |B| at the start
        self._refused: Outcome | None = None  # why the last refused step was refused

    def rate(self, t: float, y: FloatArray) -> FloatArray:
        """y', or NaN where the integrator must not go: beyond |B| = 0, or where an input is not finite.

        It rejects such a step and tries a shorter one, until it stands right before that point.
        """
        if not np.isfinite(y).all():  # a later stage of a step that is refused already
            return np.full(len(y), np.nan)
        q, v = y[: self.nq], y[self.nq : self.nq + self.nv]
        try:
            u = self.u(t, self.model.trusted_state(q.copy(), v.copy()))
        except SingularityError:  # of a controller that inverts the model
            return self._refuse(Outcome.SINGULAR_INDEPENDENT_SET, y)
        if not np.isfinite(u).all():
            return self._refuse(Outcome.NOT_FINITE, y)
        q_ddot, q_dot, delta, spread, doubt, loss = self.model.evaluate("forward_dynamics", q, v, u)
        if np.sign(delta) != self._side or not doubt < REGULAR_DOUBT:
            return self._refuse(Outcome.SINGULAR_INDEPENDENT_SET, y)
        if not (abs(loss) < REGULAR_LOSS and np.isfinite(q_ddot).all()):
            massless = spread < LARGE_SPREAD
            return self._refuse(Outcome.SINGULAR_MASS_MATRIX if massless else Outcome.SINGULAR_INDEPENDENT_SET, y)
        power = u @ q_dot[self.model.actuated_columns]
        return np.concatenate([q_dot, q_ddot[self.model.independent_columns], [power]])

    def _refuse(self, why: Outcome, y: FloatArray) -> FloatArray:
        self._refused = why
        return np.full(len(y), np.nan)

    def inputs(self, t: float, x: State) -> FloatArray:
        """u(t, x), or NaN where a controller that inverts the model finds it singular."""
        try:
            return self.u(t, x)
        except SingularityError:
            return np.full(len(self.model.inputs), np.nan)

    def energy(self, x: State) -> tuple[float, float]:
        """Kinetic and potential energy [J], also right before a singularity."""
        q_dot = self.model.evaluate("kinematics", x.q, x.v)[2]
        T, U = self.model.evaluate("energy", x.q, q_dot)
        return float(T), float(U)

    def run(self, state: State, t0: float, t1: float, advance: Callable[[float], None]) -> Run:
        """Step until t1, or until something named in `Outcome` stops it."""
        from scipy.integrate import DOP853

        y0 = np.concatenate([state.q, state.v, [0.0]])
        energy = self.model.energy(state).total
        self._side = float(np.sign(self.model.null_space(state).delta))
        if not np.isfinite(self.rate(t0, y0)).all():
            return self._ended(t0, y0, energy)
        with np.errstate(all="ignore"):
            solver = DOP853(self.rate, t0, y0, t1, rtol=self.rtol, atol=self.atol, max_step=self.max_step)
        knots, states, pieces, projections = [t0], [y0], [], 0
        outcome, note = Outcome.COMPLETED, ""
        while solver.status == "running":
            self._refused = None
            with np.errstate(all="ignore"):  # trial steps into a singularity are rejected
                message = solver.step()
            if solver.status == "failed":
                outcome, note = self._failed(solver.y, message)
                break
            pieces.append(solver.dense_output())
            projected, open_by = self._projected(solver.y)
            if projected is not solver.y:
                projections += 1
                solver.y = projected
                solver.f = self.rate(solver.t, projected)
            knots.append(float(solver.t))
            states.append(solver.y.copy())
            advance(float(solver.t))
            outcome, note = self._inspected(solver.y, open_by)
            if outcome.ok and len(pieces) >= self.max_steps and solver.status == "running":
                outcome, note = Outcome.TOO_MANY_STEPS, f" ({len(pieces)} steps)"
            if not outcome.ok:
                break
        return Run(
            np.array(knots), np.array(states), tuple(pieces), outcome, note, int(solver.nfev), projections, energy
        )

    def closed(self, states: FloatArray) -> FloatArray:
        """Interpolated states with the loops closed."""
        return np.array([self._projected(y)[0] for y in states]).reshape(len(states), self.nq + self.nv + 1)

    def _projected(self, y: FloatArray) -> tuple[FloatArray, float]:
        """y with its loops closed, and what |Phi| remains; y itself where they are closed already."""
        residual = float(np.abs(self.model.residual(y[: self.nq])).max(initial=0.0))
        if residual <= CLOSED_STEP:
            return y, residual
        q, residual = project(self.model, y[: self.nq])
        return np.concatenate([q, y[self.nq :]]), residual

    def _inspected(self, y: FloatArray, open_by: float) -> tuple[Outcome, str]:
        """Whether to go on after a step."""
        q = y[: self.nq]
        if not open_by <= CLOSED_STEP and not open_by <= 10 * closed_to(self.model.jacobian(q), q):
            return Outcome.LOOPS_OPEN, f" (|Phi| = {open_by:.1e} m)"
        _, _, _, delta, spread, _ = self.model.evaluate("kinematics", y[: self.nq], y[self.nq : self.nq + self.nv])
        if not spread < SIMULATED_SPREAD:
            return self._singular(float(delta), float(spread))
        return Outcome.COMPLETED, ""

    def _singular(self, delta: float, spread: float) -> tuple[Outcome, str]:
        names = ", ".join(self.model.independent)
        return (
            Outcome.SINGULAR_INDEPENDENT_SET,
            f" (v = rates of {names}, |B| = {delta:.2g}, |N| = {np.sqrt(spread):.2g})",
        )

    def _failed(self, y: FloatArray, message: str | None) -> tuple[Outcome, str]:
        """Name a step that could not be made: close to a singularity it is that."""
        _, _, _, delta, spread, _ = self.model.evaluate("kinematics", y[: self.nq], y[self.nq : self.nq + self.nv])
        if self._refused in (Outcome.NOT_FINITE, Outcome.SINGULAR_MASS_MATRIX):
            return self._refused, ""
        if self._refused is not None or not spread < LARGE_SPREAD:
            return self._singular(float(delta), float(spread))
        return Outcome.STEP_TOO_SMALL, f" ({message})" if message else ""

    def _ended(self, t0: float, y0: FloatArray, energy: float) -> Run:
        """A run that could not take its first step."""
        _, _, _, delta, spread, _ = self.model.evaluate("kinematics", y0[: self.nq], y0[self.nq : self.nq + self.nv])
        outcome, note = self._refused or Outcome.NOT_FINITE, ""
        if not spread < SIMULATED_SPREAD:
            outcome, note = self._singular(float(delta), float(spread))
        return Run(np.array([t0]), y0[None, :], (), outcome, note, 1, 0, energy)
