"""Across a configuration singularity, where A loses rank but the motion is smooth: the flat pose of a parallelogram.

N and gamma have limits along the motion, but a rate at the distance e from the singularity loses EPS / e^2, and no
error estimate sees all of that. So no rate is evaluated beside it: a step is made that ends right before, its
interpolant is continued to right behind, where the loops are closed again and the rates must be its own:

    t0 ---- step ---- t_s - w | t_s | t_s + w ---- on,        w = 1/20 of the way to t_s

The distance is measured by the smallest singular value of A against the largest.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from nullbody.kinematics import regularity
from nullbody.simulate.piece import Piece
from nullbody.typing import FloatArray

__all__ = ["Leap", "crossed_at", "landed", "leap_over", "leap_piece"]

_LOOKS = 12  # places within a step
_DEEP = 0.05  # depth of a crossing against the ends of the step
_AHEAD = 0.3  # of the length h of steps, by which a singularity may lie behind the end of one
_WIDTH = 0.05  # w against the way to t_s
_SMOOTH = 0.02  # relative difference of rates behind the singularity from those of the interpolant


class Leap(NamedTuple):
    """From a time before a singularity to one behind it."""

    begin: float
    end: float


def crossed_at(piece: Piece, h: float) -> float | None:
    """The time within a step, or up to 0.3 h after it, at which the distance from a singularity passes through zero."""

    def distance(t: float) -> float:
        left = regularity(piece.motion.chart, np.asarray(piece.interpolant(t))[: piece.motion.nq], t)
        return left if np.isfinite(left) else 0.0

    times = np.linspace(piece.t0, piece.t1, _LOOKS + 1)
    values = [distance(float(t)) for t in times]
    k = int(np.argmin(values))
    if k == _LOOKS:  # still approaching, or just past it: straight on from before the last look
        slope = (values[-2] - values[-3]) / (times[-2] - times[-3])
        t_s = float(times[-2] + values[-2] / max(-slope, 1e-300))
        return t_s if t_s < piece.t1 + _AHEAD * h else None
    if k == 0:
        return None
    from scipy.optimize import minimize_scalar

    width = 1e-6 * (piece.t1 - piece.t0)
    found = minimize_scalar(distance, bounds=(times[k - 1], times[k + 1]), method="bounded", options={"xatol": width})
    return float(found.x) if float(found.fun) < _DEEP * min(values[0], values[-1]) else None


def leap_over(t0: float, t_s: float) -> Leap:
    """Where to leap from and to."""
    w = _WIDTH * (t_s - t0)
    return Leap(t_s - w, t_s + w)


def leap_piece(pieces: Sequence[Piece], leap: Leap) -> Piece | None:
    """The last step that is longer than the leap, continued over it; None where it ended too early for that."""
    width = leap.end - leap.begin
    source = next((piece for piece in reversed(pieces) if piece.t1 - piece.t0 > width), None)
    if source is None or leap.begin - source.t1 > width:
        return None
    return Piece(leap.begin, leap.end, source.motion, source.interpolant, across=True)


def landed(piece: Piece, rate: Callable[[float, FloatArray], FloatArray]) -> FloatArray | None:
    """y at the end of a leap with the loops closed, or None where the motion does not go on as it came."""
    motion, t = piece.motion, piece.t1
    y = motion.closed(t, np.asarray(piece.interpolant(t)))
    found, expected = rate(t, y), piece.slope(t)
    size = float(np.abs(expected).max())
    return y if np.abs(found - expected).max() <= _SMOOTH * size else None
