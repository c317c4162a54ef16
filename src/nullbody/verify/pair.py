"""A model and an engine in one state: what is compared, and what errors are relative to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nullbody.formats import number
from nullbody.model import Model, State
from nullbody.typing import FloatArray
from nullbody.verify.engine import AbstractEngine
from nullbody.verify.sample import typical_length
from nullbody.verify.verification import Discrepancy

__all__ = ["Pair", "Seen", "discrepancy"]

_SMALL = 1e-3  # of a typical acceleration or force: errors of vectors below it are relative to this, not to themselves;
# where nothing can move, all of the typical one
_IDLE = 1e8  # condition of N^T S, beyond which the inputs cannot drive every motion


@dataclass(frozen=True, eq=False)
class Seen:
    """A quantity in one state, from both sides, and what its error is relative to."""

    ours: FloatArray
    theirs: FloatArray
    scale: float

    @property
    def absolute(self) -> float:
        """max |ours - theirs|"""
        return float(np.abs(self.ours - self.theirs).max(initial=0.0))

    @property
    def relative(self) -> float:
        """The same against the scale; 0 where both are exactly 0."""
        return self.absolute / self.scale if self.scale else (0.0 if self.absolute == 0 else float("inf"))


@dataclass(frozen=True, eq=False)
class Pair:
    """A model, ready to be compared with engines."""

    model: Model

    @cached_property
    def _length(self) -> float:
        return typical_length(self.model)

    @cached_property
    def _weight(self) -> float:
        """The total weight on earth [N]."""
        mechanism = self.model.mechanism
        return 10.0 * sum(number(body.mass, self.model.parameters) for body in mechanism.bodies)

    @cached_property
    def input_scale(self) -> FloatArray:
        """A typical force [N] or torque [N m]: the total weight, at the typical length."""
        mechanism = self.model.mechanism
        meant = [1.0 if mechanism.units[name] == "m" else self._length for name in mechanism.actuated]
        return self._weight * np.array(meant)

    @cached_property
    def rate_scale(self) -> FloatArray:
        """Typical accelerations of the independent coordinates."""
        units = self.model.mechanism.units
        return np.array([self._length if units[name] == "m" else 1.0 for name in self.model.independent])

    @cached_property
    def _reacting(self) -> list[int]:
        """Places of the multipliers that are forces or torques: all but those of Euler parameters' norms."""
        norms = {f"{joint.name} {row}" for joint in self.model.mechanism.joints for row in joint.own_rows}
        return [i for i, label in enumerate(self.model.labels) if label not in norms]

    @cached_property
    def _redundant(self) -> bool:
        mechanism = self.model.mechanism
        return len(self.model.labels) < len(mechanism.holonomic_rows) + len(mechanism.nonholonomic_rows)

    def seen(self, engine: AbstractEngine, state: State, u: FloatArray, w: FloatArray) -> dict[str, Seen]:
        """All quantities of one state, from the model and from the engine."""
        model, q, t = self.model, state.q, state.t
        q_dot = model.velocity(state)
        q_ddot, lam = engine.forward_dynamics(q, q_dot, u, t)
        seen = {"forward_dynamics": self._seen(model.forward_dynamics(state, u), q_ddot, 1.0)}
        if self._reacting:
            ours, theirs = (x[self._reacting] for x in (model.reactions(state, u), lam))
            if self._redundant:
                A = model.rows(q, t)[0][self._reacting]
                ours, theirs = A.T @ ours, A.T @ theirs
            seen["reactions"] = self._seen(ours, theirs, self._weight)
        if model.independent:
            seen["inverse_dynamics"] = self._inputs(engine, state, q_ddot) or self._forces(engine, state, q_ddot, w)
        return seen

    def _inputs(self, engine: AbstractEngine, state: State, q_ddot: FloatArray) -> Seen | None:
        """The inputs for accelerations; nothing where they are no match for the degrees of freedom."""
        model = self.model
        acting = model.null_space(state).N[model.actuated_columns]
        if len(model.inputs) != len(model.independent) or np.linalg.cond(acting) > _IDLE:
            return None
        ours = model.inverse_dynamics(state, q_ddot[model.independent_columns])
        theirs, lam = engine.inverse_dynamics(state.q, model.velocity(state), q_ddot, state.t)
        return self._seen(ours, theirs, self._weight, gross=np.concatenate([theirs, lam]))

    def _forces(self, engine: AbstractEngine, state: State, q_ddot: FloatArray, w: FloatArray) -> Seen:
        """N^T (M q'' + h) for accelerations q'' + N w."""
        model, N = self.model, self.model.null_space(state).N
        moved, q_dot = q_ddot + N @ w, self.model.velocity(state)
        forces, bias = (engine.generalized_forces(state.q, q_dot, x, state.t) for x in (moved, np.zeros_like(moved)))
        ours = model.generalized_forces(state, moved[model.independent_columns])
        gross = np.abs(N).T @ (np.abs(forces - bias) + np.abs(bias))
        return self._seen(ours, N.T @ forces, self._weight, gross=gross)

    def _seen(self, ours: FloatArray, theirs: FloatArray, typical: float, gross: FloatArray | None = None) -> Seen:
        """Both sides against the engine's largest entry, or a part of what is typical where that is more."""
        largest = float(np.abs(theirs if gross is None else gross).max(initial=0.0))
        least = (_SMALL if self.model.independent else 1.0) * typical * min(self._length, 1.0)
        return Seen(ours, theirs, max(largest, least))


def discrepancy(pairs: Sequence[Seen], sampled: Sequence[State]) -> Discrepancy:
    """One quantity over all states."""
    relative = np.array([pair.relative for pair in pairs])
    worst = int(np.argmax(np.where(np.isnan(relative), np.inf, relative)))
    return Discrepancy(
        max_rel_error=float(relative.max()),
        median_rel_error=float(np.median(relative)),
        max_abs_error=max(pair.absolute for pair in pairs),
        state=worst,
        worst=sampled[worst],
        ours=pairs[worst].ours,
        theirs=pairs[worst].theirs,
    )
