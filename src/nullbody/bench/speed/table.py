"""The speed benchmark as tables of text: ratios first, then times, the machine's limit, and how results differ.

The share of the limit is that of the best turn.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from nullbody.bench.speed.effort import SUBJECTS
from nullbody.bench.speed.result import Curve, Goal, Growth, Line, Speed
from nullbody.bench.table import Table, duration, figure

__all__ = ["goal_table", "goal_value", "tables"]

_HEAD = (
    "tool", ">times ours", ">time", ">spread", ">best", ">limit", ">of limit", ">operations", ">deviation", "remark",
)  # fmt: skip
_NOTES = {
    "build": "Medians over new processes; cold and warm ones in turns.",
    "dynamics": "For one state. Limit: operations / peak of one core on single numbers (a fused multiply-add is two); "
    "sines and cosines are not counted as operations. Deviation: relative, from nullbody's result.",
    "batch": "For one state. Limit: operations / peak of one core on whole registers, or bytes / copy bandwidth where "
    "arrays do not fit the caches. Deviation: from single calls, relative to the largest output.",
    "simulate": "For one step of one robot.",
}


def tables(found: Speed) -> list[Table]:
    """All tables, in the order of the subjects."""
    made = [goal_table(found.goals)] if found.goals else []
    for subject in SUBJECTS:
        lines = list(found.of(subject))
        for work in dict.fromkeys(line.work for line in lines):
            rows = tuple(_cells(line) for line in lines if line.work == work)
            made.append(Table(subject, work, _HEAD, rows, _NOTES.get(subject, "")))
        if subject == "simulate" and found.curves:
            made.append(_work_table(found.curves, found.facts.get("reference of the swing", "")))
        if subject == "scaling" and found.growths:
            made.append(_growth_table(found.growths))
    return made


def goal_table(goals: Iterable[Goal]) -> Table:
    """What was set out to reach."""
    note = "Found: by medians of this run, which other work on the machine raises; best turn: the least of them."
    words = {True: "reached", False: "missed", None: "not run"}
    rows = tuple(
        (
            goal.what,
            "-" if goal.found is None else goal_value(goal.found, goal.unit),
            "" if goal.best is None else goal_value(goal.best, goal.unit),
            f"{'at least' if goal.least else 'at most'} {goal_value(goal.goal, goal.unit)}",
            words[goal.reached],
        )
        for goal in goals
    )
    return Table("goals", "goals", ("goal", ">found", ">best turn", ">should be", "verdict"), rows, note)


def goal_value(value: float, unit: str) -> str:
    """A figure of a goal in the unit that suits it."""
    if unit == "s":
        return duration(value)
    return f"{figure(value)} {unit}".strip()


def _cells(line: Line) -> tuple[str, ...]:
    time = line.time
    share = (
        f"{100 * line.limit / (time.best or time.median):.0f} %" if line.limit is not None and time is not None else ""
    )
    return (
        line.tool,
        "" if line.ratio is None else figure(line.ratio),
        "" if time is None else duration(time.median),
        f"{100 * time.spread:.0f} %" if time is not None and time.spread else "",
        "" if time is None or time.best is None else duration(time.best),
        "" if line.limit is None else duration(line.limit),
        share,
        "" if line.operations is None else str(line.operations),
        "" if line.deviation is None else f"{line.deviation:.0e}" if line.deviation else "0",
        line.note,
    )


def _work_table(curves: Sequence[Curve], reference: str) -> Table:
    """Error and time of every setting; ratios to the least time in which this package has no larger error."""
    own = next((curve for curve in curves if curve.kind == "ours"), None)
    rows = []
    for curve in curves:
        for point in curve.points:
            least = own.time_to(point.error) if own is not None else None
            ratio = "" if least is None else figure(point.time.median / least.median)
            error = f"{point.error:.1e}" if point.error < float("inf") else "diverged"
            spread = f"{100 * point.time.spread:.0f} %"
            rows.append((curve.tool, point.setting, ratio, duration(point.time.median), spread, error, curve.note))
    head = ("tool", "setting", ">times ours", ">time", ">spread", ">error", "remark")
    note = (
        f"Error: largest of a coordinate at the end [m, rad]; true end: {reference}. Times ours: to the least time in "
        "which nullbody has no larger error."
    )
    return Table("simulate", "3-PRS, swing below the slides", head, tuple(rows), note)


def _growth_table(growths: Sequence[Growth]) -> Table:
    lengths = sorted({n for growth in growths for n in growth.values})
    rows = []
    for growth in growths:
        count = growth.quantity == "operations"
        known = (growth.values.get(n) for n in lengths)
        cells = ("" if value is None else f"{value:.0f}" if count else duration(value) for value in known)
        power = "" if growth.exponent is None else f"{growth.exponent:.2f}"
        apart = "" if growth.deviation is None else f"{growth.deviation:.0e}" if growth.deviation else "0"
        rows.append((growth.tool, growth.quantity, *cells, power, apart))
    head = ("tool", "quantity", *(f">N = {n}" for n in lengths), ">exponent", ">deviation")
    note = "Exponent p of N^p from N = 5 on. Build: without the cache, all routines. Deviation: largest, relative."
    return Table("scaling", "N four-bars in a row", head, tuple(rows), note)
