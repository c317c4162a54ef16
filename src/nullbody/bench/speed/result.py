"""What the speed benchmark finds: figures, nothing formatted."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from math import log
from typing import Any, Literal

import numpy as np

from nullbody.bench.speed.effort import Effort
from nullbody.bench.timing import Timing

__all__ = ["Curve", "Goal", "Growth", "Kind", "Line", "Point", "Speed", "exponent"]

Kind = Literal["ours", "peer"]


@dataclass(frozen=True)
class Line:
    """One way to do some work.

    Attributes:
        subject: key of `SUBJECTS`.
        work: what is done; ratios compare lines of one work.
        tool: what does it.
        kind: whose it is.
        time: for one time, or one state; nothing where there is no figure.
        ratio: how many times longer than the line of this package that `reference` marks.
        reference: whether ratios of this work refer to this line.
        limit: seconds that the machine needs at least for these operations and bytes.
        operations: arithmetic ones.
        deviation: of the result from that of the reference, relative to its largest entry.
        note: why there is no figure, or what to know about it.
    """

    subject: str
    work: str
    tool: str
    kind: Kind
    time: Timing | None = None
    ratio: float | None = None
    reference: bool = False
    limit: float | None = None
    operations: int | None = None
    deviation: float | None = None
    note: str = ""

    def to_dict(self) -> dict[str, Any]:
        """For JSON: time as `seconds` and `spread`, nothing that is unknown."""
        known = {key: value for key, value in vars(self).items() if key != "time" and value not in (None, "", False)}
        if self.time is not None:
            known |= {"seconds": self.time.median, "spread": self.time.spread, "best": self.time.best}
        return known


@dataclass(frozen=True)
class Point:
    """One setting of a tool.

    Attributes:
        setting: in words: "rtol 1e-06".
        time: of the whole motion.
        error: largest error of a coordinate at the end [m, rad].
    """

    setting: str
    time: Timing
    error: float


@dataclass(frozen=True)
class Curve:
    """Errors of a tool over the time that they cost.

    Attributes:
        tool: what integrates.
        kind: whose it is.
        points: from cheap to dear.
        note: what to know about it.
    """

    tool: str
    kind: Kind
    points: tuple[Point, ...]
    note: str = ""

    def time_to(self, error: float) -> Timing | None:
        """Least time of a point with an error of at most this; nothing where no point has one."""
        times = (point.time for point in self.points if point.error <= error)
        return min(times, key=lambda time: time.median, default=None)


@dataclass(frozen=True)
class Growth:
    """A quantity as the number N of four-bars grows.

    Attributes:
        tool: what does it.
        quantity: "derive", "build", "operations", "forward dynamics" or "batch".
        kind: whose it is.
        values: by N [s, or operations].
        deviation: largest of the results from this package's, relative.
        note: what to know about it.
    """

    tool: str
    quantity: str
    kind: Kind
    values: Mapping[int, float]
    deviation: float | None = None
    note: str = ""

    @property
    def exponent(self) -> float | None:
        """p of the law N^p that fits best from N = 5 on; nothing where there are not two such lengths."""
        return exponent(self.values)


def exponent(values: Mapping[int, float], least: int = 5) -> float | None:
    """Slope of log value over log N, for N of at least 5."""
    points = [(log(n), log(value)) for n, value in values.items() if n >= least and value > 0]
    if len(points) < 2:
        return None
    x, y = np.array(points).T
    return float(np.polyfit(x, y, 1)[0])


@dataclass(frozen=True)
class Goal:
    """What was set out to reach.

    Attributes:
        what: in words.
        found: the figure, in the unit of the goal, by medians; nothing where it was not measured.
        goal: its limit.
        unit: "s", "1/s", "times" or nothing.
        least: whether the figure must be at least the goal, not at most.
        best: the same by the best turn, where it is a time.
    """

    what: str
    found: float | None
    goal: float
    unit: str = "s"
    least: bool = False
    best: float | None = None

    @property
    def reached(self) -> bool | None:
        """Whether it is reached; nothing where it was not measured."""
        if self.found is None:
            return None
        return self.found >= self.goal if self.least else self.found <= self.goal


@dataclass(frozen=True)
class Speed:
    """Everything that was found.

    Attributes:
        effort: how much was run.
        subjects: which.
        lines: of "build", "dynamics", "batch" and "simulate".
        curves: of "simulate".
        growths: of "scaling".
        goals: reached or not.
        limits: of the machine, by name [1/s].
        facts: machine, versions, run time; how the reference motion is known.
        missing: peers that are not there, with the reason.
    """

    effort: Effort
    subjects: tuple[str, ...]
    lines: tuple[Line, ...] = ()
    curves: tuple[Curve, ...] = ()
    growths: tuple[Growth, ...] = ()
    goals: tuple[Goal, ...] = ()
    limits: Mapping[str, float] = field(default_factory=dict)
    facts: Mapping[str, str] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)

    def of(self, subject: str) -> Iterator[Line]:
        """The lines of a subject."""
        return (line for line in self.lines if line.subject == subject)

    def to_dict(self) -> dict[str, Any]:
        """The same as nested dictionaries and lists, for JSON."""
        return {
            "facts": dict(self.facts),
            "missing": dict(self.missing),
            "effort": asdict(self.effort),
            "subjects": list(self.subjects),
            "limits": dict(self.limits),
            "goals": [{**vars(goal), "reached": goal.reached} for goal in self.goals],
            "lines": [line.to_dict() for line in self.lines],
            "curves": [_curve(curve) for curve in self.curves],
            "growths": [{**vars(growth), "exponent": growth.exponent} for growth in self.growths],
        }


def _curve(curve: Curve) -> dict[str, Any]:
    points: Iterable[dict[str, Any]] = (
        {"setting": p.setting, "seconds": p.time.median, "spread": p.time.spread, "error": p.error}
        for p in curve.points
    )
    return {"tool": curve.tool, "kind": curve.kind, "note": curve.note, "points": list(points)}
