"""Section: the null space against other methods (Tables 3 and 4)."""

from __future__ import annotations

from collections.abc import Mapping

from nullbody.report.case import Case
from nullbody.report.figure import BLUE, GREY, ORANGE, drawing, svg
from nullbody.report.race import Lap
from nullbody.report.section import Check, Figure, Section, Table, Text, number
from nullbody.report.speed import NumericSpeed, SymbolicSpeed

__all__ = ["LIMITS", "null_space"]

#: SymPy baselines in the order in which they run, and what part of the time limit each may take.
LIMITS: Mapping[str, float] = {
    "gauss_jordan": 1.0,
    "nullspace": 0.5,
    "cramer_solve": 1.5,
    "by_value": 0.5,
    "structural": 0.5,
    "lu_solve": 0.5,
}
_PAPER_SYMBOLIC = (298.14, 2.16)  # s, Table 3
_PAPER_NUMERIC = (0.7526e-3, 0.2001e-3)  # s for one, Table 4
_WORDS = {
    "gauss_jordan": "Gauss-Jordan in fixed order, zero test by simplify",
    "nullspace": "Matrix.nullspace()",
    "cramer_solve": "Matrix.cramer_solve (determinants)",
    "by_value": "Gauss-Jordan, pivots chosen by value at a state",
    "structural": "Gauss-Jordan in fixed order, structural zero test",
    "lu_solve": "Matrix.LUsolve",
}
_WRONG = 1e-6  # |A N| / (|A| |N|) above which a result is no null space


def null_space(case: Case, symbolic: SymbolicSpeed, numeric: NumericSpeed, laps: Mapping[str, Lap]) -> Section:
    """Tables 3 and 4 with ours, the paper's numbers, and today's alternatives."""
    first = laps.get("gauss_jordan")
    ratio, bound = _ratio(first, symbolic.seconds)
    informed, _ = _ratio(laps.get("by_value"), symbolic.seconds)
    gauss = numeric.baselines["Gauss-Jordan, row by row (NumPy)"]
    cramer = numeric.baselines["28 determinants (NumPy), the paper's formula"]
    numeric_ratio = gauss / numeric.from_state
    return Section(
        "nullspace",
        "The null space: Tables 3 and 4",
        (
            Text(
                "<b>Symbolic (Table 3).</b> The 9 × 12 matrix <i>A</i> of the 3-PRS has 46 non-zero entries. The "
                "paper reports 298.14 s for Gauss-Jordan elimination and 2.16 s for determinants, in MATLAB. Here "
                "the package's method runs beside SymPy's, each stopped at its time limit. Every result is tested "
                "at a state of the robot: |<i>A N</i>| must vanish there."
            ),
            _symbolic_table(symbolic, laps),
            Text(
                "Why fixed-order elimination fails on this robot: the leading 6 × 6 minor of <i>B</i> (two legs and "
                "the pose) is identically zero, but only through sin² + cos² = 1. A zero test by structure does not "
                "see that and divides by a disguised zero: it finishes fast, with garbage. A zero test by "
                "simplification sees it and does not finish. Pivots chosen by value at a known state (not the "
                f"paper's method, but fair) finish with a right but unsimplified result, {number(informed)} times "
                "slower than the package. The package tests for zero by value in a prime field, where (sin, cos) is "
                "a point of the circle."
            ),
            Text(
                "<b>Numeric (Table 4).</b> One null space from numbers. The paper reports 0.7526 s against 0.2001 s "
                "for 1000 in MATLAB. Determinants alone do not explain that: written in the same interpreted style, "
                f"they take {number(cramer / gauss)} of the time of elimination here. Nor does native code alone: "
                f"elimination compiled alike takes {number(numeric.native_gauss_jordan / numeric.from_matrix)} times "
                "as long as the package's code, which gains by leaving out zeros and sharing parts."
            ),
            _numeric_table(numeric, gauss),
            Figure(
                _chart(numeric),
                "Time for one numeric null space, logarithmic: blue ours, orange other methods on the same "
                "matrices, grey the paper's MATLAB on its machine. See that most of the distance between native "
                "and interpreted code is the interpreter's: Gauss-Jordan compiled alike comes close to ours. See "
                "also that the determinant formula is not much better than elimination when both are interpreted.",
            ),
        ),
        _checks(symbolic, numeric, laps, (ratio, numeric_ratio)),
        {
            "nullspace.symbolic_seconds": symbolic.seconds,
            "nullspace.symbolic_ratio_vs_gauss_jordan": ratio,
            "nullspace.symbolic_ratio_vs_gauss_jordan_is_lower_bound": bound,
            "nullspace.symbolic_ratio_vs_gauss_jordan_by_value": informed,
            "nullspace.symbolic_ratio_vs_cramer_solve": _ratio(laps.get("cramer_solve"), symbolic.seconds)[0],
            "nullspace.numeric_ns": 1e9 * numeric.from_state,
            "nullspace.numeric_ns_from_matrix": 1e9 * numeric.from_matrix,
            "nullspace.numeric_ns_from_python": 1e9 * numeric.from_python,
            "nullspace.numeric_ratio_vs_gauss_jordan": numeric_ratio,
            "nullspace.numeric_ratio_vs_native_gauss_jordan": numeric.native_gauss_jordan / numeric.from_matrix,
        },
    )


def _checks(
    symbolic: SymbolicSpeed, numeric: NumericSpeed, laps: Mapping[str, Lap], ratios: tuple[float | None, float]
) -> tuple[Check, ...]:
    finished = [laps[name] for name in ("by_value", "cramer_solve") if name in laps and laps[name].seconds is not None]
    right = finished[0].residual if finished else None
    return (
        Check.at_least("Symbolic: times faster than Gauss-Jordan", ratios[0], 138, "", "the paper's 138"),
        Check.at_least("Numeric: times faster than Gauss-Jordan", ratios[1], 3.7, "", "the paper's 3.7"),
        Check.at_most("Symbolic null space: seconds", symbolic.seconds, _PAPER_SYMBOLIC[1], "s", "the paper's 2.16 s"),
        Check.at_most("|A N| of the native null space, 64 random states", numeric.residual, 1e-13, "", "rounding"),
        Check.at_most("|A N| of SymPy's result, found the other way", right, 1e-13, "", "a second road"),
    )


def _ratio(lap: Lap | None, ours: float) -> tuple[float | None, bool | None]:
    """How many times slower a baseline is, and whether that is only a lower bound (it was stopped)."""
    if lap is None or (lap.seconds is None and not lap.note.startswith("not finished")):
        return None, None
    return (lap.limit if lap.seconds is None else lap.seconds) / ours, lap.seconds is None


def _symbolic_table(symbolic: SymbolicSpeed, laps: Mapping[str, Lap]) -> Table:
    rows = [
        ("paper, MATLAB: Gauss-Jordan", f"{_PAPER_SYMBOLIC[0]:g} s", "", "", "published"),
        ("paper, MATLAB: determinants", f"{_PAPER_SYMBOLIC[1]:g} s", "", "", "published"),
        ("nullbody: N and Δ N", f"{1e3 * symbolic.seconds:.2f} ms", "1", "yes",
         f"{symbolic.unscaled.arithmetic} and {symbolic.scaled.arithmetic} operations"),
    ]  # fmt: skip
    for method, lap in laps.items():
        ratio, bound = _ratio(lap, symbolic.seconds)
        shown = "-" if ratio is None else f"{'> ' if bound else ''}{number(ratio)}"
        took = lap.note if lap.seconds is None else f"{lap.seconds:.2f} s"
        rows.append((f"SymPy: {_WORDS[method]}", took, shown, _rightness(lap), ""))
    head = ("method", ">time", ">times ours", "right?", "remark")
    note = "One symbolic null space of the 3-PRS. Ours: median over fresh graphs, nothing remembered between repeats."
    return Table(head, tuple(rows), note)


def _rightness(lap: Lap) -> str:
    if lap.seconds is None:
        return "-"
    if lap.residual is None:
        return "no: not a number at the state"
    return "yes" if lap.residual < _WRONG else f"no: |A N| = {number(lap.residual, 2)}"


def _numeric_table(numeric: NumericSpeed, gauss: float) -> Table:
    rows = [
        ("paper, MATLAB: Gauss-Jordan", _time(_PAPER_NUMERIC[0]), "", "published, its machine"),
        ("paper, MATLAB: proposed", _time(_PAPER_NUMERIC[1]), "3.7", "published, its machine"),
        (
            "nullbody, native: state to N",
            _time(numeric.from_state),
            number(gauss / numeric.from_state),
            "sines, cosines and A included",
        ),
        (
            "nullbody, native: entries of A to N",
            _time(numeric.from_matrix),
            number(gauss / numeric.from_matrix),
            "the same task as below",
        ),
        (
            "Gauss-Jordan, native: entries of A to N",
            _time(numeric.native_gauss_jordan),
            number(gauss / numeric.native_gauss_jordan),
            "compiled like ours, pivots fixed",
        ),
        (
            "nullbody, called from Python: N, γ, q'",
            _time(numeric.from_python),
            number(gauss / numeric.from_python),
            "one state at a time",
        ),
        *((name, _time(seconds), number(gauss / seconds), "") for name, seconds in numeric.baselines.items()),
    ]
    note = (
        "Time for one null space; median over repeated passes through 64 random states. Native: a compiled loop "
        "calls the kernel, so Python does not count; NumPy's rows include the interpreter, as MATLAB's did."
    )
    return Table(("method", ">time", ">times faster than NumPy Gauss-Jordan", "remark"), tuple(rows), note)


def _time(seconds: float) -> str:
    return f"{1e9 * seconds:.0f} ns" if seconds < 1e-6 else f"{1e6 * seconds:.1f} µs"


def _chart(numeric: NumericSpeed) -> str:
    bars = [
        ("paper: Gauss-Jordan", _PAPER_NUMERIC[0], GREY),
        ("paper: proposed", _PAPER_NUMERIC[1], GREY),
        *((name.split(",")[0].split("(")[0].strip(), seconds, ORANGE) for name, seconds in numeric.baselines.items()),
        ("Gauss-Jordan, native", numeric.native_gauss_jordan, ORANGE),
        ("ours, called from Python", numeric.from_python, BLUE),
        ("ours, native: state to N", numeric.from_state, BLUE),
        ("ours, native: A to N", numeric.from_matrix, BLUE),
    ]
    with drawing(8.6, 3.3) as canvas:
        axes = canvas.subplots()
        for place, (_, seconds, colour) in enumerate(reversed(bars)):
            axes.barh(place, seconds, left=0, color=colour, height=0.68)
            axes.text(seconds * 1.12, place, _time(seconds), va="center", fontsize=8.5)
        axes.set_yticks(range(len(bars)), [label for label, _, _ in reversed(bars)])
        axes.set_xscale("log")
        axes.set_xlim(1e-8, 5e-3)
        axes.grid(visible=False, axis="y")
        axes.set_xlabel("time for one null space [s]")
        return svg(canvas)
