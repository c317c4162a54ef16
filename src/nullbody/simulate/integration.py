"""The integration itself: adaptive steps, projection, changes of chart, events, and why it stops."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from nullbody.errors import SingularityError
from nullbody.kinematics import regular_chart
from nullbody.model import Model, State
from nullbody.simulate.crossing import crossed_at, landed, leap_over, leap_piece
from nullbody.simulate.event import Crossing, Event, Happened, accumulating, changed, first_crossing
from nullbody.simulate.motion import Input, Motion
from nullbody.simulate.outcome import Outcome
from nullbody.simulate.piece import Piece, Run
from nullbody.simulate.stepper import Stepper
from nullbody.simulate.stiff import stiff
from nullbody.simulate.watch import Watch, longest_of
from nullbody.typing import FloatArray

__all__ = ["Integration", "Settings"]

_ENDED = object()  # instead of an integrator: the simulation is over
_SHORT = 0.2  # of the longest recent step: rounding beside a singularity makes steps shorter than that
_RETRIES = 5  # other charts after failed steps, without a step between


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
        self._leaping = False
        self._failed = 0  # steps in a row
        self._happened: tuple[Event, ...] = ()  # at the last knot

    def run(self, state: State, t0: float, t1: float, advance: Callable[[float], None]) -> Run:
        """Step until t1, or until something named in `Outcome` stops it."""
        self._watch = watch = Watch(self.model, state.q, t0, switch=self.settings.switch)
        motion, y = self._begin(state, t0)
        run = Run([(t0, motion, y)], motion.energy(t0, y))
        if note := watch.start():
            run.outcome, run.note = Outcome.CONFIGURATION_SINGULARITY, note
            return run
        if not np.isfinite(motion.rate(t0, y)).all():
            run.outcome, run.note = watch.stuck(motion, t0, y, "")
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
        q_dot = motion.q_dot(t0, y)
        if self.settings.switch and np.isfinite(q_dot).all():
            better = self._better(chart, state.q, t0)
            motion = motion if better is chart else self._motion(better)
        y = motion.start(t0, state.q, q_dot, 0.0)
        plain = motion.chart.plain
        if plain is not motion.chart and not np.isfinite(motion.rate(t0, y)).all():
            motion = self._motion(plain)
            y = motion.start(t0, state.q, q_dot, 0.0)
        return motion, y

    def _motion(self, chart: Model) -> Motion:
        return Motion(
            self.model,
            chart,
            self.u,
            self._watch.scale,
            (self.settings.rtol, self.settings.atol),
            fixed=not self.settings.switch,
        )

    def _solver(
        self, motion: Motion, t: float, y: FloatArray, t1: float, first: float | None = None, longest: float = np.inf
    ) -> Any:
        """A fresh integrator at a state."""
        s = self.settings
        longest = min(s.max_step, longest)
        if first is not None:
            first = min(first, t1 - t, s.max_step)
        if s.method == "stiff":
            return stiff(motion, t, y, t1, (s.rtol, s.atol), longest, first)
        return Stepper(motion.attempts(), t, y, t1, (s.rtol, s.atol), longest, first)

    def _step(self, run: Run, solver: Any, t1: float, advance: Callable[[float], None]) -> Any:
        """One step and what follows from it; the integrator to go on with, or None."""
        t0, motion, _ = run.knots[-1]
        motion.refused = None
        evaluations = solver.nfev
        message = solver.step()
        run.evaluations += solver.nfev - evaluations
        if solver.status == "failed":
            return self._after_failure(run, solver, t1, message or "")
        watch, t, raw = self._watch, float(solver.t), solver.y
        landing = solver.landing or motion.native.landing(t, raw)
        closer = watch.look(landing, run.pieces, t - t0) or motion.closing
        if closer and watch.late and (earlier := self._earlier(run, solver, t1)) is not None:
            return earlier
        self._failed = 0
        piece = Piece(t0, t, motion, solver.dense_output())
        beside = closer and watch.beside(motion, t, raw)
        if (beside or motion.closing) and not self._leaping:
            usual = _usual(run, piece)
            t_s = crossed_at(piece, usual)
            if t_s is not None:
                leapt = self._leap(run, usual, t_s, t1, advance)
                if leapt is not None:
                    return leapt
        y, open_by = run.add(piece, raw, landing)
        if y is not raw:
            solver.move(y)
        motion.closing = beside
        if closer:
            watch.made(motion, t, y)
        advance(t)
        if self.settings.events and (crossing := self._crossing(piece)) is not None:
            return self._at_event(run, piece, crossing, t1)
        if closer:
            run.outcome, run.note = watch.inspected(motion, t, y, open_by, leaping=self._leaping)
            if run.outcome is not Outcome.COMPLETED:
                return None
        if len(run.pieces) >= self.settings.max_steps and t < t1:
            run.outcome, run.note = Outcome.TOO_MANY_STEPS, f" ({len(run.pieces)} steps)"
            return None
        return self._switched(run, solver, t1) if closer and watch.poor else solver

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
        better = self._better(motion.chart, y[: motion.nq], t)
        if better is motion.chart:
            self._watch.in_vain()
            return solver
        return self._in_chart(run, better, t1, float(solver.step_size or 0.0) or None)

    def _earlier(self, run: Run, solver: Any, t1: float) -> Any:
        """The integrator in another chart from the last knot, where a step came too near to a singularity of this."""
        t, motion, y = run.knots[-1]
        if not self.settings.switch or self._leaping or self._failed >= _RETRIES:
            return None
        better = self._better(motion.chart, y[: motion.nq], t, forced=True)
        if better is motion.chart:
            return None
        self._failed += 1
        return self._in_chart(run, better, t1, float(solver.t - t))

    def _in_chart(self, run: Run, chart: Model, t1: float, first: float | None) -> Any:
        """Go on from the last knot in another chart."""
        t, motion, y = run.knots[-1]
        onward = self._motion(chart)
        start = onward.start(t, y[: motion.nq], motion.q_dot(t, y), float(y[-1]))
        run.knots[-1] = (t, onward, start)
        run.switches += 1
        self._watch.renewed()
        return self._solver(onward, t, start, t1, first)

    # -- configuration singularities ------------------------------------------------------------------------

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
        if motion.refused is None:
            motion.rate(t, y)  # which notes why, where y' is refused here already
        if self.settings.switch and motion.refused not in (Outcome.NOT_FINITE, Outcome.SINGULAR_MASS_MATRIX):
            better = self._better(motion.chart, y[: motion.nq], t, forced=True)
            if better is not motion.chart and self._failed < _RETRIES:
                self._failed += 1
                return self._in_chart(run, better, t1, None)
        plain = motion.chart.plain
        if plain is not motion.chart and motion.refused is not Outcome.NOT_FINITE:  # its basis may be what is singular
            return self._in_chart(run, plain, t1, None)
        run.outcome, run.note = self._watch.stuck(motion, t, y, message)
        return None

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
        start[-1] += motion.energy(t, start) - motion.energy(t, y)
        return start


def _usual(run: Run, piece: Piece) -> float:
    """The length of a step, or that of the longest recent one where this one is much shorter."""
    h = piece.t1 - piece.t0
    longest = longest_of(run.pieces)
    return longest if h < _SHORT * longest else h


def _may_go(pieces: Sequence[Piece], motion: Motion) -> bool:
    """Whether the last step can be made again: it is in the same chart and no leap."""
    return bool(pieces) and pieces[-1].motion is motion and not pieces[-1].across
