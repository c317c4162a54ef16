"""Section: the null space against other methods (Tables 3 and 4), a part of `nullbody bench nullspace`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from nullbody.bench import Settings as Measured
from nullbody.bench.accuracy import accuracy
from nullbody.bench.numeric import numeric_rows
from nullbody.bench.pair import PAPER, pairs
from nullbody.bench.peer import Heat, Lap
from nullbody.bench.result import Accuracy, Row
from nullbody.bench.symbolic import peer_rows, referred, symbolic_rows
from nullbody.bench.table import duration, pair_table, row_table
from nullbody.report.benchmark import accuracy_chart, table_part
from nullbody.report.case import Settings
from nullbody.report.figure import BLUE, GREY, ORANGE, drawing, svg
from nullbody.report.section import Check, Figure, Section, Text, number

__all__ = ["NullSpaceFigures", "heats", "measured_null_spaces", "null_space"]

_ROBOT = "three_prs_trigonometric"
_NAME = "3-PRS trigonometric"

#: SymPy's methods in the order in which they run, and what part of the time limit each may take.
_LIMITS: Mapping[str, float] = {
    "gauss_jordan": 1.0,
    "nullspace": 0.5,
    "cramer_solve": 1.5,
    "by_value": 0.5,
    "structural": 0.5,
    "lu_solve": 0.5,
}
_STATE, _STATE_WIDE = "nullbody compiled: state to N", "nullbody compiled, 8-wide: state to N"
_MATRIX, _MATRIX_WIDE = "nullbody compiled: A to N", "nullbody compiled, 8-wide: A to N"
_GAUSS, _GAUSS_COMPILED, _CRAMER = "Gauss-Jordan", "Gauss-Jordan compiled", "determinants"


@dataclass(frozen=True)
class NullSpaceFigures:
    """What was timed alone, before anything ran beside it."""

    symbolic: Sequence[Row]
    numeric: Sequence[Row]
    accuracy: Sequence[Accuracy]

    def seconds(self, method: str) -> float:
        """The median time of a method of numbers [s]."""
        return next(row.time.median for row in self.numeric if row.method == method and row.time is not None)


def measured_null_spaces(settings: Settings) -> NullSpaceFigures:
    """The quick parts of the benchmark."""
    chosen = Measured(repeats=settings.repeats, patience=0.1, search=0)
    return NullSpaceFigures(symbolic_rows(chosen), numeric_rows(chosen), accuracy()[0])


def heats(settings: Settings) -> list[Heat]:
    """What SymPy is to try on the robot's matrix."""
    return [Heat(method, (_ROBOT,), share * settings.symbolic_limit) for method, share in _LIMITS.items()]


def null_space(found: NullSpaceFigures, laps: Mapping[tuple[str, str], Lap]) -> Section:
    """Tables 3 and 4 with ours, the paper's numbers, and today's alternatives."""
    rows = [*found.symbolic, *found.numeric]
    compared = pairs(rows, laps)
    symbolic = [row for row in found.symbolic if row.matrix == _NAME] + peer_rows("symbolic", laps, found.symbolic)
    informed = _ratio(laps, "by_value", found)[0]
    parts = (
        Text(
            "<b>Symbolic (Table 3).</b> The 9 × 12 matrix <i>A</i> of the 3-PRS has 46 non-zero entries. The paper "
            "reports 298.14 s for Gauss-Jordan elimination and 2.16 s for determinants, in MATLAB. Here the package's "
            "method runs beside SymPy's, each stopped at its time limit. Every result is tested at a state of the "
            "robot: |<i>A N</i>| must vanish there. <code>nullbody bench nullspace</code> adds other tools, chains of "
            "loops and random matrices."
        ),
        table_part(pair_table(3, compared)),
        table_part(row_table("symbolic", _NAME, symbolic)),
        Text(
            "Why fixed-order elimination fails on this robot: the leading 6 × 6 minor of <i>B</i> (two legs and the "
            "pose) is identically zero, but only through sin² + cos² = 1. A zero test by structure does not see that "
            "and divides by a disguised zero: it finishes fast, with garbage. A zero test by simplification sees it "
            "and does not finish. Pivots chosen by value at a known state (not the paper's method, but fair) finish "
            f"with a right but unsimplified result, {number(informed)} times slower than the package. The package "
            "tests for zero by value in a prime field, where (sin, cos) is a point of the circle."
        ),
        Text(
            "<b>Numeric (Table 4).</b> One null space from numbers. The paper reports 0.7526 s against 0.2001 s for "
            "1000 in MATLAB. Determinants alone do not explain that: written in the same interpreted style, they take "
            f"{number(found.seconds(_CRAMER) / found.seconds(_GAUSS))} of the time of elimination here. Nor does "
            "native code alone: elimination compiled alike takes "
            f"{number(found.seconds(_GAUSS_COMPILED) / found.seconds(_MATRIX))} times as long as the package's code, "
            "which gains by leaving out zeros and sharing parts, and as much again by taking 8 states at a time."
        ),
        table_part(pair_table(4, compared)),
        table_part(row_table("numeric", "Numbers of the 3-PRS", found.numeric)),
        Figure(
            _chart(found.numeric),
            "Time for one numeric null space, logarithmic: blue ours, orange other methods on the same matrices, grey "
            "the paper's MATLAB on its machine. See that most of the distance between native and interpreted code is "
            "the interpreter's: Gauss-Jordan compiled alike comes close to ours. See also that the determinant formula "
            "is not much better than elimination when both are interpreted.",
        ),
        Figure(
            accuracy_chart(found.accuracy),
            "Error of the subspace against exact arithmetic, by distance of the robot from |B| = 0, logarithmic. See "
            "that determinants and elimination lose digits alike while their columns are fixed, and that columns "
            "chosen by value, or an orthonormal basis, keep all of them.",
        ),
    )
    return Section("nullspace", "The null space: Tables 3 and 4", parts, _checks(found, laps), _numbers(found, laps))


def _numbers(found: NullSpaceFigures, laps: Mapping[tuple[str, str], Lap]) -> dict[str, float | bool | None]:
    """Entries of summary.json."""
    ratio, bound = _ratio(laps, "gauss_jordan", found)
    return {
        "nullspace.symbolic_seconds": _derivation(found),
        "nullspace.symbolic_ratio_vs_gauss_jordan": ratio,
        "nullspace.symbolic_ratio_vs_gauss_jordan_is_lower_bound": bound,
        "nullspace.symbolic_ratio_vs_gauss_jordan_by_value": _ratio(laps, "by_value", found)[0],
        "nullspace.symbolic_ratio_vs_cramer_solve": _ratio(laps, "cramer_solve", found)[0],
        "nullspace.numeric_ns": 1e9 * found.seconds(_STATE),
        "nullspace.numeric_ns_8_wide": 1e9 * found.seconds(_STATE_WIDE),
        "nullspace.numeric_ns_from_matrix": 1e9 * found.seconds(_MATRIX),
        "nullspace.numeric_ns_from_matrix_8_wide": 1e9 * found.seconds(_MATRIX_WIDE),
        "nullspace.numeric_ns_from_python": 1e9 * found.seconds("nullbody, called from Python"),
        "nullspace.numeric_ratio_vs_gauss_jordan": found.seconds(_GAUSS) / found.seconds(_STATE),
        "nullspace.numeric_ratio_vs_native_gauss_jordan": found.seconds(_GAUSS_COMPILED) / found.seconds(_MATRIX),
    }


def _checks(found: NullSpaceFigures, laps: Mapping[tuple[str, str], Lap]) -> tuple[Check, ...]:
    finished = [laps[_ROBOT, name] for name in ("by_value", "cramer_solve") if (_ROBOT, name) in laps]
    right = next((lap.residual for lap in finished if lap.seconds is not None), None)
    ratio, numeric = _ratio(laps, "gauss_jordan", found)[0], found.seconds(_GAUSS) / found.seconds(_STATE)
    residual = max(row.residual for row in found.numeric if row.kind == "ours" and row.residual is not None)
    chosen = next(entry for entry in found.accuracy if "chooses" in entry.method)
    return (
        Check.at_least("Symbolic: times faster than Gauss-Jordan", ratio, 138, "", "the paper's 138"),
        Check.at_least("Numeric: times faster than Gauss-Jordan", numeric, 3.7, "", "the paper's 3.7"),
        Check.at_most("Symbolic null space: seconds", _derivation(found), PAPER[0].proposed, "s", "the paper's 2.16 s"),
        Check.at_most("|A N| of the null space, 64 random states", residual, 1e-13, "", "rounding"),
        Check.at_most("|A N| of SymPy's result, found the other way", right, 1e-13, "", "a second road"),
        Check.at_most(
            "Subspace error at any distance from |B| = 0", max(chosen.errors.values()), 1e-13, "", "rounding"
        ),
    )


def _derivation(found: NullSpaceFigures) -> float:
    """Seconds to derive N of the robot's matrix."""
    return next(row.time.median for row in found.symbolic if row.matrix == _NAME and row.reference and row.time)


def _ratio(
    laps: Mapping[tuple[str, str], Lap], method: str, found: NullSpaceFigures
) -> tuple[float | None, bool | None]:
    """How many times slower a method of SymPy is, and whether that is only a lower bound; nothing if it did not run."""
    lap = laps.get((_ROBOT, method))
    if lap is None or (lap.seconds is None and not lap.stopped):
        return None, None
    return referred(lap, _NAME, found.symbolic)


def _chart(rows: Sequence[Row]) -> str:
    bars = [("paper: Gauss-Jordan", PAPER[1].conventional, GREY), ("paper: proposed", PAPER[1].proposed, GREY)]
    timed = sorted((row for row in rows if row.time is not None), key=lambda row: -row.time.median if row.time else 0)
    for row in timed:
        if row.time is not None:
            bars.append(
                (row.method.replace("nullbody", "ours"), row.time.median, BLUE if row.kind == "ours" else ORANGE)
            )
    with drawing(8.6, 0.23 * len(bars) + 0.6) as canvas:
        axes = canvas.subplots()
        for place, (_, seconds, colour) in enumerate(reversed(bars)):
            axes.barh(place, seconds, left=0, color=colour, height=0.68)
            axes.text(seconds * 1.12, place, duration(seconds), va="center", fontsize=8.5)
        axes.set_yticks(range(len(bars)), [label for label, _, _ in reversed(bars)])
        axes.set_xscale("log")
        axes.set_xlim(0.5 * min(seconds for _, seconds, _ in bars), 4 * max(seconds for _, seconds, _ in bars))
        axes.grid(visible=False, axis="y")
        axes.set_xlabel("time for one null space [s]")
        return svg(canvas)
