"""The watch for singularities: when to look for another chart, and when the mechanism itself is near losing rank.

Two measures cost little and are taken after every step: |N|^2 in radians and typical lengths, and doubt, which grows
where determinants fall. The regularity of A (its smallest singular value against the largest) costs more and is looked
at where these, or steps that become short, give reason to.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from nullbody.kinematics import regularity
from nullbody.kinematics.newton import closed_to
from nullbody.model import Model
from nullbody.model.scale import coordinate_scales
from nullbody.simulate.motion import Motion
from nullbody.simulate.outcome import Outcome
from nullbody.simulate.piece import Piece
from nullbody.simulate.stepper import Landing
from nullbody.tolerances import CLOSED_STEP, LARGE_SPREAD, SIMULATED_SPREAD, SWITCH_DOUBT, SWITCH_SPREAD
from nullbody.typing import FloatArray

__all__ = ["Ended", "Watch", "longest_of"]

_CLOSER = 5.0  # by which doubt has grown from its least value where another look at A is due
_SOONER = 1.5  # likewise from the least since such a look
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
_RECENT = 6  # steps
_LOST = 1e-9  # regularity of A below which it has lost rank, wherever it began
_LATE = 4.0  # by which |N|^2 at the end of a step exceeds what is watched for, where the step is made again elsewhere
_RISE = 4.0  # by which |N| grows before another look is worth its price


class Ended(NamedTuple):
    """How a simulation ended, or that it goes on."""

    outcome: Outcome
    note: str = ""


_GOES_ON = Ended(Outcome.COMPLETED)


class Watch:
    """What has been seen so far.

    Args:
        model: the model.
        q, t: where the simulation starts.
        switch: whether charts may be changed; if not, only |N| is watched.

    Attributes:
        scale: what coordinates are measured in, for |N|.
    """

    def __init__(self, model: Model, q: FloatArray, t: float, *, switch: bool) -> None:
        self.switch = switch
        self.scale = coordinate_scales(model, model.all_rows(q, t)[1])
        self._first = regularity(model, q, t) if switch else 1.0  # regularity of A at the start
        self._usual = self._first  # the same, or what it rose to where it began beside a singularity
        self._length = self._longest = 0.0  # of the last step, and of the longest so far
        self._falling = False  # determinants, or the length of steps
        self._creeping = 0  # short steps in a row beside a configuration singularity
        self._delta = self._spread = self._scaled = self._doubt = 1.0
        self.renewed()

    def renewed(self) -> None:
        """Forget what belongs to the chart that was left."""
        self._limits = SWITCH_SPREAD, SWITCH_DOUBT  # |N|^2 and doubt at which another look at charts is due
        self._least_doubt = self._due = np.inf  # doubt: seen so far in this chart, and where to look at A

    def look(self, landing: Landing, pieces: Sequence[Piece], h: float) -> bool:
        """Take the measures at the end of a step of length h; whether there is reason for a closer look."""
        _, _, open_by, self._scaled, self._delta, self._spread, doubt = landing
        self._doubt, self._length = doubt, h
        self._least_doubt = min(self._least_doubt, doubt)
        self._due = min(self._due, max(_CLOSER * self._least_doubt, _SOONER * doubt))
        self._falling = not doubt < self._due or h < _SHORTER * longest_of(pieces)
        calm = self.switch and not self._falling and not self.poor and open_by <= CLOSED_STEP and doubt < _WITHIN
        if not calm or h < _SUDDEN * self._longest or self._usual < _LOW:
            return True
        self._longest = max(self._longest, h)
        return False

    @property
    def poor(self) -> bool:
        """Whether another look at charts is due."""
        return not (self._scaled < self._limits[0] and self._doubt < self._limits[1])

    @property
    def late(self) -> bool:
        """Whether the chart has become so poor that the step should be made again in another one."""
        return not self._scaled < _LATE * self._limits[0]

    def in_vain(self) -> None:
        """There is no better chart: look again when this one has become clearly worse."""
        self._limits = max(_RISE * self._scaled, SWITCH_SPREAD), max(_RISE**4 * self._doubt, SWITCH_DOUBT)

    def start(self) -> str:
        """A note where the simulation starts in a configuration singularity."""
        if self._first >= _UNKNOWN:
            return ""
        return f" (it starts there: smallest singular value of A {self._first:.1e} of the largest)"

    def beside(self, motion: Motion, t: float, y: FloatArray) -> bool:
        """Whether A itself is about to lose rank: looked at where determinants fall or a step is short."""
        if not self.switch or not self._falling:
            return False
        beside = self._regularity(motion, t, y) < _BESIDE * self._first
        self._due = 0.0 if beside else _SOONER * self._doubt
        return beside

    def made(self, motion: Motion, t: float, y: FloatArray) -> None:
        """The step was made, to y."""
        self._longest = max(self._longest, self._length)
        if self.switch and self._usual < _LOW:  # it began beside a singularity
            self._usual = max(self._usual, self._regularity(motion, t, y))

    def inspected(self, motion: Motion, t: float, y: FloatArray, open_by: float, *, leaping: bool) -> Ended:
        """Whether to go on after a step whose end is open by |Phi|."""
        q = y[: motion.nq]
        if not open_by <= CLOSED_STEP and not open_by <= 10 * closed_to(motion.chart.jacobian(q, t), q):
            return Ended(Outcome.LOOPS_OPEN, f" (|Phi| = {open_by:.1e} m)")
        if not self.switch:
            return _GOES_ON if self._spread < SIMULATED_SPREAD else _singular(motion, self._delta, self._spread)
        length = self._length / self._longest
        if self._doubt < _WITHIN and length >= _SUDDEN:
            return _GOES_ON
        left = self._regularity(motion, t, y) / self._usual
        self._creeping = self._creeping + 1 if left < _NEAR and length < _SUDDEN else 0
        if (left < _DECIDED and not leaping) or (left < _NEAR and length < _CREEP) or self._creeping > _MANY:
            return Ended(
                Outcome.CONFIGURATION_SINGULARITY,
                f" (smallest singular value of A {left * self._usual:.1e} of the largest: rounding would decide "
                "the way on)",
            )
        return _GOES_ON

    def stuck(self, motion: Motion, t: float, y: FloatArray, message: str) -> Ended:
        """Name a step that could not be made: close to a singularity it is that."""
        if motion.refused in (Outcome.NOT_FINITE, Outcome.SINGULAR_MASS_MATRIX):
            return Ended(motion.refused, "")
        _, _, _, _, delta, spread, doubt = motion.native.landing(t, y)
        if self.switch and not (doubt < self._limits[1] and spread < LARGE_SPREAD):
            left = self._regularity(motion, t, y)
            if left < _NEAR * self._first or left < _LOST:
                return Ended(
                    Outcome.CONFIGURATION_SINGULARITY, f" (smallest singular value of A {left:.1e} of the largest)"
                )
        if motion.refused is not None or not spread < LARGE_SPREAD:
            return _singular(motion, delta, spread)
        return Ended(Outcome.STEP_TOO_SMALL, f" ({message})" if message else "")

    def _regularity(self, motion: Motion, t: float, y: FloatArray) -> float:
        return regularity(motion.chart, y[: motion.nq], t)


def longest_of(pieces: Sequence[Piece]) -> float:
    """The length of the longest recent step; 0 without one."""
    return max([p.t1 - p.t0 for p in pieces[-_RECENT:]], default=0.0)


def _singular(motion: Motion, delta: float, spread: float) -> Ended:
    names = ", ".join(motion.chart.independent)
    note = f" (v = rates of {names}, |B| = {delta:.2g}, |N| = {np.sqrt(spread):.2g})"
    return Ended(Outcome.SINGULAR_INDEPENDENT_SET, note)
