"""An independent engine as the plant: its own accelerations integrated in all redundant coordinates.

    y = (q, q'),   y' = (q', q''),   q'' from M q'' + h + A^T lambda = S u,  A q'' + c = 0 of the engine

Nothing of nullbody enters but the inputs u, and nothing is projected: closures drift as far as the integrator errs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from nullbody.model import Model, State
from nullbody.typing import FloatArray
from nullbody.verify import AbstractEngine

__all__ = ["Motion", "plant_motion"]

_LOST = 0.55  # m from where it began: no slider of the desired motion goes farther than 0.3


@dataclass(frozen=True, eq=False)
class Motion:
    """Times, all coordinates and all rates of a run, until `times[-1]`."""

    times: FloatArray
    q: FloatArray
    q_dot: FloatArray


def plant_motion(
    engine: AbstractEngine,
    model: Model,
    start: State,
    times: FloatArray,
    u: Callable[[float, State], FloatArray],
    rtol: float = 1e-9,
    reach: float = _LOST,
) -> Motion:
    """Integrate an engine from a state, at the given times, until an independent coordinate has run away.

    Args:
        engine: whose accelerations are integrated.
        model: gives the order of coordinates, and q' at the start.
        start: the first state.
        times: where the motion is stored; the first is the start [s].
        u: inputs u(t, x).
        rtol: of DOP853.
        reach: how far from its start a coordinate may go [m, rad].
    """
    from scipy.integrate import solve_ivp

    nq = len(model.coordinates)
    free = model.independent_columns

    def rate(t: float, y: FloatArray) -> FloatArray:
        q, q_dot = y[:nq], y[nq:]
        x = State(q.copy(), q_dot[free], model.coordinates, model.independent)
        return np.concatenate([q_dot, engine.forward_dynamics(q, q_dot, u(t, x))[0]])

    def lost(t: float, y: FloatArray) -> float:
        return reach - float(np.abs(y[free] - start.q[free]).max())

    lost.terminal = True  # type: ignore[attr-defined]
    y0 = np.concatenate([start.q, model.velocity(start)])
    span = (float(times[0]), float(times[-1]))
    found = solve_ivp(rate, span, y0, "DOP853", times, events=lost, rtol=rtol, atol=0.01 * rtol)
    states = found.y.T.reshape(len(found.t), 2 * nq)
    return Motion(found.t, states[:, :nq], states[:, nq:])
