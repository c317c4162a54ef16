"""A model against independent engines: accelerations, inverse-dynamics forces, reactions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from nullbody.errors import InputError, MechanismError, UnknownName, VerificationError
from nullbody.formats import number
from nullbody.model import Model, State, checked_model
from nullbody.typing import FloatArray
from nullbody.verify.engine import AbstractEngine
from nullbody.verify.full_coordinates import MultiplierEngine
from nullbody.verify.mujoco_engine import MujocoEngine
from nullbody.verify.pinocchio_engine import PinocchioEngine
from nullbody.verify.sample import admissible_states, typical_length
from nullbody.verify.verification import Discrepancy, EngineResult, Verification

__all__ = ["compare"]

_SMALL = (
    1e-3  # of a typical acceleration or force: errors of smaller ones are relative to this, zero ones have no scale
)

_ENGINES: Mapping[str, Callable[..., AbstractEngine]] = {
    "mujoco": MujocoEngine,
    "pinocchio": PinocchioEngine,
    "multipliers": MultiplierEngine,
}


def compare(
    model: Model,
    *,
    engines: Sequence[str | AbstractEngine] = ("mujoco", "pinocchio"),
    states: int = 50,
    seed: int = 0,
    tolerance: float = 1e-10,
    missing: Literal["raise", "skip"] = "raise",
    progress: Callable[[int, int], object] | None = None,
) -> Verification:
    """A model against independent engines on random admissible states.

    Every engine builds the mechanism anew from `model.mechanism` and the parameter values, and gets the same q, q', t
    and random inputs u. Compared are

    - q'' for u;
    - lambda for u, without the multipliers of Euler parameters' norms, which are no forces. Where equations repeat
      others, forces may be shared among them in many ways: there A^T lambda of the rows that were kept is compared;
    - with one input for each degree of freedom, the inputs for the q'' that the engine itself found (so that no
      acceleration of ours enters it); otherwise N^T (M q'' + h) for that q'' and a random admissible addition N w.

    Args:
        model: from `build`, with any parameter values.
        engines: "mujoco", "pinocchio", "multipliers" (full coordinates, nothing to install), or engines of your own.
        states: how many; the home, symmetric and tilted ones.
        seed: of the random states and inputs.
        tolerance: largest relative error that counts as agreement.
        missing: what to do where an engine is not installed.
        progress: called with (states done, all states) of all engines together.

    Raises:
        UnknownName, InputError: no such engine, or arguments that make no sense.
        VerificationError: an engine is not installed, and `missing` is "raise". An engine that cannot have the
            mechanism is skipped, with the reason in its result; where that leaves none, `ok` is false.
        AssemblyError: no admissible states were found.
    """
    checked_model(model)
    if states < 1 or not tolerance > 0:
        raise InputError(f"compare needs at least one state and a positive tolerance, not {states} and {tolerance}")
    if missing not in ("raise", "skip"):
        raise InputError(f"missing must be 'raise' or 'skip', not {missing!r}")
    made = [_engine(model, engine, missing) for engine in ([engines] if isinstance(engines, str) else engines)]
    sampled = admissible_states(model, states, seed)
    total = states * sum(isinstance(engine, AbstractEngine) for engine in made)
    pair = _Pair(model)
    drawn = np.random.default_rng([seed, 1]).normal(size=(states, len(model.inputs))) * pair.input_scale
    added = np.random.default_rng([seed, 2]).normal(size=(states, len(model.independent))) * pair.rate_scale
    tick, ticks = progress or (lambda done, total: None), iter(range(1, total + 1))
    results = []
    for engine in made:
        if isinstance(engine, EngineResult):
            results.append(engine)
            continue
        seen = []
        for state, u, w in zip(sampled, drawn, added, strict=True):
            seen.append(pair.seen(engine, state, u, w))
            tick(next(ticks), total)
        found = {name: _discrepancy([pairs[name] for pairs in seen], sampled) for name in seen[0]}
        results.append(EngineResult(engine.name, engine.version, found))
    return Verification(
        mechanism=model.mechanism.name,
        parameters=model.parameters,
        coordinates=model.coordinates,
        states=states,
        seed=seed,
        tolerance=tolerance,
        engines=tuple(results),
    )


@dataclass(frozen=True, eq=False)
class _Seen:
    """A quantity in one state, from both sides, and what its error is relative to."""

    ours: FloatArray
    theirs: FloatArray
    scale: float

    @property
    def absolute(self) -> float:
        """max |ours - theirs|"""
        return float(np.abs(self.ours - self.theirs).max())

    @property
    def relative(self) -> float:
        """The same against the scale; 0 where both are exactly 0."""
        return self.absolute / self.scale if self.scale else (0.0 if self.absolute == 0 else float("inf"))


def _engine(model: Model, engine: str | AbstractEngine, missing: str) -> AbstractEngine | EngineResult:
    if isinstance(engine, AbstractEngine):
        if engine.labels != model.labels:
            raise InputError(f"engine {engine.name!r} was made for other closures than the model's {model.labels}")
        return engine
    if engine not in _ENGINES:
        raise UnknownName("engine", engine, _ENGINES)
    try:
        return _ENGINES[engine](model.mechanism, model.parameters, model.labels)
    except MechanismError as error:
        return EngineResult(engine, skipped=str(error))
    except VerificationError as error:
        if missing == "raise":
            raise
        return EngineResult(engine, skipped=str(error))


@dataclass(frozen=True, eq=False)
class _Pair:
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
    def _forces(self) -> list[int]:
        """Places of the multipliers that are forces or torques: all but those of Euler parameters' norms."""
        norms = {f"{joint.name} {row}" for joint in self.model.mechanism.joints for row in joint.own_rows}
        return [i for i, label in enumerate(self.model.labels) if label not in norms]

    @cached_property
    def _redundant(self) -> bool:
        mechanism = self.model.mechanism
        return len(self.model.labels) < len(mechanism.holonomic_rows) + len(mechanism.nonholonomic_rows)

    def seen(self, engine: AbstractEngine, state: State, u: FloatArray, w: FloatArray) -> dict[str, _Seen]:
        """All quantities of one state, from the model and from the engine."""
        model, q, t = self.model, state.q, state.t
        q_dot = model.velocity(state)
        q_ddot, lam = engine.forward_dynamics(q, q_dot, u, t)
        seen = {"forward_dynamics": self._seen(model.forward_dynamics(state, u), q_ddot, 1.0)}
        if self._forces:
            ours, theirs = (x[self._forces] for x in (model.reactions(state, u), lam))
            if self._redundant:
                A = model.rows(q, t)[0][self._forces]
                ours, theirs = A.T @ ours, A.T @ theirs
            seen["reactions"] = self._seen(ours, theirs, self._weight)
        if model.independent and len(model.inputs) == len(model.independent):
            theirs, lam = engine.inverse_dynamics(q, q_dot, q_ddot, t)
            ours = model.inverse_dynamics(state, q_ddot[model.independent_columns])
            seen["inverse_dynamics"] = self._seen(ours, theirs, self._weight, gross=np.concatenate([theirs, lam]))
        elif model.independent:
            N = model.null_space(state).N
            moved = q_ddot + N @ w
            forces, at_rest = (engine.generalized_forces(q, q_dot, x, t) for x in (moved, np.zeros_like(moved)))
            ours = model.generalized_forces(state, moved[model.independent_columns])
            gross = np.abs(N).T @ (np.abs(forces - at_rest) + np.abs(at_rest))
            seen["inverse_dynamics"] = self._seen(ours, N.T @ forces, self._weight, gross=gross)
        return seen

    def _seen(self, ours: FloatArray, theirs: FloatArray, typical: float, gross: FloatArray | None = None) -> _Seen:
        """Both sides against the engine's largest entry, or a thousandth of what is typical where that is more."""
        largest = float(np.abs(theirs if gross is None else gross).max())
        return _Seen(ours, theirs, max(largest, _SMALL * typical * min(self._length, 1.0)))


def _discrepancy(pairs: Sequence[_Seen], sampled: Sequence[State]) -> Discrepancy:
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
