"""The integration itself: adaptive steps, projection, changes of chart, events, and why it stops."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from nullbody.errors import InputError, SingularityError
from nullbody.kinematics import Configuration, coordinate_scales, project, regular_chart
from nullbody.kinematics.newton import closed_to
from nullbody.model import Model, State
from nullbody.simulate.event import Event, Happened, first_crossing
from nullbody.simulate.motion import Full, Input, Motion
from nullbody.simulate.outcome import Outcome
from nullbody.tolerances import CLOSED_STEP, LARGE_SPREAD, SIMULATED_SPREAD, SWITCH_DOUBT, SWITCH_SPREAD
from nullbody.typing import FloatArray

__all__ = ["Integration", "Piece", "Run", "Settings", "at_time"]

_NEAR = 1e-5  # regularity of A, against that at the start, at which no step should end: rounding grows as 1 / it
_RETREAT = 0.61  # of a step that ended there
_RETREATS = 4
_RISE = 4.0  # by which |N| grows before another look is worth its price


@dataclass(frozen=True)
class Settings:
    """What `simulate` was asked for.

    Attributes:
        method: "explicit" or "stiff".
        rtol, atol: tolerances of the local error.
        max_step: longest step [s].
        max_steps: most steps.
        switch: whether independent coordinates may be changed.
        events: what to look for.
    """

    method: str
    rtol: float
    atol: float
    max_step: float
    max_steps: int
    switch: bool
    events: tuple[Event, ...] = ()


@dataclass(frozen=True, eq=False)
class Piece:
    """One step: the motion between two times, in one chart."""

    t0: float
    t1: float
    motion: Motion
    interpolant: Callable[[float], FloatArray]

    def y(self, t: float) -> FloatArray:
        """y at a time within the step, with the loops closed."""
        return projected(self.motion, t, np.asarray(self.interpolant(t)))[0]

    def full(self, t: float) -> Full:
        """q, q' and the work at a time within the step."""
        return self.motion.full(t, self.y(t))


@dataclass
class Run:
    """What the integrator did.

    Attributes:
        knots: where steps ended: time, the motion in its chart, y there.
        pieces: the steps.
        outcome, note: how it ended.
        energy: at the start [J].
        events: what happened.
        evaluations, projections, switches: counts.
    """

    knots: list[tuple[float, Motion, FloatArray]]
    energy: float
    pieces: list[Piece] = field(default_factory=list)
    events: list[Happened] = field(default_factory=list)
    outcome: Outcome = Outcome.COMPLETED
    note: str = ""
    evaluations: int = 0
    projections: int = 0
    switches: int = 0


def at_time(pieces: Sequence[Piece], t: float) -> Piece:
    """The step that a time lies in; the earlier one where two meet."""
    ends = np.array([piece.t1 for piece in pieces])
    return pieces[min(int(np.searchsorted(ends, t)), len(pieces) - 1)]


def projected(motion: Motion, t: float, y: FloatArray) -> tuple[FloatArray, float]:
    """y with its loops closed, and what |Phi| remains; y itself where they are closed already."""
    residual = float(np.abs(motion.chart.residual(y[: motion.nq], t)).max(initial=0.0))
    if residual <= CLOSED_STEP or not np.isfinite(residual):
        return y, residual
    q, residual = project(motion.chart, y[: motion.nq], t)
    return np.concatenate([q, y[motion.nq :]]), residual


class Integration:
    """Steps from a state until t1.

    Args:
        model: the model.
        u: inputs u(t, x), or constant ones.
        settings: tolerances and so on.
    """

    def __init__(self, model: Model, u: Input | FloatArray, settings: Settings) -> None:
        self.model, self.u, self.settings = model, u, settings
        self._scale = np.ones(len(model.coordinates))  # of coordinates, for |N|
        self._watched = [SWITCH_SPREAD, SWITCH_DOUBT]  # |N|^2 and doubt at which another look is due
        self._first = 1.0  # regularity of A at the start
        self._retreats = 0

    def run(self, state: State, t0: float, t1: float, advance: Callable[[float], None]) -> Run:
        """Step until t1, or until something named in `Outcome` stops it."""
        if self.settings.switch:
            labels_A = self.model.all_rows(state.q, t0)[1]
            self._scale = coordinate_scales(self.model, labels_A)
            self._first = Configuration.of(self.model, state.q, t0).regularity
        motion, y = self._begin(state, t0)
        run = Run([(t0, motion, y)], sum(motion.energy(t0, y)))
        if not np.isfinite(motion.rate(t0, y)).all():
            run.outcome, run.note = self._stuck(motion, t0, y, "")
            return run
        solver = self._solver(motion, t0, y, t1)
        while solver is not None and solver.t < t1:
            solver = self._step(run, solver, t1, advance)
        return run

    def _begin(self, state: State, t0: float) -> tuple[Motion, FloatArray]:
        """The first motion, in a chart that is regular at the start."""
        chart = self.model if state.independent == self.model.independent else self.model.in_chart(state.independent)
        motion = self._motion(chart)
        y = np.concatenate([state.q, state.v, [0.0]])
        full = motion.full(t0, y)
        if self.settings.switch and np.isfinite(full.q_dot).all():
            better = self._better(chart, state.q, t0)
            motion = self._motion(better)
        return motion, motion.start(t0, state.q, full.q_dot, 0.0)

    def _motion(self, chart: Model) -> Motion:
        return Motion(self.model, chart, self.u, fixed=not self.settings.switch)

    def _solver(self, motion: Motion, t: float, y: FloatArray, t1: float, first: float | None = None) -> Any:
        """A fresh integrator at a state."""
        from scipy.integrate import DOP853, Radau

        s = self.settings
        options: dict[str, Any] = {"rtol": s.rtol, "atol": s.atol, "max_step": s.max_step}
        if first is not None:
            options["first_step"] = min(first, t1 - t, s.max_step)
        with np.errstate(all="ignore"):
            if s.method == "stiff":
                return Radau(motion.rate, t, y, t1, jac=motion.jacobian, **options)
            return DOP853(motion.rate, t, y, t1, **options)

    def _step(self, run: Run, solver: Any, t1: float, advance: Callable[[float], None]) -> Any:
        """One step and what follows from it; the integrator to go on with, or None."""
        t0, motion, before = run.knots[-1]
        motion.refused = None
        evaluations = solver.nfev
        with np.errstate(all="ignore"):  # trial steps into a singularity are rejected
            message = solver.step()
        run.evaluations += int(solver.nfev - evaluations)
        if solver.status == "failed":
            return self._after_failure(run, solver, t1, message or "")
        if self._too_near(motion, solver):
            return self._solver(motion, t0, before, t1, _RETREAT * float(solver.t - t0))
        self._retreats = 0
        piece = Piece(t0, float(solver.t), motion, solver.dense_output())
        run.pieces.append(piece)
        y, open_by = projected(motion, solver.t, solver.y)
        if y is not solver.y:
            run.projections += 1
            solver.y = y
            solver.f = motion.rate(solver.t, y)
        run.knots.append((float(solver.t), motion, y.copy()))
        advance(float(solver.t))
        event = first_crossing(self.settings.events, t0, piece.t1, lambda t: motion.state(t, piece.y(t)))
        if event is not None:
            return self._at_event(run, piece, *event, t1)
        run.outcome, run.note = self._inspected(motion, solver.t, y, open_by)
        if not run.outcome.ok:
            return None
        if len(run.pieces) >= self.settings.max_steps and solver.t < t1:
            run.outcome, run.note = Outcome.TOO_MANY_STEPS, f" ({len(run.pieces)} steps)"
            return None
        return self._switched(run, solver, t1)

    # -- charts ---------------------------------------------------------------------------------------------

    def _better(self, chart: Model, q: FloatArray, t: float, *, forced: bool = False) -> Model:
        """A chart that is regular at a configuration; the same one where there is none better."""
        try:
            return regular_chart(chart, q, t, good=1.0) if forced else regular_chart(chart, q, t)
        except SingularityError:  # identically singular off the manifold
            return chart

    def _switched(self, run: Run, solver: Any, t1: float) -> Any:
        """The integrator to go on with: a fresh one where the chart has become poor."""
        t, motion, y = run.knots[-1]
        if not self.settings.switch or t >= t1:
            return solver
        N, _, _, doubt = motion.measures(t, y)
        scaled = N * self._scale[motion.chart.independent_columns] / self._scale[:, None]
        spread = float(np.sum(scaled * scaled))
        if spread < self._watched[0] and doubt < self._watched[1]:
            return solver
        better = self._better(motion.chart, y[: motion.nq], t)
        if better is motion.chart:
            self._watched = [max(_RISE * spread, SWITCH_SPREAD), max(_RISE**4 * doubt, SWITCH_DOUBT)]
            return solver
        return self._in_chart(run, better, t1, float(solver.step_size or 0.0) or None)

    def _in_chart(self, run: Run, chart: Model, t1: float, first: float | None) -> Any:
        """Go on from the last knot in another chart."""
        t, motion, y = run.knots[-1]
        full = motion.full(t, y)
        onward = self._motion(chart)
        start = onward.start(t, full.q, full.q_dot, full.work)
        run.knots[-1] = (t, onward, start)
        run.switches += 1
        self._watched = [SWITCH_SPREAD, SWITCH_DOUBT]
        return self._solver(onward, t, start, t1, first)

    def _too_near(self, motion: Motion, solver: Any) -> bool:
        """Whether the step ended so near to a configuration singularity that rounding decides about the branch."""
        if not self.settings.switch or self._retreats >= _RETREATS:
            return False
        _, _, _, doubt = motion.measures(solver.t, solver.y)
        if doubt < self._watched[1]:
            return False
        near = Configuration.of(motion.chart, solver.y[: motion.nq], solver.t).regularity < _NEAR * self._first
        self._retreats += near
        return near

    # -- ends -----------------------------------------------------------------------------------------------

    def _after_failure(self, run: Run, solver: Any, t1: float, message: str) -> Any:
        """Another chart where that helps; otherwise the name of what stopped it."""
        t, motion, y = run.knots[-1]
        if self.settings.switch and motion.refused not in (Outcome.NOT_FINITE, Outcome.SINGULAR_MASS_MATRIX):
            better = self._better(motion.chart, y[: motion.nq], t, forced=True)
            if better is not motion.chart and self._retreats < _RETREATS:
                self._retreats += 1
                return self._in_chart(run, better, t1, None)
        run.outcome, run.note = self._stuck(motion, t, y, message)
        return None

    def _stuck(self, motion: Motion, t: float, y: FloatArray, message: str) -> tuple[Outcome, str]:
        """Name a step that could not be made: close to a singularity it is that."""
        _, delta, spread, doubt = motion.measures(t, y)
        if motion.refused in (Outcome.NOT_FINITE, Outcome.SINGULAR_MASS_MATRIX):
            return motion.refused, ""
        if not doubt < self._watched[1] or not spread < LARGE_SPREAD:
            regularity = Configuration.of(motion.chart, y[: motion.nq], t).regularity
            if regularity < np.sqrt(_NEAR) * self._first and self.settings.switch:
                return Outcome.CONFIGURATION_SINGULARITY, f" (smallest singular value of A {regularity:.1e} of the largest)"
        if motion.refused is not None or not spread < LARGE_SPREAD:
            return self._singular(motion, delta, spread)
        return Outcome.STEP_TOO_SMALL, f" ({message})" if message else ""

    def _inspected(self, motion: Motion, t: float, y: FloatArray, open_by: float) -> tuple[Outcome, str]:
        """Whether to go on after a step."""
        q = y[: motion.nq]
        if not open_by <= CLOSED_STEP and not open_by <= 10 * closed_to(motion.chart.jacobian(q, t), q):
            return Outcome.LOOPS_OPEN, f" (|Phi| = {open_by:.1e} m)"
        if not self.settings.switch:
            _, delta, spread, _ = motion.measures(t, y)
            if not spread < SIMULATED_SPREAD:
                return self._singular(motion, delta, spread)
        return Outcome.COMPLETED, ""

    def _singular(self, motion: Motion, delta: float, spread: float) -> tuple[Outcome, str]:
        names = ", ".join(motion.chart.independent)
        note = f" (v = rates of {names}, |B| = {delta:.2g}, |N| = {np.sqrt(spread):.2g})"
        return Outcome.SINGULAR_INDEPENDENT_SET, note

    # -- events ---------------------------------------------------------------------------------------------

    def _at_event(self, run: Run, piece: Piece, t: float, event: Event, t1: float) -> Any:
        """Cut the step at the event and end there, or go on from the state that the event makes."""
        motion = piece.motion
        y = piece.y(t)
        state = motion.state(t, y)
        run.events.append(Happened(event.name, t, state))
        run.pieces[-1] = Piece(piece.t0, t, motion, piece.interpolant)
        run.knots[-1] = (t, motion, y)
        if event.terminal:
            run.outcome, run.note = Outcome.EVENT, f" ({event.name!r})"
            return None
        if event.then is None:
            return self._solver(motion, t, y, t1) if t < t1 else None
        after = event.then(t, state)
        if not isinstance(after, State):
            raise InputError(f"event {event.name!r}: then(t, x) must give a State, not {type(after).__name__}")
        chart = self.model if after.independent == self.model.independent else self.model.in_chart(after.independent)
        onward = self._motion(chart)
        q_dot = onward.full(t, np.concatenate([self.model.own(after).q, after.v, [0.0]])).q_dot
        onward = self._motion(motion.chart)
        start = onward.start(t, after.q.copy(), q_dot, float(y[-1]))
        before = sum(motion.energy(t, y))
        start[-1] += sum(onward.energy(t, start)) - before  # what the event takes or gives counts as work
        run.knots.append((t, onward, start))
        return self._solver(onward, t, start, t1) if t < t1 else None
