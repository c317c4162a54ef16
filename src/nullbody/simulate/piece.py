"""What the integrator leaves behind: steps, each in its chart, and where they ended."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from nullbody.kinematics import project
from nullbody.simulate.event import Happened
from nullbody.simulate.motion import Motion
from nullbody.simulate.outcome import Outcome
from nullbody.simulate.stepper import Landing
from nullbody.tolerances import CLOSED_STEP
from nullbody.typing import FloatArray

__all__ = ["Piece", "Run", "at_time", "projected"]

_DIFFERENCE = 1e-3  # of a step, for the slope of its interpolant


class Piece(NamedTuple):
    """The motion between two times, in one chart.

    Attributes:
        t0, t1: the times.
        motion: the motion in its chart.
        interpolant: y over time: n, or n x times.
        across: whether it passes a configuration singularity, where only the interpolant itself can be trusted.
    """

    t0: float
    t1: float
    motion: Motion
    interpolant: Callable[[Any], FloatArray]
    across: bool = False

    def y(self, t: float) -> FloatArray:
        """y at a time within the step, with the loops closed."""
        y = np.asarray(self.interpolant(t))
        return y if self.across else projected(self.motion, t, y)[0]

    def slope(self, t: float | FloatArray) -> FloatArray:
        """y' of the interpolant, by a central difference; n, or n x times."""
        d = _DIFFERENCE * (self.t1 - self.t0)
        slope: FloatArray = (np.asarray(self.interpolant(t + d)) - np.asarray(self.interpolant(t - d))) / (2 * d)
        return slope


@dataclass
class Run:
    """What the integrator did.

    Attributes:
        knots: where steps ended: time, the motion in its chart, y there.
        pieces: the steps.
        outcome, note: how it ended.
        energy: at the start [J].
        events: what happened.
        evaluations, projections, switches, crossings: counts.
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
    crossings: int = 0

    def add(self, piece: Piece, raw: FloatArray, landing: Landing) -> tuple[FloatArray, float]:
        """Append a step that ends at `raw`; y there with the loops closed, and what |Phi| remains."""
        y, open_by = projected(piece.motion, piece.t1, raw, landing)
        self.projections += y is not raw
        self.pieces.append(piece)
        self.knots.append((piece.t1, piece.motion, y))
        return y, open_by


def at_time(pieces: Sequence[Piece], t: float) -> Piece:
    """The step that a time lies in; the earlier one where two meet."""
    ends = np.array([piece.t1 for piece in pieces])
    return pieces[min(int(np.searchsorted(ends, t)), len(pieces) - 1)]


def projected(motion: Motion, t: float, y: FloatArray, landing: Landing | None = None) -> tuple[FloatArray, float]:
    """y with its loops closed, and what |Phi| remains; y itself where they are closed already.

    In a good chart the independent coordinates are held; elsewhere the nearest point of the manifold is taken.

    Args:
        motion: the motion in its chart.
        t, y: the state.
        landing: there, where it is known.
    """
    if motion.closing:
        y = motion.closed(t, y)
    if motion.closing or landing is None:
        landing = motion.native.landing(t, y)
    if landing.before <= CLOSED_STEP or not math.isfinite(landing.before):
        return y, landing.before
    if landing.after <= CLOSED_STEP:
        return landing.y, landing.after
    q, residual = project(motion.chart, y[: motion.nq], t)
    return np.concatenate([q, y[motion.nq :]]), residual
