"""`python -m benchmarks`: a table of medians and of ratios to ours, or JSON with --json."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict

from rich.console import Console
from rich.table import Table

from benchmarks import robot
from benchmarks.measure import Timing


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--json", action="store_true", help="machine-readable output")
    options = parser.parse_args()
    console = Console(stderr=True)
    found: list[Timing] = []
    with console.status("measuring"):
        found.extend(robot.timings())
    if options.json:
        print(json.dumps([asdict(timing) for timing in found], indent=1))
        return
    ours = {timing.what: timing.median for timing in found if timing.tool == "nullbody"}
    table = Table("work", "tool", "median", "range", "ratio to ours", title="3-PRS robot, called from Python")
    for timing in found:
        ratio = timing.median / ours[timing.what]
        spread = f"{_seconds(timing.least)} .. {_seconds(timing.most)}"
        table.add_row(timing.what, timing.tool, _seconds(timing.median), spread, f"{ratio:.1f}")
    Console().print(table)


def _seconds(value: float) -> str:
    unit, factor = ("us", 1e6) if value < 1e-3 else ("ms", 1e3) if value < 1 else ("s", 1.0)
    return f"{value * factor:.3g} {unit}"


if __name__ == "__main__":
    main()
