"""The integration itself: adaptive steps, projection, changes of chart, events, and why it stops."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from nullbody.errors import SingularityError
from nullbody.kinematics import regular_chart, regularity
from nullbody.kinematics.newton import closed_to
from nullbody.model import Model, State
from nullbody.model.scale import coordinate_scales
from nullbody.simulate.crossing import crossed_at, landed, leap_over, leap_piece
from nullbody.simulate.event import Crossing, Event, Happened, accumulating, changed, first_crossing
from nullbody.simulate.motion import Input, Motion
from nullbody.simulate.outcome import Outcome
from nullbody.simulate.piece import Piece, Run
from nullbody.tolerances import CLOSED_STEP, LARGE_SPREAD, SIMULATED_SPREAD, SWITCH_DOUBT, SWITCH_SPREAD
from nullbody.typing import FloatArray

__all__ = ["Integration", "Settings"]

_ENDED = object()  # instead of an integrator: the simulation is over
_CLOSER = 5.0  # by which doubt has grown from its least value where another look at A is due
_BESIDE = 0.5  # regularity of A against that at the start, below which a configuration singularity may be near
_NEAR = 1e-3  # likewise, below which a simulation that cannot go on has met one
_SHORTER = 0.5  # of the longest recent step, below which a step is looked at
_SUDDEN = 1e-3  # of the longest step, below which it is looked at whether a configuration singularity has been met
_CREEP = 1e-6  # likewise, below which it will not be passed in any reasonable number of steps
_UNKNOWN = 1e-7  # regularity of A that loops closed to rounding cannot tell from 0: gaps are quadratic there
_LOW = 1e-3  # regularity of A that measures nothing
_MANY = 50  # short steps in a row that end it as well
_WITHIN = 1e9  # doubt from which a configuration singularity may have been met
_DECIDED = 1e-6  # regularity of A against that at the start, below which rounding decides how the motion goes on
_SHORT = 0.2  # of the longest recent step: rounding beside a singularity makes steps shorter than that
_RECENT = 6  # steps
_LOST = 1e-9  # regularity of A below which it has lost rank, wherever it began
_RETRIES = 5  # other charts after failed steps, without a step between
_LATE = (
    4.0  # by which |N|^2 at the end of a step exceeds what is watched for where the step is made again in another chart
)
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
        self._usual = 1.0  # the same, or what it rose to where it began beside a singularity
        self._doubt = 1.0  # at the end of the last step
        self._least_doubt = np.inf  # seen so far in this chart
        self._leaping = False
        self._longest = 0.0  # step so far
        self._creeping = 0  # short steps in a row beside a configuration singularity
        self._failed = 0  # steps in a row
        self._happened: tuple[Event, ...] = ()  # at the last knot

    def run(self, state: State, t0: float, t1: float, advance: Callable[[float], None]) -> Run:
        """Step until t1, or until something named in `Outcome` stops it."""
        if self.settings.switch:
            labels_A = self.model.all_rows(state.q, t0)[1]
            self._scale = coordinate_scales(self.model, labels_A)
            self._first = self._usual = regularity(self.model, state.q, t0)
        motion, y = self._begin(state, t0)
        run = Run([(t0, motion, y)], sum(motion.energy(t0, motion.full(t0, y))))
        if self._first < _UNKNOWN:
            run.outcome = Outcome.CONFIGURATION_SINGULARITY
            run.note = f" (it starts there: smallest singular value of A {self._first:.1e} of the largest)"
            return run
        if not np.isfinite(motion.rate(t0, y)).all():
            run.outcome, run.note = self._stuck(motion, t0, y, "")
            return run
        solver = self._solver(motion, t0, y, t1)
        while solver is not None and solver is not _ENDED and solver.t < t1:
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

    def _solver(
        self, motion: Motion, t: float, y: FloatArray, t1: float, first: float | None = None, longest: float = np.inf
    ) -> Any:
        """A fresh integrator at a state."""
        from scipy.integrate import DOP853, Radau

        s = self.settings
        options: dict[str, Any] = {"rtol": s.rtol, "atol": s.atol, "max_step": min(s.max_step, longest)}
        if first is not None:
            options["first_step"] = min(first, t1 - t, s.max_step)
        with np.errstate(all="ignore"):
            if s.method == "stiff":
                return Radau(motion.rate, t, y, t1, jac=motion.jacobian, **options)
            return DOP853(motion.rate, t, y, t1, **options)

    def _step(self, run: Run, solver: Any, t1: float, advance: Callable[[float], None]) -> Any:
        """One step and what follows from it; the integrator to go on with, or None."""
        t0, motion, _ = run.knots[-1]
        motion.refused = None
        evaluations = solver.nfev
        with np.errstate(all="ignore"):  # trial steps into a singularity are rejected
            message = solver.step()
        run.evaluations += int(solver.nfev - evaluations)
        if solver.status == "failed":
            return self._after_failure(run, solver, t1, message or "")
        earlier = self._earlier(run, solver, t1)
        if earlier is not None:
            return earlier
        self._failed = 0
        piece = Piece(t0, float(solver.t), motion, solver.dense_output())
        beside = self._beside(run, piece, solver.y)
        if (beside or motion.closing) and not self._leaping:
            usual = _usual(run, piece)
            t_s = crossed_at(piece, usual)
            if t_s is not None:
                leapt = self._leap(run, usual, t_s, t1, advance)
                if leapt is not None:
                    return leapt
        h = piece.t1 - t0
        self._longest = max(self._longest, h)
        y, open_by = run.add(piece, solver.y)
        if y is not solver.y:
            solver.y = y
            solver.f = motion.rate(solver.t, y)
        motion.closing = beside
        if self.settings.switch and self._usual < _LOW:  # it began beside a singularity
            self._usual = max(self._usual, regularity(motion.chart, y[: motion.nq], solver.t))
        advance(float(solver.t))
        crossing = self._crossing(piece)
        if crossing is not None:
            return self._at_event(run, piece, crossing, t1)
        run.outcome, run.note = self._inspected(motion, solver.t, y, open_by, h / self._longest)
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
        spread, doubt = self._spread(motion, t, y)
        if spread < self._watched[0] and doubt < self._watched[1]:
            return solver
        better = self._better(motion.chart, y[: motion.nq], t)
        if better is motion.chart:
            self._watched = [max(_RISE * spread, SWITCH_SPREAD), max(_RISE**4 * doubt, SWITCH_DOUBT)]
            return solver
        return self._in_chart(run, better, t1, float(solver.step_size or 0.0) or None)

    def _spread(self, motion: Motion, t: float, y: FloatArray) -> tuple[float, float]:
        """|N|^2 in radians and typical lengths, and doubt."""
        N, _, _, doubt = motion.measures(t, y)
        scaled = N * self._scale[motion.chart.independent_columns] / self._scale[:, None]
        return float(np.sum(scaled * scaled)), doubt

    def _earlier(self, run: Run, solver: Any, t1: float) -> Any:
        """The integrator in another chart from the last knot, where a step came too near to a singularity of this."""
        t, motion, y = run.knots[-1]
        if not self.settings.switch or self._leaping or self._failed >= _RETRIES:
            return None
        if self._spread(motion, solver.t, solver.y)[0] < _LATE * self._watched[0]:
            return None
        better = self._better(motion.chart, y[: motion.nq], t, forced=True)
        if better is motion.chart:
            return None
        self._failed += 1
        return self._in_chart(run, better, t1, float(solver.t - t))

    def _in_chart(self, run: Run, chart: Model, t1: float, first: float | None) -> Any:
        """Go on from the last knot in another chart."""
        t, motion, y = run.knots[-1]
        full = motion.full(t, y)
        onward = self._motion(chart)
        start = onward.start(t, full.q, full.q_dot, full.work)
        run.knots[-1] = (t, onward, start)
        run.switches += 1
        self._least_doubt = np.inf
        self._watched = [SWITCH_SPREAD, SWITCH_DOUBT]
        return self._solver(onward, t, start, t1, first)

    # -- configuration singularities ------------------------------------------------------------------------

    def _beside(self, run: Run, piece: Piece, y: FloatArray) -> bool:
        """Whether A itself is about to lose rank: looked at where determinants fall or steps become short."""
        if not self.settings.switch:
            return False
        motion, t = piece.motion, piece.t1
        self._doubt = motion.measures(t, y)[3]
        self._least_doubt = min(self._least_doubt, self._doubt)
        short = t - piece.t0 < _SHORTER * _longest_of(run.pieces)
        if self._doubt < _CLOSER * self._least_doubt and not short:
            return False
        return regularity(motion.chart, y[: motion.nq], t) < _BESIDE * self._first

    def _leap(self, run: Run, h: float, t_s: float, t1: float, advance: Callable[[float], None]) -> Any:
        """Go on behind a configuration singularity; None where there is no room, or the end is nearer."""
        motion = run.knots[-1][1]
        while t_s - run.knots[-1][0] < 0.2 * h and _may_go(run.pieces, motion):  # back to before the short steps
            run.pieces.pop()
            run.knots.pop()
        t0, motion, y0 = run.knots[-1]
        leap = leap_over(t0, t_s)
        if leap.end >= t1:
            return None
        self._leaping, motion.closing = True, True
        count = int(np.ceil((leap.begin - t0) / (0.75 * h)))
        solver = self._solver(motion, t0, y0, leap.begin, (leap.begin - t0) / count, (leap.begin - t0) / count)
        while solver is not None and solver.t < leap.begin:
            solver = self._step(run, solver, leap.begin, advance)
        self._leaping = False
        if solver is None:  # an event, or an end
            return _ENDED if not run.outcome.ok or run.outcome is Outcome.EVENT else None
        piece = leap_piece(run.pieces, leap)
        if piece is None:  # the last steps were short ones: on as usual
            return self._solver(motion, leap.begin, run.knots[-1][2], t1)
        y = landed(piece, motion.rate)
        if y is None:
            run.outcome = Outcome.CONFIGURATION_SINGULARITY
            run.note = f" (at t = {t_s:.6g} s; the rates behind it are not those before it)"
            return _ENDED
        run.pieces.append(piece)
        run.knots.append((leap.end, motion, y))
        run.crossings += 1
        crossing = self._crossing(piece)
        if crossing is not None:
            return self._at_event(run, piece, crossing, t1) or _ENDED
        return self._solver(motion, leap.end, y, t1, h)

    # -- ends -----------------------------------------------------------------------------------------------

    def _after_failure(self, run: Run, solver: Any, t1: float, message: str) -> Any:
        """Another chart where that helps; otherwise the name of what stopped it."""
        t, motion, y = run.knots[-1]
        if self.settings.switch and motion.refused not in (Outcome.NOT_FINITE, Outcome.SINGULAR_MASS_MATRIX):
            better = self._better(motion.chart, y[: motion.nq], t, forced=True)
            if better is not motion.chart and self._failed < _RETRIES:
                self._failed += 1
                return self._in_chart(run, better, t1, None)
        run.outcome, run.note = self._stuck(motion, t, y, message)
        return None

    def _stuck(self, motion: Motion, t: float, y: FloatArray, message: str) -> tuple[Outcome, str]:
        """Name a step that could not be made: close to a singularity it is that."""
        _, delta, spread, doubt = motion.measures(t, y)
        if motion.refused in (Outcome.NOT_FINITE, Outcome.SINGULAR_MASS_MATRIX):
            return motion.refused, ""
        if not doubt < self._watched[1] or not spread < LARGE_SPREAD:
            left = regularity(motion.chart, y[: motion.nq], t)
            if (left < _NEAR * self._first or left < _LOST) and self.settings.switch:
                return Outcome.CONFIGURATION_SINGULARITY, f" (smallest singular value of A {left:.1e} of the largest)"
        if motion.refused is not None or not spread < LARGE_SPREAD:
            return self._singular(motion, delta, spread)
        return Outcome.STEP_TOO_SMALL, f" ({message})" if message else ""

    def _inspected(self, motion: Motion, t: float, y: FloatArray, open_by: float, length: float) -> tuple[Outcome, str]:
        """Whether to go on after a step of some length, against the longest so far."""
        q = y[: motion.nq]
        if not open_by <= CLOSED_STEP and not open_by <= 10 * closed_to(motion.chart.jacobian(q, t), q):
            return Outcome.LOOPS_OPEN, f" (|Phi| = {open_by:.1e} m)"
        if not self.settings.switch:
            _, delta, spread, _ = motion.measures(t, y)
            if not spread < SIMULATED_SPREAD:
                return self._singular(motion, delta, spread)
        elif not self._doubt < _WITHIN or length < _SUDDEN:
            left = regularity(motion.chart, q, t) / self._usual
            self._creeping = self._creeping + 1 if left < _NEAR and length < _SUDDEN else 0
            if (left < _DECIDED and not self._leaping) or (left < _NEAR and length < _CREEP) or self._creeping > _MANY:
                return Outcome.CONFIGURATION_SINGULARITY, (
                    f" (smallest singular value of A {left * self._usual:.1e} of the largest: rounding would decide "
                    "the way on)"
                )
        return Outcome.COMPLETED, ""

    def _singular(self, motion: Motion, delta: float, spread: float) -> tuple[Outcome, str]:
        names = ", ".join(motion.chart.independent)
        note = f" (v = rates of {names}, |B| = {delta:.2g}, |N| = {np.sqrt(spread):.2g})"
        return Outcome.SINGULAR_INDEPENDENT_SET, note

    # -- events ---------------------------------------------------------------------------------------------

    def _crossing(self, piece: Piece) -> Crossing | None:
        """The first events within a step."""
        happened, self._happened = self._happened, ()
        motion = piece.motion
        return first_crossing(self.settings.events, piece.t0, piece.t1, lambda t: motion.state(t, piece.y(t)), happened)

    def _at_event(self, run: Run, piece: Piece, crossing: Crossing, t1: float) -> Any:
        """Cut the step at the events and end there, or go on from the state that they make."""
        motion, t = piece.motion, crossing.t
        y = piece.y(t)
        state = motion.state(t, y)
        run.events += [Happened(event.name, t, state) for event in crossing.events]
        run.pieces[-1] = Piece(piece.t0, t, motion, piece.interpolant)
        run.knots[-1] = (t, motion, y)
        self._happened = crossing.events
        terminal = [event.name for event in crossing.events if event.terminal]
        if terminal:
            run.outcome, run.note = Outcome.EVENT, f" ({', '.join(map(repr, terminal))})"
            return None
        if len(run.pieces) >= self.settings.max_steps and t < t1:
            run.outcome, run.note = Outcome.TOO_MANY_STEPS, f" ({len(run.pieces)} steps, {len(run.events)} events)"
            return None
        often = next((event.name for event in crossing.events if accumulating(run.events, event)), None)
        if often is not None:
            run.outcome, run.note = Outcome.EVENTS_ACCUMULATE, f" ({often!r}, {len(run.events)} events)"
            return None
        after = state
        for event in crossing.events:
            after = changed(self.model, event, t, after)
        if after is not state:
            y = self._restarted(motion, t, y, after)
            run.knots.append((t, motion, y))
        return self._solver(motion, t, y, t1) if t < t1 else None

    def _restarted(self, motion: Motion, t: float, y: FloatArray, after: State) -> FloatArray:
        """y at the state that events made; what they take or give counts as work."""
        q_dot = self.model.velocity(after)
        start = motion.start(t, after.q.copy(), q_dot, float(y[-1]))
        before = sum(motion.energy(t, motion.full(t, y)))
        start[-1] += sum(motion.energy(t, motion.full(t, start))) - before
        return start


def _usual(run: Run, piece: Piece) -> float:
    """The length of a step, or that of the longest recent one where this one is much shorter."""
    h = piece.t1 - piece.t0
    longest = _longest_of(run.pieces)
    return longest if h < _SHORT * longest else h


def _longest_of(pieces: Sequence[Piece]) -> float:
    """The length of the longest recent step; 0 without one."""
    return max((p.t1 - p.t0 for p in pieces[-_RECENT:]), default=0.0)


def _may_go(pieces: Sequence[Piece], motion: Motion) -> bool:
    """Whether the last step can be made again: it is in the same chart and no leap."""
    return bool(pieces) and pieces[-1].motion is motion and not pieces[-1].across
