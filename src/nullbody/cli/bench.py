"""nullbody bench"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nullbody.cli.options import Values, names
from nullbody.cli.output import json_text, note

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Any

    from nullbody.bench import Benchmark, Settings
    from nullbody.bench.speed import Speed
    from nullbody.bench.table import Table

__all__ = ["EXAMPLES", "bench"]

EXAMPLES = (
    "nullbody bench --quick",
    "nullbody bench --html bench.html --json bench.json",
    "nullbody bench dynamics simulate",
    "nullbody bench nullspace --only symbolic --limit 60",
    "nullbody bench nullspace --only accuracy,chains --json -",
)

_NULL_SPACE = "nullspace"

Subject = Annotated[
    Values,
    typer.Argument(
        metavar="[SUBJECT]...",
        help="What is measured, all by default: build (from bodies to native code), dynamics (one evaluation), batch "
        "(many states), simulate (error over time), scaling (N four-bars), nullspace (against the literature).",
    ),
]
Quick = Annotated[bool, typer.Option("--quick", help="The main rows only: half a minute instead of five.")]
Only = Annotated[
    Values,
    typer.Option(
        "--only",
        metavar="PART,...",
        help="Parts of nullspace, of symbolic (time to derive), numeric (time per matrix), accuracy (error near "
        "|B| = 0), chains and random (growth with size).",
    ),
]
Limit = Annotated[
    float | None,
    typer.Option(
        "--limit",
        metavar="SECONDS",
        help="Of nullspace: stop each method of another tool after this (8; quick: 2); 0 omits them.",
    ),
]
JsonFile = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="Write all figures as JSON; - for stdout.")
]
HtmlFile = Annotated[Path | None, typer.Option("--html", metavar="FILE", help="Write one page that needs no other.")]


def bench(
    subject: Subject = None,
    quick: Quick = False,
    only: Only = None,
    limit: Limit = None,
    json_file: JsonFile = None,
    html_file: HtmlFile = None,
) -> None:
    """Measure speed beside other tools.

    Ratios come first: how many times longer a tool takes than nullbody for the same work, in the same run. Results are
    compared before anything is timed. Tools that are not installed are named: MuJoCo and Pinocchio come with
    nullbody[verify], SymPy, SymEngine, CasADi and FLINT with nullbody[bench].
    """
    _one_core()
    from nullbody.report.output import usable_folder, write_texts

    chosen = _subjects(subject)
    settings = _settings(chosen, quick, only, limit)
    files = [file for file in (json_file, html_file) if file is not None and file != Path("-")]
    for file in files:
        usable_folder(file.parent, (file.name,))
    speed, null_space = _measured(chosen, quick, settings)
    found = {"speed": speed, "nullspace": null_space}

    def page() -> str:
        from nullbody.report.bench_page import bench_page

        return bench_page(speed, null_space)

    def figures() -> str:
        return json_text({name: part.to_dict() for name, part in found.items() if part is not None})

    texts: Mapping[Path | None, Callable[[], str]] = {html_file: page, json_file: lambda: figures() + "\n"}
    for file in files:
        write_texts(file.parent, {file.name: texts[file]()})
    if json_file == Path("-"):
        print(figures())
        return
    _show(speed, null_space)
    for file in files:
        note(f"written: {file}")


def _subjects(given: list[str] | None) -> tuple[str, ...]:
    """The subjects in their order; all by default."""
    from nullbody.bench.speed import SUBJECTS
    from nullbody.errors import UnknownName

    known = (*SUBJECTS, _NULL_SPACE)
    for subject in given or ():
        if subject not in (*known, "all"):
            raise UnknownName("subject of a benchmark", subject, (*known, "all"))
    wanted = known if not given or "all" in given else given
    return tuple(subject for subject in known if subject in wanted)


def _settings(subjects: tuple[str, ...], quick: bool, only: list[str] | None, limit: float | None) -> Settings:
    """How much of the null space is run."""
    from nullbody.bench import Settings
    from nullbody.errors import InputError

    if _NULL_SPACE not in subjects and (only is not None or limit is not None):
        raise InputError(f"--only and --limit belong to {_NULL_SPACE}, which is not among {', '.join(subjects)}")
    settings = Settings.quick() if quick else Settings.full()
    settings = settings if only is None else settings.only(names(only))
    return settings if limit is None else settings.limited(limit)


def _measured(subjects: tuple[str, ...], quick: bool, settings: Settings) -> tuple[Speed | None, Benchmark | None]:
    """Run everything, speed first: nothing else runs beside it."""
    from nullbody.bench import bench_null_space
    from nullbody.bench.benchmark import steps as null_space_steps
    from nullbody.bench.speed import Effort, bench_speed, steps
    from nullbody.report.progress import named_steps

    speed = null_space = None
    timed = [subject for subject in subjects if subject != _NULL_SPACE]
    effort = Effort.quick() if quick else Effort.full()
    count = (steps(effort, timed) if timed else 0) + null_space_steps(settings) * (_NULL_SPACE in subjects)
    with named_steps("bench", count) as step:
        if timed:
            speed = bench_speed(effort, timed, step)
        if _NULL_SPACE in subjects:
            null_space = bench_null_space(settings, step)
    return speed, null_space


def _one_core() -> None:
    """Let the linear algebra below NumPy and SciPy use one core, as compiled code does; it is loaded after this."""
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
        os.environ.setdefault(name, "1")


def _show(speed: Speed | None, null_space: Benchmark | None) -> None:
    """The tables, and below them what is missing and what ran."""
    from nullbody.bench.speed.table import tables as speed_tables
    from nullbody.bench.table import tables

    for table in [*([] if speed is None else speed_tables(speed)), *([] if null_space is None else tables(null_space))]:
        _print(table)
    facts: dict[str, Any] = {}
    for found in (null_space, speed):
        if found is not None:
            for name, why in found.missing.items():
                note(f"{name} is missing: {why}")
            facts |= found.facts
    for name, fact in facts.items():
        note(f"{name}: {fact}")


def _print(table: Table) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table as Printed

    printed = Printed(box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True, title=table.title)
    printed.title_justify, printed.title_style = "left", "bold"
    printed.caption, printed.caption_justify = table.note or None, "left"
    for head in table.head:
        right = head.startswith(">")
        printed.add_column(head.lstrip(">"), justify="right" if right else "left", no_wrap=right, overflow="fold")
    for row in table.rows:
        printed.add_row(*row)
    width = None if sys.stdout.isatty() else 160
    Console(width=width, markup=False, emoji=False, highlight=False).print(printed)
