"""How a simulation can end."""

from __future__ import annotations

from enum import Enum

__all__ = ["Outcome"]


class Outcome(Enum):
    """How a simulation ended; the value says what it means and what to try."""

    COMPLETED = "the end time was reached"
    EVENT = "a terminal event happened"
    SINGULAR_INDEPENDENT_SET = (
        "the chosen independent coordinates become singular (|B| -> 0): a forward singularity, where the mechanism "
        "itself may well move on. Simulate with switch=True, or derive with other independent coordinates"
    )
    CONFIGURATION_SINGULARITY = (
        "the mechanism itself becomes singular (A loses rank): closures depend on each other there, and the motion "
        "does not go through smoothly in any independent coordinates, or so slowly that rounding decides: a dead end, "
        "or several ways on. Change the lengths or the start a little, or stop before"
    )
    SINGULAR_MASS_MATRIX = (
        "the reduced mass matrix becomes singular: some motion moves no mass, or next to none, in this configuration. "
        "Check the masses and inertias"
    )
    STEP_TOO_SMALL = (
        "the step became smaller than the spacing of floating-point numbers: the motion is too stiff or not smooth, "
        "often a discontinuous input. Check u(t, x), loosen rtol, or try method='stiff'"
    )
    TOO_MANY_STEPS = (
        "the limit on steps was reached: the motion is stiff. Try method='stiff', raise max_steps, or loosen rtol"
    )
    EVENTS_ACCUMULATE = (
        "an event happens ever more often, such as the last bounces of a ball: infinitely many before a time that is "
        "not reached. End the simulation there with a terminal event, or let `then` bring the motion to rest"
    )
    NOT_FINITE = "an input or an acceleration is not finite. Check u(t, x)"
    LOOPS_OPEN = "the loops could not be closed again after a step: the motion reached a configuration singularity"

    @property
    def ok(self) -> bool:
        """Whether the simulation ended where it was meant to: at the end time, or by a terminal event."""
        return self in (Outcome.COMPLETED, Outcome.EVENT)
