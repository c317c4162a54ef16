"""A model against independent engines: accelerations, inverse-dynamics forces, reactions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Literal

import numpy as np

from nullbody.errors import InputError, MechanismError, UnknownName, VerificationError
from nullbody.model import Model, checked_model
from nullbody.verify.engine import AbstractEngine
from nullbody.verify.full_coordinates import MultiplierEngine
from nullbody.verify.mujoco_engine import MujocoEngine
from nullbody.verify.pair import Pair, discrepancy
from nullbody.verify.pinocchio_engine import PinocchioEngine
from nullbody.verify.sample import admissible_states
from nullbody.verify.verification import EngineResult, Verification

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

    Every engine builds the mechanism anew from `model.mechanism` and the parameter values, and gets the same q, q', t
    and random inputs u. Compared are

    - q'' for u;
    - lambda for u but of Euler parameters' norms, which are no forces; A^T lambda where equations repeat others, since
      these may share their forces in many ways;
    - with one input for each degree of freedom, the inputs for the q'' that the engine itself found (so that no
      acceleration of ours enters it); otherwise N^T (M q'' + h) for that q'' and a random addition N w.

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
        VerificationError: an engine is not installed, and `missing` is "raise". One that cannot have the mechanism
            is skipped, with the reason in its result.
        AssemblyError: no admissible states were found.
    """
    checked_model(model)
    _check(states, tolerance, missing)
    made = [_engine(model, engine, missing) for engine in ([engines] if isinstance(engines, str) else engines)]
    sampled, pair = admissible_states(model, states, seed), Pair(model)
    total = states * sum(isinstance(engine, AbstractEngine) for engine in made)
    drawn = np.random.default_rng([seed, 1]).normal(size=(states, len(model.inputs))) * pair.input_scale
    added = np.random.default_rng([seed, 2]).normal(size=(states, len(model.independent))) * pair.rate_scale
    tick, ticks = progress or (lambda done, total: None), iter(range(1, total + 1))

    def result(engine: AbstractEngine | EngineResult) -> EngineResult:
        if isinstance(engine, EngineResult):
            return engine
        seen = []
        for state, u, w in zip(sampled, drawn, added, strict=True):
            seen.append(pair.seen(engine, state, u, w))
            tick(next(ticks), total)
        found = {name: discrepancy([pairs[name] for pairs in seen], sampled) for name in seen[0]}
        return EngineResult(engine.name, engine.version, found)

    names = model.mechanism.name, model.parameters, model.coordinates
    return Verification(
        *names, states=states, seed=seed, tolerance=tolerance, engines=tuple(result(engine) for engine in made)
    )


def _check(states: int, tolerance: float, missing: str) -> None:
    if states < 1 or not tolerance > 0:
        raise InputError(f"compare needs at least one state and a positive tolerance, not {states} and {tolerance}")
    if missing not in ("raise", "skip"):
        raise InputError(f"missing must be 'raise' or 'skip', not {missing!r}")


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
