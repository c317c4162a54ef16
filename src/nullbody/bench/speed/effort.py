"""How much of the speed benchmark is run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["SUBJECTS", "Effort"]

#: The subjects, and what each shows.
SUBJECTS: Mapping[str, str] = {
    "build": "seconds from bodies, joints and loops to native code",
    "dynamics": "one evaluation of forward and inverse dynamics, 3-PRS",
    "batch": "many states: per state and core, threads, and what memory allows",
    "simulate": "error over wall time of a 3 s swing, 3-PRS; many robots in lock step",
    "scaling": "N four-bars in a row, as N grows",
}


@dataclass(frozen=True)
class Effort:
    """How much is run; `full` and `quick` give the usual ones.

    Attributes:
        repeats: turns of each timing.
        seconds: length of each [s].
        patience: seconds that all turns of one slow timing may take.
        processes: new Python processes that derive and build.
        states: random states of one evaluation.
        batch: states of a batch.
        duration: of the swing [s].
        tolerances: relative ones of adaptive integration.
        timesteps: of fixed steps, MuJoCo [s].
        robots: that are simulated in lock step.
        chains: numbers N of four-bars.
        derivation: seconds that SymPy may take to derive.
        thorough: find the reference motion by two roads, of which one takes most of a minute.
    """

    repeats: int = 15
    seconds: float = 0.02
    patience: float = 2.0
    processes: int = 5
    states: int = 16
    batch: int = 65_536
    duration: float = 3.0
    tolerances: tuple[float, ...] = tuple(10.0**-k for k in range(4, 14))
    timesteps: tuple[float, ...] = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5)
    robots: int = 16_384
    chains: tuple[int, ...] = (1, 2, 5, 10, 20, 40)
    derivation: float = 60.0
    thorough: bool = True

    @classmethod
    def full(cls) -> Effort:
        """Everything: one to two minutes."""
        return cls()

    @classmethod
    def quick(cls) -> Effort:
        """Fewer turns, tolerances, steps and lengths: ten seconds."""
        return cls(
            repeats=5,
            seconds=0.005,
            patience=0.3,
            processes=2,
            states=8,
            batch=16_384,
            tolerances=(1e-4, 1e-6, 1e-8, 1e-9, 1e-11),
            timesteps=(1e-2, 1e-3),
            robots=4_096,
            chains=(1, 5, 10),
            derivation=20.0,
            thorough=False,
        )
