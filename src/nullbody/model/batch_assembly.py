"""Loops of many states closed at once: Newton on all lanes, the independent coordinates held.

q_dependent -= B^-1 Phi(q)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nullbody.model.batch_check import limits_of, singular_kinematics
from nullbody.tolerances import CLOSED, EPS, GIVEN_CLOSED, LONGEST_NEWTON_STEP, NEWTON_STEPS, SETTLED
from nullbody.typing import FloatArray, IndexArray

__all__ = ["Assembled", "Assemblies", "closed_by_newton", "closed_rows"]


#: call(routine, outputs, q, lanes) -> arrays; `lanes` says which states these are.
Call = Callable[[str, tuple[str, ...], FloatArray, IndexArray], tuple[NDArray[Any], ...]]


class Assembled(IntEnum):
    """How the assembly of one state of a batch ended."""

    CLOSED = 0
    OPEN = 1
    SINGULAR = 2
    WRONG_WAY = 3


@dataclass(frozen=True, eq=False)
class Assemblies:
    """What `model.batch.assemble` returns.

    Attributes:
        q: all coordinates, (states, nq); NaN where the loops are not closed [m, rad].
        outcome: (states,) of `Assembled` as integers: 0 closed, 1 open (Newton did not get there), 2 singular (the
            independent coordinates are, on the way), 3 closed the wrong way round (an axis of a loop joint reversed).
        residual: largest |Phi| of every state, where Newton ended [m].
        steps: Newton steps of every state.
    """

    q: FloatArray
    outcome: NDArray[np.int8]
    residual: FloatArray
    steps: NDArray[np.int64]

    @property
    def closed(self) -> NDArray[np.bool_]:
        """Which states are closed."""
        return np.asarray(self.outcome == Assembled.CLOSED)

    def __repr__(self) -> str:
        counts = ", ".join(f"{int((self.outcome == kind).sum())} {kind.name.lower()}" for kind in Assembled)
        return f"<Assemblies of {len(self.q)} states: {counts.replace('_', ' ')}>"


def closed_by_newton(call: Call, q: FloatArray) -> Assemblies:
    """Newton from a guess of all coordinates of every state; q is changed."""
    states = len(q)
    outcome = np.full(states, Assembled.OPEN, dtype=np.int8)
    steps = np.zeros(states, dtype=np.int64)
    active: IndexArray = np.arange(states)
    limits = limits_of(q.dtype)
    for _ in range(NEWTON_STEPS):
        if not len(active):
            break
        here = q if len(active) == states else q[active]
        change, spread, doubt = call("closing", ("correction", "spread", "doubt"), here, active)
        length = np.abs(change).max(axis=1, initial=0.0)
        singular = singular_kinematics(limits, spread, doubt) | ~np.isfinite(length)
        outcome[active[singular]] = Assembled.SINGULAR
        if singular.any():
            going = ~singular
            active, change, length, here = active[going], change[going], length[going], here[going]
        longest = length > LONGEST_NEWTON_STEP
        change[longest] *= LONGEST_NEWTON_STEP / length[longest, None]
        q[active] = np.add(here, change, out=change)
        steps[active] += 1
        settled = length <= SETTLED
        outcome[active[settled]] = Assembled.CLOSED
        active = active[~settled]
    residual = _judge(call, q, outcome)
    q[outcome != Assembled.CLOSED] = np.nan
    for array in (q, outcome, residual, steps):
        array.flags.writeable = False
    return Assemblies(q, outcome, residual, steps)


def _judge(call: Call, q: FloatArray, outcome: NDArray[np.int8]) -> FloatArray:
    """|Phi| of every state; the outcome of those that are not closed, or the wrong way round."""
    everyone: IndexArray = np.arange(len(q))
    residual = np.abs(call("closure", ("Phi",), q, everyone)[0]).max(axis=1, initial=0.0)
    settled = outcome == Assembled.CLOSED
    outcome[settled & ~closed_rows(call, q, residual)] = Assembled.OPEN
    dropped = np.abs(call("redundant", ("Phi",), q, everyone)[0]).max(axis=1, initial=0.0)
    outcome[settled & ~(dropped <= GIVEN_CLOSED)] = Assembled.OPEN
    cosines = call("facing", ("cosines",), q, everyone)[0]
    backwards = ~(cosines > 0).all(axis=1)
    outcome[(outcome == Assembled.CLOSED) & backwards] = Assembled.WRONG_WAY
    return np.asarray(residual, dtype=np.float64)


def closed_rows(call: Call, q: FloatArray, residual: NDArray[Any], factor: float = 1.0) -> NDArray[np.bool_]:
    """Where |Phi| counts as closed: 1e-14 m, or 32 roundings of the lengths where that is more, at most 1e-9 m.

    The lengths are max_i sum_j |A_ij| max(|q_j|, 1), as for one state.
    """
    closed = np.asarray(residual <= factor * CLOSED)
    doubtful: IndexArray = np.flatnonzero(~closed & (residual <= factor * GIVEN_CLOSED))
    if len(doubtful):
        here = q[doubtful]
        A = call("closure", ("A",), here, doubtful)[0]
        lengths = np.einsum("ijk,ik->ij", np.abs(A), np.maximum(np.abs(here), 1.0)).max(axis=1, initial=0.0)
        allowed = np.clip(32 * EPS * lengths, CLOSED, GIVEN_CLOSED)
        closed[doubtful] = residual[doubtful] <= factor * allowed
    return closed
