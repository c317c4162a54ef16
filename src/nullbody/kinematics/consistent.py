"""Consistent initial conditions: the nearest state that fulfils the constraints, and how far it had to be moved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nullbody.errors import AssemblyError
from nullbody.kinematics.chart import regular_chart
from nullbody.kinematics.newton import close_loops
from nullbody.model import Model, State, checked_model, vector
from nullbody.model.check import check_facing, check_redundant
from nullbody.typing import FloatArray

__all__ = ["ConsistentState", "consistent"]

_RANK = 1e-10  # singular values of A below this part of the largest carry no information


@dataclass(frozen=True, eq=False)
class ConsistentState:
    """A state on the constraint manifold, and what was changed to get there.

    Attributes:
        state: the consistent state, in independent coordinates that are regular there.
        position_change: q - given q [m, rad].
        rate_change: q' - given q' [m/s, rad/s].
        open_by: largest |Phi| of the given coordinates [m, rad].
        slipped_by: largest |A q' + b| of the given rates, at the corrected coordinates.
    """

    state: State
    position_change: FloatArray
    rate_change: FloatArray
    open_by: float
    slipped_by: float

    def __str__(self) -> str:
        """What was changed, in words."""
        moved, turned = np.abs(self.position_change).max(initial=0.0), np.abs(self.rate_change).max(initial=0.0)
        return (
            f"closures open by {self.open_by:.3g}: coordinates moved by up to {moved:.3g}; rates off by "
            f"{self.slipped_by:.3g}: changed by up to {turned:.3g}"
        )


def consistent(model: Model, q: object, q_dot: object = None, *, t: float = 0.0) -> ConsistentState:
    """The state nearest to given coordinates and rates of all of q.

        q:  Gauss-Newton steps of least norm to Phi(q, t) = 0
        q': the nearest with A q' + b = 0,  q' - A^+ (A q' + b)

    Where the model's own independent coordinates are singular, the state is in others (`Model.in_chart`).

    Args:
        model: the model.
        q: all coordinates, in order or by name [m, rad].
        q_dot: rates of all coordinates, in order or by name; at rest by default.
        t: the time [s].

    Raises:
        UnknownName, InputError: wrong names, sizes or values.
        AssemblyError: the loops cannot be closed from there.
    """
    checked_model(model)
    given = vector(q, model.coordinates, "coordinate")
    rates = np.zeros(len(given)) if q_dot is None else vector(q_dot, model.coordinates, "rate")
    open_by = float(np.abs(model.residual(given, t)).max(initial=0.0))
    closed = close_loops(model, given, np.arange(len(given)), t)
    if not closed.converged:
        raise AssemblyError(
            f"the loops cannot be closed from these coordinates: |Phi| = {closed.residual:.3g} after {closed.steps} "
            "steps. Start nearer, or use nullbody.assemble with some coordinates given",
            gap=closed.residual,
        )
    check_redundant(model, closed.q, t)
    check_facing(model, closed.q, t)
    A, b = model.rows(closed.q, t)
    slip = A @ rates + b
    nearest = rates - np.linalg.pinv(A, rcond=_RANK) @ slip if len(A) else rates
    chart = regular_chart(model, closed.q, t)
    state = chart.trusted_state(closed.q, nearest[chart.independent_columns].copy(), t)
    slipped_by = float(np.abs(slip).max(initial=0.0))
    return ConsistentState(state, closed.q - given, nearest - rates, open_by, slipped_by)
