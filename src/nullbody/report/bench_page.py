"""What `nullbody bench` found, as one page."""

from __future__ import annotations

from nullbody.bench import Benchmark
from nullbody.bench.speed import Speed
from nullbody.report.benchmark import null_space_sections
from nullbody.report.page import Cover, page
from nullbody.report.speed import speed_sections

__all__ = ["bench_page"]

_COVER = Cover(
    "nullbody bench",
    "Speed, measured beside other tools",
    "This package beside other tools on the same work in the same run, in turns: medians, the width of the middle "
    "half, the best turn. Times are those of the thread on its core, of several threads those on the wall. Ratios "
    "refer to this package. Every result is compared before it is timed; what is not installed is named below, what "
    "was stopped at its time limit is marked with >.",
)
_NULL_SPACE = Cover(
    "nullbody bench: the null space",
    "The null space, measured against the literature and other tools",
    "A N = 0 for the constraint Jacobian A of closed loops: this package beside the methods of the literature, "
    "written as short as can be, and beside other tools, on the same matrices in the same run. Ratios refer to this "
    "package; methods that were stopped at their time limit are marked with >.",
)


def bench_page(speed: Speed | None, null_space: Benchmark | None) -> str:
    """One self-contained page of whatever was run."""
    sections = [] if speed is None else speed_sections(speed)
    sections += [] if null_space is None else null_space_sections(null_space)
    facts: dict[str, str] = {}
    run = [found for found in (speed, null_space) if found is not None]
    for found in reversed(run):
        facts |= found.facts
        facts |= {name: f"{name}: {why}" for name, why in found.missing.items()}
    facts["run time"] = " and ".join(found.facts["run time"] for found in run)
    return page(sections, facts, _NULL_SPACE if speed is None else _COVER)
