"""The programs of a model for marching many states: the rate of (q, v, work), what it must keep, and the correction.

    y = (q, v, W):   q' = N v + beta,   v' = Mr^-1 (Br u - hr),   W' = power;   correction: -B^-1 Phi

All come from the routines of the model; what rate and correction share is evaluated once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from nullbody.kernels import BlockKernel, Composer, March, compile_blocks
from nullbody.kernels.program import Program
from nullbody.tolerances import REGULAR_DOUBT, REGULAR_LOSS, SIMULATED_SPREAD

if TYPE_CHECKING:
    from nullbody.model.model import Model

__all__ = ["GUARDS", "march_of", "measure_of"]

#: The guards in their order: delta keeps its sign, the others their limits.
GUARDS = {"delta": 0.0, "doubt": REGULAR_DOUBT, "spread": SIMULATED_SPREAD, "loss": REGULAR_LOSS}


def march_of(model: Model, *, projection: bool, watch: float | None, doubt: float = REGULAR_DOUBT) -> March:
    """Steps of a model, with or without corrections.

    Args:
        model: the model.
        projection: whether the loops are closed after every step.
        watch: |N|^2, in the measure of the dynamics, at which a robot is taken out; None: at its limit.
        doubt: that no robot may exceed.

    Raises:
        CacheError: the cache cannot be read, written or trusted.
    """
    rate = _rate(model, corrected=False)
    time = None
    if model.rheonomic:
        time = sum(size for name, size in rate.inputs[: [name for name, _ in rate.inputs].index("t")])
    corrected = _rate(model, corrected=True) if projection else rate
    watched = None if watch is None else (list(GUARDS).index("spread"), watch)
    limits = {**GUARDS, "doubt": doubt}
    return March(rate, corrected, list(limits.values())[1:], time, watched)


def measure_of(model: Model) -> BlockKernel:
    """(q, v, [t], p) -> Phi, T, U: what is looked at where results are stored.

    Raises:
        CacheError: the cache cannot be read, written or trusted.
    """
    programs = {name: kernel.program for name, kernel in model.library.kernels.items()}
    composer = Composer("measure", programs["kinematics"].inputs)
    q_dot = composer.call(programs["kinematics"])["q_dot"]
    energy = composer.call(programs["energy"], {"q_dot": q_dot})
    Phi = composer.call(programs["closure"])["Phi"]
    program = composer.program({"Phi": ((len(Phi),), Phi), "T": ((), energy["T"]), "U": ((), energy["U"])})
    return BlockKernel(program, compile_blocks(program))


def _rate(model: Model, *, corrected: bool) -> Program:
    programs = {name: kernel.program for name, kernel in model.library.kernels.items()}
    q, v, *others = programs["forward_dynamics"].inputs
    composer = Composer("march_corrected" if corrected else "march", [q, v, ("work", 1), *others])
    forward = composer.call(programs["forward_dynamics"])
    rate = [*forward["q_dot"], *(forward["q_ddot"][k] for k in model.independent_columns), *forward["power"]]
    guards = [forward[name][0] for name in GUARDS]
    outputs = {"rate": ((len(rate),), rate), "guards": ((len(guards),), guards)}
    if corrected:
        correction = composer.call(programs["closing"])["correction"]
        outputs["correction"] = ((len(correction),), correction)
    return composer.program(outputs)
