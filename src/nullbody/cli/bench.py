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
    from nullbody.bench import Benchmark
    from nullbody.bench.table import Table

__all__ = ["EXAMPLES", "bench"]

EXAMPLES = (
    "nullbody bench nullspace --quick",
    "nullbody bench nullspace --html bench.html --json bench.json",
    "nullbody bench nullspace --only symbolic --limit 60",
    "nullbody bench nullspace --only accuracy,chains --json -",
)

_SUBJECTS = ("nullspace",)

Subject = Annotated[str, typer.Argument(metavar="SUBJECT", help="What is measured: nullspace.")]
Quick = Annotated[bool, typer.Option("--quick", help="The main rows only: half a minute instead of four.")]
Only = Annotated[
    Values,
    typer.Option(
        "--only",
        metavar="PART,...",
        help="Of symbolic (time to derive), numeric (time per matrix), accuracy (error near |B| = 0), chains and "
        "random (growth with size).",
    ),
]
Limit = Annotated[
    float | None,
    typer.Option(
        "--limit", metavar="SECONDS", help="Stop each method of another tool after this (8; quick: 2); 0 omits them."
    ),
]
JsonFile = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="Write all figures as JSON; - for stdout.")
]
HtmlFile = Annotated[Path | None, typer.Option("--html", metavar="FILE", help="Write one page that needs no other.")]


def bench(
    subject: Subject,
    quick: Quick = False,
    only: Only = None,
    limit: Limit = None,
    json_file: JsonFile = None,
    html_file: HtmlFile = None,
) -> None:
    """Measure the null space against the literature and other tools.

    Ratios come first: how many times longer a method takes than nullbody's on the same matrix, in the same run.
    Tools that are not installed are named: SymPy, SymEngine, CasADi and FLINT come with nullbody[bench].
    """
    _one_core()
    from nullbody import bench as benchmark
    from nullbody.bench.benchmark import steps
    from nullbody.errors import UnknownName
    from nullbody.report.benchmark import benchmark_page
    from nullbody.report.output import usable_folder, write_texts
    from nullbody.report.progress import named_steps

    if subject not in _SUBJECTS:
        raise UnknownName("subject of a benchmark", subject, _SUBJECTS)
    settings = benchmark.Settings.quick() if quick else benchmark.Settings.full()
    settings = settings if only is None else settings.only(names(only))
    settings = settings if limit is None else settings.limited(limit)
    to_stdout = json_file == Path("-")
    files = [file for file in (json_file, html_file) if file is not None and file != Path("-")]
    for file in files:
        usable_folder(file.parent, (file.name,))
    with named_steps("bench nullspace", steps(settings)) as step:
        found = benchmark.bench_null_space(settings, step)
    texts = {html_file: lambda: benchmark_page(found), json_file: lambda: json_text(found.to_dict()) + "\n"}
    for file in files:
        write_texts(file.parent, {file.name: texts[file]()})
    if to_stdout:
        print(json_text(found.to_dict()))
        return
    _show(found)
    for file in files:
        note(f"written: {file}")


def _one_core() -> None:
    """Let the linear algebra below NumPy and SciPy use one core, as compiled code does; it is loaded after this."""
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
        os.environ.setdefault(name, "1")


def _show(found: Benchmark) -> None:
    """The tables, and below them what is missing and what ran."""
    from nullbody.bench.table import tables

    for table in tables(found):
        _print(table)
    for name, why in found.missing.items():
        note(f"{name} is {why}")
    for name, fact in found.facts.items():
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
