"""reproduce: the paper's evidence, computed anew, as one page and one JSON file."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from nullbody.bench.machine import facts, processor, versions
from nullbody.bench.peer import Race
from nullbody.report.agreement import agreement
from nullbody.report.appendix import appendix
from nullbody.report.case import Settings, paper_case
from nullbody.report.equation import equation
from nullbody.report.erratum import erratum
from nullbody.report.literature import literature
from nullbody.report.mechanisms import catalog_times, mechanisms
from nullbody.report.motion import motion
from nullbody.report.null_space import heats, measured_null_spaces, null_space
from nullbody.report.output import usable_folder, write_texts
from nullbody.report.page import page
from nullbody.report.progress import named_steps
from nullbody.report.residual import residual
from nullbody.report.robot import robot
from nullbody.report.run import simulated_runs
from nullbody.report.section import Section, Verdict
from nullbody.report.singular import singular
from nullbody.report.summary import summary_text
from nullbody.report.tracking import tracking

__all__ = ["reproduce", "sections"]

_STEPS = 18  # named by `sections`
_PACKAGES = ("numpy", "scipy", "llvmlite", "matplotlib", "sympy", "mujoco", "pin")


def reproduce(out: str | Path, *, progress: bool | None = None) -> dict[str, Any]:
    """Compute everything and write `out/index.html` (self-contained) and `out/summary.json`.

    The folder is tried first; both files appear complete or not at all. Takes about half a minute on two cores.

    Args:
        out: folder, made where it is missing.
        progress: show a progress bar with the names of the steps on standard error; by default on a terminal.

    Returns:
        What summary.json holds, as nested dictionaries.

    Raises:
        OutputError: the folder cannot be made or written; nothing was computed.
    """
    import json

    folder = usable_folder(out, ("index.html", "summary.json"))
    begin = time.perf_counter()
    with named_steps("reproduce", _STEPS, progress) as step:
        made = sections(Settings(), step)
        seconds = time.perf_counter() - begin
        numbers = {**_machine_numbers(), "seconds": seconds, **_verdicts(made)}
        texts = {"index.html": page(made, facts(seconds, _PACKAGES)), "summary.json": summary_text(made, numbers)}
        write_texts(folder, texts)
    found: dict[str, Any] = json.loads(texts["summary.json"])
    return found


def sections(settings: Settings, step: Callable[[str], None] = lambda name: None) -> list[Section]:
    """All sections of the report in their order; what is timed alone comes before anything runs beside it."""
    step("deriving and building")
    case = paper_case(settings)
    step("timing null spaces")
    timed = measured_null_spaces(settings)
    step("timing the catalog")
    times = catalog_times()
    race = Race(heats(settings)).start()
    try:
        runs = simulated_runs(case, step)
        step("drawing the robot")
        first = [robot(case), equation(case), appendix()]
        step("figures 5 to 7")
        moved = motion(case, runs)
        step("growth of errors")
        tracked = tracking(case, runs)
        step("constraint residuals")
        closed = residual(case, runs)
        step("errata")
        wrong = erratum(case)
        step("comparing with engines")
        compared = agreement(case)
        step("any mechanism")
        others = mechanisms(settings, times)
        step("through singularities")
        through = singular(case)
        step("published benchmarks")
        known = literature()
        step("waiting for the symbolic baselines")
        laps = race.results()
    except BaseException:
        race.stop()
        raise
    step("writing the page")
    return [*first, null_space(timed, laps), moved, tracked, closed, wrong, compared, others, through, known]


def _verdicts(made: list[Section]) -> dict[str, int]:
    found = [check.verdict for section in made for check in section.checks]
    return {f"checks.{verdict.name.lower()}": found.count(verdict) for verdict in Verdict}


def _machine_numbers() -> dict[str, Any]:
    return {
        "versions": {"nullbody": _own_version(), "python": platform.python_version(), **versions(_PACKAGES)},
        "machine": {"processor": processor(), "cores": os.cpu_count(), "system": platform.system()},
    }


def _own_version() -> str:
    from nullbody import __version__

    return __version__
