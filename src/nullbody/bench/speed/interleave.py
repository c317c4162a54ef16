"""Contestants timed in turns: what disturbs the machine for a while disturbs all of them alike.

Times are those of the thread on its core, which do not run while the system gives the core to others; on a machine with
nothing else to do they are those of the clock on the wall. Work of several threads is timed by that clock.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from statistics import median

from nullbody.bench.timing import Timing, Work

__all__ = ["CLOCK", "Turns", "calls_of", "interleaved"]

#: Seconds of this thread on its core; Windows counts them in steps of 16 ms, too coarse.
CLOCK: Callable[[], float] = time.perf_counter if sys.platform == "win32" else time.thread_time

_GROWTH = 8  # factor of rounds while their number is being found


@dataclass(frozen=True)
class Turns:
    """Seconds that one call of each work took, turn by turn.

    Attributes:
        seconds: by name; something slow has fewer turns.
    """

    seconds: Mapping[str, Sequence[float]]

    def timing(self, name: str) -> Timing:
        """Median and spread."""
        return Timing.of(self.seconds[name])

    def ratio(self, name: str, reference: str) -> float:
        """How many times longer than the reference: the median over the turns that both had."""
        pairs = zip(self.seconds[name], self.seconds[reference], strict=False)
        return median(one / other for one, other in pairs)


def calls_of(functions: Sequence[Callable[[], object]]) -> Work:
    """Python calls of some functions, one after the other."""

    def run(rounds: int) -> None:
        for _ in range(rounds):
            for function in functions:
                function()

    return Work(run, len(functions))


def interleaved(
    works: Mapping[str, Work],
    repeats: int,
    seconds: float,
    patience: float = 1.0,
    least: int = 3,
    clock: Callable[[], float] = CLOCK,
    wall: Callable[[], float] = time.perf_counter,
) -> Turns:
    """The seconds that one call takes, of all works in turns.

    Args:
        works: by name.
        repeats: turns.
        seconds: length of one measurement; a slow work is done once.
        patience: seconds that all turns of one work may take; it has fewer turns then.
        least: turns of something slow, however long they take.
        clock: tells the time of this thread [s].
        wall: tells the time of works that use several threads [s].
    """

    def measured(work: Work, rounds: int) -> float:
        time_of = wall if work.threads else clock
        begin = time_of()
        work.run(rounds)
        return time_of() - begin

    rounds = {name: _rounds(partial(measured, work), seconds) for name, work in works.items()}
    found: dict[str, list[float]] = {name: [] for name in works}
    spent = dict.fromkeys(works, 0.0)
    for turn in range(repeats):
        for name, work in works.items():
            if turn < least or spent[name] < patience:
                elapsed = measured(work, rounds[name])
                spent[name] += elapsed
                found[name].append(elapsed / (rounds[name] * work.calls))
    return Turns(found)


def _rounds(measured: Callable[[int], float], seconds: float) -> int:
    """How many rounds last about so long; the first one, which pays for what is loaded on first use, does not count."""
    if measured(1) >= seconds:
        return 1
    rounds = 1
    while (elapsed := measured(rounds)) * _GROWTH < seconds:
        rounds *= _GROWTH
    return max(1, round(rounds * seconds / elapsed))
