"""The benchmark of the null space as sections of a page, in the style of the report."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from nullbody.bench import Benchmark
from nullbody.bench.result import Accuracy, Row
from nullbody.bench.table import Table as Columns
from nullbody.bench.table import tables
from nullbody.report.figure import BLUE, GREY, ORANGE, drawing, svg
from nullbody.report.section import Check, Figure, Part, Section, Table, Text

__all__ = ["accuracy_chart", "null_space_sections", "table_part"]

_TITLES = {
    "paper": "The paper's tables: elimination against determinants",
    "symbolic": "Symbols: the 3-PRS",
    "numeric": "Numbers: the 3-PRS",
    "accuracy": "Accuracy: near |B| = 0",
    "chains": "Chains: four-bars in a row",
    "random": "Random matrices",
}
_WORDS = {
    "symbolic": "Generic: every entry that is no constant is a symbol of its own, 32 in all. Trigonometric: as "
    "functions of the coordinates. s<sub>1</sub>, s<sub>2</sub>, s<sub>3</sub> are independent.",
    "chains": "Relative: one angle for each joint, every four-bar driven by the one before, one degree of freedom. "
    "Absolute: three coordinates for each link, each four-bar on the coupler of the one before.",
}


def null_space_sections(found: Benchmark) -> list[Section]:
    """One section for each part that was run."""
    made = tables(found)
    parts = [part for part in _TITLES if any(table.part == part for table in made)]
    return [_section(part, [table for table in made if table.part == part], found) for part in parts]


def table_part(table: Columns) -> Table:
    """A table of the benchmark as a part of a section."""
    caption = f"{table.title}. {table.note}".rstrip()
    return Table(table.head, table.rows, caption)


def _section(part: str, made: Sequence[Columns], found: Benchmark) -> Section:
    parts: list[Part] = [Text(_WORDS[part])] if part in _WORDS else []
    if part == "accuracy":
        parts.append(Figure(accuracy_chart(found.accuracy), _ACCURACY_CAPTION))
    if part == "chains":
        parts.append(Figure(_growth_chart(list(found.of("chains"))), _GROWTH_CAPTION))
    parts += map(table_part, made)
    return Section(part, _TITLES[part], tuple(parts), tuple(_checks(part, found)))


def _checks(part: str, found: Benchmark) -> Iterable[Check]:
    """What this package set out to reach."""
    rows = list(found.of(part))
    if part == "symbolic":
        for matrix, limit in (("3-PRS generic", 225), ("3-PRS trigonometric", 195)):
            counts = [row.operations for row in rows if row.matrix == matrix and row.kind == "ours" and row.operations]
            yield Check.at_most(f"operations for N, {matrix}", min(counts, default=None), limit)
    if part == "numeric":
        ratios = {row.method: row.ratio for row in rows}
        yield Check.at_least("scipy.linalg.null_space, times longer", ratios.get("scipy.linalg.null_space"), 2000)
        yield Check.at_least("Gauss-Jordan compiled, times longer", ratios.get("Gauss-Jordan compiled"), 20)
    if part == "accuracy":
        own = [entry for entry in found.accuracy if "null_space" in entry.method and entry.kind == "ours"]
        error = max((max(entry.errors.values()) for entry in own), default=None)
        yield Check.at_most("subspace error where columns are chosen anew, any distance", error, 1e-13)
        compiled = next((entry for entry in found.worst if entry.method == "nullbody compiled, N"), None)
        yield Check.at_most("largest |A N| of compiled N", compiled.residual if compiled else None, 1e-15)


_ACCURACY_CAPTION = (
    "Error of the subspace against exact arithmetic, by distance of the robot from |B| = 0, logarithmic; blue this "
    "package, orange others. See that every method with the same fixed columns loses digits alike, whatever its "
    "arithmetic, and that choosing columns by value, or an orthonormal basis, keeps all of them."
)
_SHOWN = {
    "nullbody compiled, N": (BLUE, "-"),
    "nullbody.null_space, columns it chooses": (BLUE, "--"),
    "nullbody.null_space, orthonormal": (BLUE, ":"),
    "Gauss-Jordan": (ORANGE, "-"),
    "Liang-Lance": (ORANGE, "--"),
    "Singh-Likins": (GREY, "-"),
}


def accuracy_chart(entries: Iterable[Accuracy]) -> str:
    """Subspace error over distance."""
    with drawing(8.6, 3.4) as canvas:
        axes = canvas.subplots()
        for entry in entries:
            if entry.method in _SHOWN:
                colour, dashes = _SHOWN[entry.method]
                shown = [(x, max(error, 1e-17)) for x, error in entry.errors.items() if x > 0]
                axes.loglog(*zip(*shown, strict=True), color=colour, linestyle=dashes, marker="o", label=entry.method)
        axes.set_xlabel("distance from |B| = 0 [m]")
        axes.set_ylabel("sine of the angle")
        axes.invert_xaxis()
        axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
        return svg(canvas)


_GROWTH_CAPTION = (
    "Operations for N over the number of four-bars, logarithmic: left relative, right absolute coordinates. See that "
    "the count grows in proportion to the chain, or to the entries of N, where other tools run away or stop early."
)


def _growth_chart(rows: Sequence[Row]) -> str:
    """Operations over the length of the chain, by tool."""
    with drawing(8.6, 3.4) as canvas:
        for place, kind in enumerate(("relative", "absolute"), 1):
            axes = canvas.add_subplot(1, 2, place)
            chosen = [row for row in rows if row.matrix.endswith(kind) and row.operations]
            for number, method in enumerate(dict.fromkeys(row.method for row in chosen)):
                points = [(_length(row), row.operations) for row in chosen if row.method == method]
                own = method.startswith("nullbody")
                dashes = ("-", "--", ":", "-.")[number % 4]
                axes.loglog(*zip(*points, strict=True), color=BLUE if own else ORANGE, linestyle=dashes, marker="o",
                            markersize=4, label=method.removeprefix("nullbody: "))  # fmt: skip
            axes.set_title(kind)
            axes.set_xlabel("four-bars")
            axes.set_ylabel("operations")
            axes.legend(loc="upper left", fontsize=7)
        return svg(canvas)


def _length(row: Row) -> int:
    return int(row.matrix.split()[2].rstrip(","))
