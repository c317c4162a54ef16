"""The whole benchmark of the null space: what is timed runs alone, other tools follow side by side."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from nullbody.bench.accuracy import accuracy, worst
from nullbody.bench.chain import chain_heats, chain_rows
from nullbody.bench.machine import facts
from nullbody.bench.numeric import numeric_rows
from nullbody.bench.pair import pairs
from nullbody.bench.peer import PEERS, Heat, Race
from nullbody.bench.result import Accuracy, Benchmark, Row, Worst
from nullbody.bench.scatter import random_heats, random_rows
from nullbody.bench.settings import Settings
from nullbody.bench.symbolic import peer_rows, robot_heats, symbolic_rows

__all__ = ["bench_null_space", "steps"]

_WORKERS = 2  # processes of other tools side by side
_PACKAGES = ("numpy", "scipy", "llvmlite", "sympy", "symengine", "casadi", "python-flint")


def steps(settings: Settings) -> int:
    """How many steps `bench_null_space` announces."""
    return 2 * len(settings.parts) + 2 * len(settings.chains) * ("chains" in settings.parts)


def bench_null_space(settings: Settings | None = None, step: Callable[[str], None] = lambda name: None) -> Benchmark:
    """Measure this package's null space against the methods of the literature and against other tools.

    Args:
        settings: how much is run; everything by default.
        step: is told the name of each step as it begins.
    """
    chosen = settings or Settings.full()
    begin = time.perf_counter()
    rows = _own(chosen, step)
    race = Race(_heats(chosen), _WORKERS).start()
    try:
        errors: tuple[Accuracy, ...] = ()
        largest: tuple[Worst, ...] = ()
        deltas: dict[float, float] = {}
        if "accuracy" in chosen.parts:
            step("errors near |B| = 0")
            errors, deltas = accuracy()
            step("the worst of many states")
            largest = worst(chosen.accuracy_states, max(2, chosen.accuracy_states // 50))
        step("waiting for other tools")
        laps = race.results()
    except BaseException:
        race.stop()
        raise
    for part in ("symbolic", "chains", "random"):
        names = {name for heat in _heats(chosen.only([part])) for name in heat.matrices}
        rows += peer_rows(part, {key: lap for key, lap in laps.items() if key[0] in names}, rows)
    return Benchmark(
        settings=chosen,
        rows=tuple(rows),
        pairs=pairs(rows, laps),
        accuracy=errors,
        worst=largest,
        deltas=deltas,
        facts=facts(time.perf_counter() - begin, _PACKAGES),
        missing={peer.package: peer.missing for peer in PEERS.values() if peer.missing},
    )


def _own(settings: Settings, step: Callable[[str], None]) -> list[Row]:
    """What is timed here, with nothing beside it."""
    rows: list[Row] = []
    if "symbolic" in settings.parts:
        step("3-PRS, symbols")
        rows += symbolic_rows(settings)
    if "numeric" in settings.parts:
        step("3-PRS, numbers")
        rows += numeric_rows(settings)
    if "chains" in settings.parts:
        step("chains of four-bars")
        for found in chain_rows(settings):
            step(found[0].matrix)
            rows += found
    if "random" in settings.parts:
        step("random matrices")
        for found in random_rows(settings):
            rows += found
    return rows


def _heats(settings: Settings) -> Sequence[Heat]:
    """What other tools are to run."""
    kinds = {"symbolic": robot_heats, "chains": chain_heats, "random": random_heats}
    return [heat for part, heats in kinds.items() if part in settings.parts for heat in heats(settings)]
