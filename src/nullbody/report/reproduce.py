"""reproduce: the paper's evidence, computed anew, as one page and one JSON file."""

from __future__ import annotations

import os
import platform
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from nullbody.report.agreement import agreement
from nullbody.report.appendix import appendix
from nullbody.report.case import Settings, paper_case
from nullbody.report.equation import equation
from nullbody.report.erratum import erratum
from nullbody.report.motion import motion
from nullbody.report.null_space import LIMITS, null_space
from nullbody.report.output import usable_folder, write_texts
from nullbody.report.page import page
from nullbody.report.progress import named_steps
from nullbody.report.race import Race
from nullbody.report.residual import residual
from nullbody.report.robot import robot
from nullbody.report.run import simulated_runs
from nullbody.report.section import Section, Verdict
from nullbody.report.speed import numeric_speed, symbolic_speed
from nullbody.report.summary import summary_text
from nullbody.report.tracking import tracking

__all__ = ["reproduce", "sections"]

_STEPS = 14  # named by `sections`
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
        texts = {"index.html": page(made, _facts(seconds)), "summary.json": summary_text(made, numbers)}
        write_texts(folder, texts)
    found: dict[str, Any] = json.loads(texts["summary.json"])
    return found


def sections(settings: Settings, step: Callable[[str], None] = lambda name: None) -> list[Section]:
    """All sections of the report in their order; what is timed alone comes before anything runs beside it."""
    step("deriving and building")
    case = paper_case(settings)
    step("timing null spaces")
    symbolic, numeric = symbolic_speed(case), numeric_speed(case)
    race = Race({name: share * settings.symbolic_limit for name, share in LIMITS.items()}).start()
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
        step("waiting for the symbolic baselines")
        laps = race.results()
    except BaseException:
        race.stop()
        raise
    step("writing the page")
    return [*first, null_space(case, symbolic, numeric, laps), moved, tracked, closed, wrong, compared]


def _verdicts(made: list[Section]) -> dict[str, int]:
    found = [check.verdict for section in made for check in section.checks]
    return {f"checks.{verdict.name.lower()}": found.count(verdict) for verdict in Verdict}


def _facts(seconds: float) -> dict[str, str]:
    """What the page says about the run."""
    versions = ", ".join(f"{name} {version}" for name, version in _versions().items() if version)
    machine = f"{_processor()}, {os.cpu_count()} logical cores, {platform.system()}"
    return {
        "made": time.strftime("%Y-%m-%d %H:%M %Z"),
        "run time": f"{seconds:.1f} s",
        "machine": machine,
        "versions": f"nullbody {_own_version()}, Python {platform.python_version()}, {versions}",
    }


def _machine_numbers() -> dict[str, Any]:
    versions = {"nullbody": _own_version(), "python": platform.python_version(), **_versions()}
    machine = {"processor": _processor(), "cores": os.cpu_count(), "system": platform.system()}
    return {"versions": versions, "machine": machine}


def _own_version() -> str:
    from nullbody import __version__

    return __version__


def _versions() -> dict[str, str | None]:
    """Versions of the packages that matter here; nothing for those that are not installed."""
    from importlib.metadata import PackageNotFoundError, version

    found: dict[str, str | None] = {}
    for name in _PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = None
    return found


def _processor() -> str:
    """The processor's name, as far as the system tells it."""
    if sys.platform == "linux":
        try:
            lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        except OSError:
            lines = []
        for line in lines:
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
