"""The paper's tables 3 and 4: elimination against determinants, in every tool that has both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from nullbody.bench.peer import Lap
from nullbody.bench.result import Pair, Row

__all__ = ["PAPER", "pairs"]

#: The paper's own, MATLAB on its machine [s].
PAPER = (
    Pair(3, "the paper, MATLAB", 298.14, 2.16, note="published, its machine"),
    Pair(4, "the paper, MATLAB", 0.7526e-3, 0.2001e-3, note="published, its machine"),
)

_ROBOT = "three_prs_trigonometric"


def pairs(rows: Sequence[Row], laps: Mapping[tuple[str, str], Lap]) -> tuple[Pair, ...]:
    """What was measured, in the paper's form; lines whose halves were not both measured are left out."""
    found = [PAPER[0], *_symbolic(rows, laps), PAPER[1], *_numeric(rows)]
    return tuple(found) if len(found) > len(PAPER) else ()


def _symbolic(rows: Sequence[Row], laps: Mapping[tuple[str, str], Lap]) -> list[Pair]:
    elimination, determinants = laps.get((_ROBOT, "gauss_jordan")), laps.get((_ROBOT, "cramer_solve"))
    informed = laps.get((_ROBOT, "by_value"))
    own = next((row.time for row in rows if row.matrix == "3-PRS trigonometric" and row.reference), None)
    found = []
    if elimination is not None and (elimination.seconds or elimination.stopped):
        seconds = elimination.seconds or elimination.limit
        if determinants is not None and determinants.seconds:
            found.append(Pair(3, "SymPy, both", seconds, determinants.seconds, elimination.stopped))
        if own is not None:
            note = "zero test by simplify"
            found.append(Pair(3, "SymPy against nullbody", seconds, own.median, elimination.stopped, note))
    if informed is not None and informed.seconds and own is not None:
        note = "pivots chosen by value: SymPy is given our zero test"
        found.append(Pair(3, "SymPy against nullbody", informed.seconds, own.median, note=note))
    return found


def _numeric(rows: Sequence[Row]) -> list[Pair]:
    seconds = {row.method: row.time.median for row in rows if row.part == "numeric" and row.time is not None}
    wanted = (
        ("NumPy, interpreted, both", "Gauss-Jordan", "determinants", "28 determinants one by one"),
        ("compiled, both", "Gauss-Jordan compiled", "nullbody compiled: A to N", ""),
        ("compiled 8-wide, both", "Gauss-Jordan compiled, 8-wide", "nullbody compiled, 8-wide: A to N", ""),
        ("NumPy against nullbody 8-wide", "Gauss-Jordan", "nullbody compiled, 8-wide: A to N", ""),
    )
    return [
        Pair(4, tool, seconds[slow], seconds[fast], note=note)
        for tool, slow, fast, note in wanted
        if slow in seconds and fast in seconds
    ]
