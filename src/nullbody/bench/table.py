"""The benchmark as tables of text: what is fastest and right can be seen at a glance, ratios come first."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from nullbody.bench.result import Accuracy, Benchmark, Pair, Row, Worst

__all__ = ["Table", "accuracy_table", "duration", "figure", "pair_table", "row_table", "tables", "worst_table"]


@dataclass(frozen=True)
class Table:
    """A table of text; columns whose head starts with ">" are flushed right.

    Attributes:
        part: key of `PARTS`, or "paper".
        title: what it shows.
        head, rows: its cells.
        note: how to read it.
    """

    part: str
    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


_LOST = 0.5  # the sine from which on nothing is left of a subspace
_ROW_HEAD = ("method", ">times ours", ">time", ">spread", ">operations", ">|A N|", "remark")
_NOTES = {
    "symbolic": "Times to derive N of symbols; operations after common parts are shared. |A N| relative, at a state of "
    "the robot: there LU in fixed order divides by a zero that only sin² + cos² = 1 shows.",
    "numeric": "Times for one null space of numbers, over random states. Compiled: a native loop calls the code, data "
    "in the cache; the other rows include Python, as the paper's MATLAB did.",
    "random": "Entries between 1/2 and 3/2 in size; sparse methods say how many entries of N are not 0.",
}


def tables(found: Benchmark) -> list[Table]:
    """All tables of a benchmark, in the order of its parts."""
    made = pair_tables(found.pairs)
    for part in ("symbolic", "numeric"):
        made += [row_table(part, matrix, found.of(part, matrix)) for matrix in _matrices(found.of(part))]
    if found.accuracy:
        made += [accuracy_table(found), worst_table(found.worst)]
    made += _chain_tables(list(found.of("chains")))
    made += [row_table("random", matrix, found.of("random", matrix)) for matrix in _matrices(found.of("random"))]
    return made


def pair_tables(pairs: Sequence[Pair]) -> list[Table]:
    """The paper's tables 3 and 4, where they were measured."""
    return [pair_table(number, pairs) for number in (3, 4) if sum(pair.table == number for pair in pairs) > 1]


def pair_table(number: int, pairs: Iterable[Pair]) -> Table:
    """Table 3 (symbols) or 4 (numbers) in the paper's form."""
    rows = [
        (
            pair.tool,
            f"{'> ' if pair.bound else ''}{duration(pair.conventional)}",
            duration(pair.proposed),
            f"{'> ' if pair.bound else ''}{figure(pair.ratio)}",
            pair.note,
        )
        for pair in pairs
        if pair.table == number
    ]
    kind = {3: "one null space of symbols", 4: "one null space of numbers"}[number]
    head = ("where", ">Gauss-Jordan", ">determinants", ">ratio", "remark")
    return Table("paper", f"Table {number} of the paper: {kind} of the 3-PRS", head, tuple(rows))


def row_table(part: str, title: str, rows: Iterable[Row]) -> Table:
    """The rows of one matrix."""
    return Table(part, title, _ROW_HEAD, tuple(map(_cells, rows)), _NOTES.get(part, ""))


def _cells(row: Row) -> tuple[str, ...]:
    remark = row.note
    if row.nonzeros is not None and row.part != "numeric":
        remark = f"{row.nonzeros} entries" + (f"; {remark}" if remark else "")
    return (
        row.method,
        "" if row.ratio is None else f"{'> ' if row.bound else ''}{figure(row.ratio)}",
        "" if row.time is None else duration(row.time.median),
        f"{100 * row.time.spread:.0f} %" if row.time is not None and row.time.spread else "",
        "" if row.operations is None else str(row.operations),
        "" if row.residual is None else f"{row.residual:.0e}",
        remark,
    )


def accuracy_table(found: Benchmark) -> Table:
    """The subspace error by distance from |B| = 0."""
    distances = list(found.deltas)
    rows = [_accuracy_cells(entry, distances) for entry in found.accuracy]
    head = ("method", *(f">{distance:.0e}" if distance else ">0" for distance in distances), ">|A N|", ">|cos|")
    note = (
        "Sine of the angle to the exact null space (rational arithmetic); lost: 0.5 or more. Distance: displacement of "
        "the platform's height y from the state with |B| = 0; A keeps its rank there. |A N|: largest over all "
        "distances; small even where the subspace is lost (Liang-Lance excepted). |cos|: largest between two columns; "
        "1: two columns parallel. Read: every fixed choice of columns loses digits alike; free choice and orthonormal "
        "bases (but Liang-Lance's) do not."
    )
    return Table("accuracy", "3-PRS: error of the subspace by distance [m] from |B| = 0", head, tuple(rows), note)


def _accuracy_cells(entry: Accuracy, distances: Sequence[float]) -> tuple[str, ...]:
    errors = (f"{entry.errors[distance]:.0e}" if entry.errors[distance] < _LOST else "lost" for distance in distances)
    return (entry.method, *errors, f"{_largest(entry.residuals):.0e}", f"{_largest(entry.orthogonality):.2f}")


def _largest(found: Mapping[float, float]) -> float:
    return max((x for x in found.values() if math.isfinite(x)), default=math.nan)


def worst_table(found: Iterable[Worst]) -> Table:
    """The worst of many states."""
    rows = tuple(
        (entry.method, f"{entry.residual:.1e}", str(entry.states), f"{entry.error:.1e}", str(entry.exact))
        for entry in found
    )
    head = ("method", ">largest |A N|", ">states", ">largest subspace error", ">states")
    note = "Compiled: A to N; from the state: q to N."
    return Table("accuracy", "3-PRS, random regular states: the worst", head, rows, note)


def _chain_tables(rows: Sequence[Row]) -> list[Table]:
    """For both kinds of coordinates: operations, time to derive, time for numbers; columns grow with the chain."""
    made = []
    for kind in ("relative", "absolute"):
        own = [row for row in rows if f", {kind}" in row.matrix]
        symbols = [row for row in own if "numbers" not in row.matrix]
        numbers = [row for row in own if "numbers" in row.matrix]
        made += [
            _grown(f"chains, {kind} coordinates: operations for N", symbols, _operations),
            _grown(f"chains, {kind} coordinates: time to derive N", symbols, _seconds),
            _grown(f"chains, {kind} coordinates: time for N of numbers", numbers, _seconds),
            _grown(f"chains, {kind} coordinates: times longer than 8-wide compiled code", numbers, _times),
        ]
    return [table for table in made if table.rows]


def _grown(title: str, rows: Sequence[Row], cell: Callable[[Row], str]) -> Table:
    matrices = _matrices(rows)
    methods = list(dict.fromkeys(row.method for row in rows))
    known = {(row.method, row.matrix): cell(row) for row in rows}
    lines = tuple((method, *(known.get((method, matrix), "") for matrix in matrices)) for method in methods)
    head = ("method", *(f">{matrix.partition(',')[0].removeprefix('chain of ')}" for matrix in matrices))
    return Table("chains", title, head, lines)


def _operations(row: Row) -> str:
    return "" if row.operations is None else str(row.operations)


def _seconds(row: Row) -> str:
    if row.time is not None:
        return duration(row.time.median)
    return f"> {row.note.removeprefix('not finished within ')}" if row.bound else "-"


def _times(row: Row) -> str:
    return "" if row.ratio is None else f"{'> ' if row.bound else ''}{figure(row.ratio)}"


def _matrices(rows: Iterable[Row]) -> list[str]:
    return list(dict.fromkeys(row.matrix for row in rows))


def duration(seconds: float) -> str:
    """A time in the unit that suits it: 11.3 ns, 0.23 ms, 298 s."""
    for unit, size in (("ns", 1e-9), ("µs", 1e-6), ("ms", 1e-3)):
        if seconds < 999.5 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.4g} s"


def figure(value: float) -> str:
    """A ratio in three digits: 0.0123, 1.27, 31 400."""
    if value >= 999.5:
        digits = 3 - len(f"{value:.0f}")
        return f"{round(value, digits):,.0f}".replace(",", " ")
    return f"{value:.3g}"
