"""Medians of repeated runs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

__all__ = ["Timing", "measure"]


@dataclass(frozen=True)
class Timing:
    """Seconds a call: median, least and most of the repeats."""

    what: str
    tool: str
    median: float
    least: float
    most: float


def measure(what: str, tool: str, call: Callable[[], object], *, repeats: int = 9, seconds: float = 0.05) -> Timing:
    """Time a call: as many calls a repeat as fill some time, so that the clock's resolution does not matter."""
    call()
    begin = time.perf_counter()
    call()
    once = max(time.perf_counter() - begin, 1e-9)
    calls = max(1, int(seconds / once))
    found = []
    for _ in range(repeats):
        begin = time.perf_counter()
        for _ in range(calls):
            call()
        found.append((time.perf_counter() - begin) / calls)
    return Timing(what, tool, median(found), min(found), max(found))
