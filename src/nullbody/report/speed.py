"""The speed benchmark as sections of a page: goals, figures, tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from nullbody.bench.speed import SUBJECTS, Curve, Growth, Line, Speed
from nullbody.bench.speed.table import goal_value, tables
from nullbody.bench.table import duration, figure
from nullbody.report.benchmark import table_part
from nullbody.report.figure import BLACK, BLUE, COLOURS, GREY, ORANGE, PURPLE, SKY, drawing, svg
from nullbody.report.section import Check, Figure, Part, Section, Text

__all__ = ["growth_chart", "line_chart", "speed_sections", "work_chart"]

_TITLES = {
    "build": "Derive and build",
    "dynamics": "One evaluation: forward and inverse dynamics",
    "batch": "Many states at once",
    "simulate": "Simulation: work and precision",
    "scaling": "Growth: N four-bars in a row",
}
_WORDS = {
    "build": "A closed-form model costs its derivation and its compilation once; the code stays in the kernel cache. "
    "Engines start at once and evaluate the tree anew at every call.",
    "dynamics": "The 3-PRS at random states: the same q, rates and inputs for all, every result compared before "
    "anything is timed. All are called in turns, so that whatever disturbs the machine disturbs all of them.",
    "batch": "Blocks of 8 states fill the vector registers. Where arrays are larger than the caches, packing and "
    "memory take their part.",
    "simulate": "A free swing of the 3-PRS below its slides: the error of its coordinates at the end over the time it "
    "took, for every tool at several settings.",
    "scaling": "The IFToMM benchmark A02: every loop adds two angles and knows its neighbours only, and there is one "
    "degree of freedom however long the row.",
}


def speed_sections(found: Speed) -> list[Section]:
    """Goals first, then every subject that was run."""
    made = tables(found)
    sections = [_goals(found)] if found.goals else []
    for subject in SUBJECTS:
        own = [table for table in made if table.part == subject]
        if own:
            parts: list[Part] = [Text(_WORDS[subject]), *_figures(subject, found), *map(table_part, own)]
            sections.append(Section(subject, _TITLES[subject], tuple(parts)))
    return sections


def _goals(found: Speed) -> Section:
    checks = []
    for goal in found.goals:
        value = goal_value(goal.goal, goal.unit)
        what = f"{goal.what}: {'at least' if goal.least else 'at most'} {value}"
        make = Check.at_least if goal.least else Check.at_most
        checks.append(make(what, goal.found, goal.goal, goal.unit))
    limits = found.limits
    text = (
        f"One core of this machine was measured at {limits['vector'] / 1e9:.3g}e9 operations per second on registers "
        f"of {limits['lanes']:.0f} numbers, at {limits['scalar'] / 1e9:.3g}e9 on single numbers (a fused multiply-add "
        f"counts as two); a copy moves {limits['bandwidth'] / 1e9:.3g}e9 bytes per second. Limits below are operations "
        "or bytes over these."
    )
    return Section("goals", "Goals", (Text(text),), tuple(checks))


def _figures(subject: str, found: Speed) -> Iterator[Figure]:
    lines = list(found.of(subject))
    if subject in ("dynamics", "batch") and lines:
        yield Figure(line_chart(lines), _LINES)
    if subject == "simulate" and found.curves:
        yield Figure(work_chart(found.curves), _WORK)
    if subject == "scaling" and found.growths:
        yield Figure(growth_chart(found.growths), _GROWTH)


_LINES = (
    "Time for one state, logarithmic; blue this package, orange others, bars the middle half of all turns; the grey "
    "tick is the least time that the machine's arithmetic or memory allows. See how far each is from the native code, "
    "and the native code from the limit."
)
_WORK = (
    "Largest error of a coordinate at the end of the swing over the time that it took, both logarithmic: lower and "
    "farther left is better. Blue this package, orange Pinocchio with DOP853, others MuJoCo. See that soft closures "
    "leave an error that no step size removes, unless they are made stiffer with it."
)
_GROWTH = (
    "Left: time for one evaluation of the forward dynamics over N. Right: seconds to derive and to build, once. Both "
    "logarithmic; the grey line grows in proportion to N."
)


def line_chart(lines: Sequence[Line]) -> str:
    """Times as dots on a logarithmic axis, one panel for each kind of work."""
    timed = [line for line in lines if line.time is not None]
    works = list(dict.fromkeys(line.work for line in timed))
    counts = [sum(line.work == work for line in timed) for work in works]
    with drawing(8.6, 0.55 * len(works) + 0.27 * len(timed) + 0.5) as canvas:
        panels = canvas.subplots(len(works), 1, sharex=True, squeeze=False, height_ratios=counts)[:, 0]
        for axes, work in zip(panels, works, strict=True):
            own = [line for line in timed if line.work == work]
            for place, line in enumerate(own):
                _dot(axes, place, line)
            axes.set_yticks(range(len(own)), [line.tool for line in own])
            axes.set_ylim(len(own) - 0.4, -0.6)
            axes.set_title(work)
            axes.grid(axis="y", visible=False)
        axes.set_xscale("log")
        axes.set_xlabel("time for one state [s]")
        low, high = axes.get_xlim()
        axes.set_xlim(low, high * (high / low) ** 0.2)  # room for the words beside the dots
        return svg(canvas)


def _dot(axes, place: int, line: Line) -> None:  # type: ignore[no-untyped-def]
    assert line.time is not None
    middle, colour = line.time.median, BLUE if line.kind == "ours" else ORANGE
    half = middle * line.time.spread / 2
    axes.plot([max(middle - half, middle / 2), middle + half], [place, place], color=colour, linewidth=3, alpha=0.35)
    axes.plot([middle], [place], marker="o", color=colour)
    if line.limit is not None:
        axes.plot([line.limit], [place], marker="|", markersize=11, markeredgewidth=2, color=GREY)
    words = duration(middle) + ("" if line.ratio is None or line.reference else f"  ({figure(line.ratio)} x)")
    axes.annotate(words, (middle + half, place), (7, 0), textcoords="offset points", va="center", fontsize=8)


def work_chart(curves: Sequence[Curve]) -> str:
    """Error over wall time."""
    styles = [(ORANGE, "-"), (BLACK, "-"), (PURPLE, "--"), (SKY, ":"), (GREY, "-.")]
    with drawing(8.6, 4.2) as canvas:
        axes = canvas.subplots()
        others = iter(styles)
        for curve in curves:
            colour, dashes = (BLUE, "-") if curve.kind == "ours" else next(others, (GREY, ":"))
            points = [(p.time.median, p.error) for p in curve.points if 0 < p.error < float("inf")]
            if points:
                axes.loglog(*zip(*points, strict=True), color=colour, linestyle=dashes, marker="o", label=curve.tool)
        axes.set_xlabel("time [s]")
        axes.set_ylabel("largest error of a coordinate [m, rad]")
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
        return svg(canvas)


def growth_chart(growths: Sequence[Growth]) -> str:
    """Evaluation, and derivation with building, over N."""
    with drawing(8.6, 3.6) as canvas:
        left, right = canvas.subplots(1, 2)
        for axes, quantities in ((left, ("forward dynamics", "batch")), (right, ("derive", "build"))):
            shown = [growth for growth in growths if growth.quantity in quantities]
            for number, growth in enumerate(shown):
                lengths = sorted(growth.values)
                label = growth.tool if axes is left else growth.quantity
                colour = BLUE if growth.kind == "ours" else (*COLOURS[1:], PURPLE)[number % 3]
                dashes = "-" if number % 2 == 0 else "--"
                values = [growth.values[n] for n in lengths]
                power = "" if growth.exponent is None else f", N^{growth.exponent:.2f}"
                axes.loglog(lengths, values, color=colour, linestyle=dashes, marker="o", label=f"{label}{power}")
            _proportional(axes, shown)
            axes.set_xlabel("number N of four-bars")
            axes.legend(loc="upper left", fontsize=7)
            low, high = axes.get_ylim()
            axes.set_ylim(low, high * 8)
        left.set_title("one evaluation [s]")
        right.set_title("once [s]")
        return svg(canvas)


def _proportional(axes, shown: Sequence[Growth]) -> None:  # type: ignore[no-untyped-def]
    """A grey line of slope 1 through the first point of the lowest curve."""
    if not shown:
        return
    lowest = min(shown, key=lambda growth: growth.values[min(growth.values)])
    first, last = min(lowest.values), max(lowest.values)
    start = 0.6 * lowest.values[first]
    axes.loglog([first, last], [start, start * last / first], color=GREY, linewidth=1)
