"""How much of the benchmark is run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from nullbody.errors import InputError, UnknownName

__all__ = ["PARTS", "Settings"]

#: The parts of the benchmark, and what each shows.
PARTS: Mapping[str, str] = {
    "symbolic": "N of symbols, 3-PRS: this package, SymPy, SymEngine, CasADi, FLINT",
    "numeric": "N of numbers, 3-PRS: compiled, and all methods of the literature",
    "accuracy": "errors near |B| = 0 against exact arithmetic",
    "chains": "N four-bars in a row: operations and seconds as they grow",
    "random": "dense, sparse and banded matrices",
}

#: Methods of other tools that a quick run keeps.
_QUICK = ("gauss_jordan", "nullspace", "by_value", "symengine_lu", "casadi_solve", "flint_minors")


@dataclass(frozen=True)
class Settings:
    """How much is run; `full` and `quick` give the usual ones.

    Attributes:
        parts: keys of `PARTS`.
        limit: seconds after which a method of another tool is stopped, for each matrix.
        repeats: of each timing.
        patience: seconds that a slow timing may take in all.
        states: random states that numeric methods go through.
        accuracy_states: random regular states whose worst error is sought.
        chains: numbers of four-bars.
        search: other ways of writing that are tried for fewer operations.
        peers: methods of other tools that run on the 3-PRS; all where it is empty.
        growing: methods that run on chains, from short to long ones until they are stopped.
        scattered: methods that run on random matrices.
    """

    parts: tuple[str, ...] = tuple(PARTS)
    limit: float = 8.0
    repeats: int = 9
    patience: float = 0.4
    states: int = 64
    accuracy_states: int = 10_000
    chains: tuple[int, ...] = (1, 2, 4, 10, 40)
    search: int = 60
    peers: tuple[str, ...] = ()
    growing: tuple[str, ...] = ("nullspace", "domain_nullspace", "lu_solve", "casadi_solve", "symengine_lu")
    scattered: tuple[str, ...] = ("lu_solve", "casadi_solve", "symengine_lu")

    @classmethod
    def full(cls) -> Settings:
        """Everything: three to four minutes on two cores."""
        return cls()

    @classmethod
    def quick(cls) -> Settings:
        """The main rows of every part: half a minute."""
        return cls(
            limit=2.0,
            repeats=5,
            patience=0.1,
            accuracy_states=500,
            chains=(1, 4, 10),
            search=10,
            peers=_QUICK,
            growing=("casadi_solve", "symengine_lu"),
            scattered=("casadi_solve", "symengine_lu"),
        )

    def only(self, parts: Iterable[str]) -> Settings:
        """The same with some of the parts.

        Raises:
            UnknownName: there is no such part.
        """
        chosen = tuple(parts)
        for part in chosen:
            if part not in PARTS:
                raise UnknownName("part of the benchmark", part, PARTS)
        return replace(self, parts=tuple(part for part in PARTS if part in chosen))

    def limited(self, seconds: float) -> Settings:
        """The same with another time limit for other tools.

        Raises:
            InputError: it is negative, or no number.
        """
        if not 0 <= seconds < float("inf"):
            raise InputError(f"the time limit must be a number of seconds, 0 or more, not {seconds}")
        return replace(self, limit=seconds)
