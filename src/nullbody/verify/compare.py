"""A model against independent engines: accelerations, inverse-dynamics forces, reactions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from nullbody.errors import InputError, UnknownName, VerificationError
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

    Every engine builds the robot anew from `model.mechanism` and the parameter values, and gets the same q, q'
    and random inputs u. Compared are q'' and lambda for u, and the inputs for the q'' that the engine itself found
    (so that no acceleration of ours enters it).

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
        VerificationError: an engine is not installed, and `missing` is "raise".
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
    drawn = np.random.default_rng([seed, 1]).normal(size=(states, len(model.inputs))) * _input_scale(model)
    tick, ticks = progress or (lambda done, total: None), iter(range(1, total + 1))
    results = []
    for engine in made:
        if isinstance(engine, EngineResult):
            results.append(engine)
            continue
        seen = []
        for state, u in zip(sampled, drawn, strict=True):
            seen.append(_both(model, engine, state, u))
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
    except VerificationError as error:
        if missing == "raise":
            raise
        return EngineResult(engine, skipped=str(error))


def _input_scale(model: Model) -> FloatArray:
    """A typical force [N] or torque [N m]: the total weight on earth, at the typical length."""
    mechanism = model.mechanism
    weight = 10.0 * sum(number(body.mass, model.parameters) for body in mechanism.bodies)
    length = typical_length(model)
    return np.array([weight * (1.0 if mechanism.units[name] == "m" else length) for name in mechanism.actuated])


def _both(model: Model, engine: AbstractEngine, state: State, u: FloatArray) -> dict[str, _Seen]:
    """All quantities of one state, from the model and from the engine."""
    q_dot = model.velocity(state)
    q_ddot, lam = engine.forward_dynamics(state.q, q_dot, u)
    seen = {"forward_dynamics": _Seen(model.forward_dynamics(state, u), q_ddot, float(np.abs(q_ddot).max()))}
    if len(lam):
        seen["reactions"] = _Seen(model.reactions(state, u), lam, float(np.abs(lam).max()))
    if len(model.inputs) == len(model.independent):
        theirs, lam = engine.inverse_dynamics(state.q, q_dot, q_ddot)
        ours = model.inverse_dynamics(state, q_ddot[model.independent_columns])
        seen["inverse_dynamics"] = _Seen(ours, theirs, float(np.abs(np.concatenate([theirs, lam])).max()))
    return seen


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
