"""Moments of a motion as arrays: the ends of steps, or any times within them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from typing import NamedTuple

import numpy as np

from nullbody.simulate.motion import Motion
from nullbody.simulate.piece import Piece, projected
from nullbody.typing import FloatArray

__all__ = ["Moments", "at_knots", "at_times"]


class Moments(NamedTuple):
    """Some moments one after the other, in one chart.

    Attributes:
        motion: the motion in its chart.
        t: times [s].
        y: (q, v, W) with the loops closed, times x n.
        q_dot: all rates, times x nq.
    """

    motion: Motion
    t: FloatArray
    y: FloatArray
    q_dot: FloatArray

    @property
    def q(self) -> FloatArray:
        """All coordinates, times x nq."""
        return self.y[:, : self.motion.nq]


def at_knots(knots: Sequence[tuple[float, Motion, FloatArray]]) -> Iterator[Moments]:
    """The ends of steps."""
    for motion, group in groupby(knots, lambda knot: knot[1]):
        ends = list(group)
        t, y = np.array([end[0] for end in ends]), np.array([end[2] for end in ends])
        yield Moments(motion, t, y, motion.native.rates(t, y))


def at_times(pieces: Sequence[Piece], t: FloatArray) -> Iterator[Moments]:
    """Times within steps, in any order; where two steps meet, the earlier one."""
    ends = np.array([piece.t1 for piece in pieces])
    steps = np.minimum(np.searchsorted(ends, t), len(pieces) - 1)
    begins = np.flatnonzero(np.diff(steps, prepend=-1))
    for begin, end in pairwise([*begins, len(t)]):
        yield _within(pieces[steps[begin]], t[begin:end])


def _within(piece: Piece, t: FloatArray) -> Moments:
    """Times within one step."""
    motion, y = piece.motion, np.asarray(piece.interpolant(t)).T
    if piece.across:
        return Moments(motion, t, y, piece.slope(t).T[:, : motion.nq])
    y = np.array([projected(motion, time, row)[0] for time, row in zip(t.tolist(), y, strict=True)])
    return Moments(motion, t, y, motion.native.rates(t, y))
