"""nullbody reproduce"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from nullbody.cli.options import Json
from nullbody.cli.output import note, print_json, print_table

__all__ = ["EXAMPLES", "reproduce"]

EXAMPLES = ("nullbody reproduce", "nullbody reproduce --out evidence --json")

_HEADLINES = {
    "checks.agrees": "checks that agree",
    "checks.differs": "checks that differ",
    "checks.missing": "checks that could not run",
    "appendix.exact": "the appendix example, exactly",
    "derive.seconds": "derivation [s]",
    "build.cold_seconds": "compilation [s]",
    "build.warm_seconds": "the same from the cache [s]",
    "nullspace.symbolic_ratio_vs_gauss_jordan": "symbolic null space, times faster than Gauss-Jordan",
    "nullspace.symbolic_ratio_vs_gauss_jordan_by_value": "the same, if Gauss-Jordan had our test for zero",
    "nullspace.numeric_ratio_vs_gauss_jordan": "numeric null space, native, times faster than Gauss-Jordan in NumPy",
    "tracking.open_loop_time_to_1mm": "open loop: 1 mm off after [s]",
    "tracking.closed_loop_max_error": "computed torque: largest error [m]",
    "constraint_residual.max": "largest gap in the loops [m]",
}

Folder = Annotated[Path, typer.Option("--out", "-o", metavar="FOLDER", help="Where the page is written.")]
Open = Annotated[bool, typer.Option("--open", help="Show the page in the browser.")]


def reproduce(out: Folder = Path("out/reproduce"), show: Open = False, as_json: Json = False) -> None:
    """Recompute the paper's evidence into one page.

    The folder gets index.html, which needs no other file, and summary.json, which --json prints.
    """
    from nullbody import report

    summary = report.reproduce(out)
    page = out / "index.html"
    if as_json:
        print_json(summary)
    else:
        rows = [(words, _found(summary, key)) for key, words in _HEADLINES.items()]
        print_table(("what", "found"), [(words, value) for words, value in rows if value])
        print(page)
    differing = summary.get("checks", {}).get("differs", 0)
    if differing:
        note(f"{differing} of the checks differ from what is expected: {page} names them")
    if show and typer.launch(str(page)) != 0:
        note(f"no browser could be started: open {page} yourself")


def _found(summary: Mapping[str, Any], key: str) -> str:
    """An entry of summary.json by its dotted key, in four digits; nothing where there is none."""
    group, _, name = key.partition(".")
    entries = summary.get(group, {})
    value = entries.get(name)
    if isinstance(value, bool):
        return "yes" if value else "no"
    bound = "at least " if entries.get(f"{name}_is_lower_bound") else ""
    return "" if value is None else f"{bound}{value:.4g}"
