"""What was set out to reach, beside what was found."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from nullbody.bench.speed.result import Curve, Goal, Growth, Line
from nullbody.bench.timing import Timing

__all__ = ["goals"]

_ERROR = 1e-9  # of q at the end of the swing [m, rad]


def goals(lines: Sequence[Line], curves: Iterable[Curve], growths: Iterable[Growth]) -> tuple[Goal, ...]:
    """All goals; those whose subject did not run have no figure."""
    own = {(line.work, line.tool): line for line in lines}
    ratios = [
        line.ratio
        for line in lines
        if line.work.startswith("forward dynamics, all") and line.kind == "peer" and line.ratio is not None
    ]
    grown = {(growth.tool, growth.quantity): growth for growth in growths}

    def timing(work: str, tool: str) -> Timing | None:
        found = next((line for (w, t), line in own.items() if w.startswith(work) and t == tool), None)
        return found.time if found is not None else None

    def at_most(what: str, time: Timing | None, limit: float) -> Goal:
        if time is None:
            return Goal(what, None, limit)
        return Goal(what, time.median, limit, best=time.best)

    native, derived = grown.get(("nullbody, native", "forward dynamics")), grown.get(("nullbody", "derive"))
    swing = next((curve.time_to(_ERROR) for curve in curves if curve.kind == "ours"), None)
    free = timing("robots in lock step", "nullbody, RK4, without projection")
    rate = None if free is None else 1 / free.median
    best = None if free is None or free.best is None else 1 / free.best
    return (
        at_most("3-PRS forward dynamics, native", timing("forward dynamics, all", "nullbody, native"), 350e-9),
        Goal("times slower the fastest engine", min(ratios, default=None), 20, "times", least=True),
        at_most("per state and core, blocks of 8", timing("forward dynamics, many", "nullbody, blocks of 8"), 80e-9),
        at_most("from a Python call", timing("forward dynamics, all", "nullbody, bound kernel from Python"), 1.5e-6),
        at_most("3-PRS derive + build, cold", timing("3-PRS, from bodies", "nullbody, build(mechanism), cold"), 0.6),
        at_most("3-PRS derive + build, warm", timing("3-PRS, from bodies", "nullbody, build(mechanism), warm"), 30e-3),
        at_most(f"3 s swing to {_ERROR:.0e} in q", swing, 5e-3),
        Goal(
            "Runge-Kutta-4 steps per second and core",
            rate,
            2e6,
            "1/s",
            True,
            best,
        ),
        Goal("40 four-bars: derive", derived.values.get(40) if derived is not None else None, 2.0),
        Goal(
            "40 four-bars: exponent of evaluation from 5 on",
            native.exponent if native is not None and 40 in native.values else None,
            1.15,
            "",
        ),
    )
