"""What the commands print: results on stdout, JSON on request, notes and complaints on stderr."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

__all__ = ["complain", "json_text", "note", "print_json", "print_table"]

_WIDE = 200  # columns of a file or a pipe, where nothing has to be folded
ROUNDING = 1e-14  # [m, rad, N, ...] what is less than this in such a table is 0 but for rounding


def print_json(value: object) -> None:
    """A value as JSON on stdout."""
    print(json_text(value))


def json_text(value: object) -> str:
    """A value as JSON: tuples and arrays as lists, numbers with all their digits, NaN and infinities as null."""
    return json.dumps(_plain(value), indent=2, allow_nan=False, ensure_ascii=False)


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, str | int | float | None) else str(value)


def print_table(columns: Sequence[str], rows: Iterable[Sequence[object]], *, smallest: float = 0.0) -> None:
    """A table; numbers stand right-aligned, floats with 10 digits and without a sign on 0.

    Numbers below `smallest` are shown as 0: `ROUNDING` for positions, rates, inputs and reactions, not for measures.
    """
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    cells = [list(row) for row in rows]
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for number, column in enumerate(columns):
        numeric = all(isinstance(row[number], int | float) for row in cells)
        table.add_column(column, justify="right" if numeric else "left", overflow="fold")
    for row in cells:
        table.add_row(*(_shown(cell, smallest) for cell in row))
    width = None if sys.stdout.isatty() else _WIDE
    Console(width=width, markup=False, emoji=False, highlight=False).print(table)


def _shown(cell: object, smallest: float) -> str:
    """A cell as text."""
    if not isinstance(cell, float):
        return str(cell)
    return "0" if abs(cell) < smallest else f"{cell + 0.0:.10g}"


def note(text: str) -> None:
    """A line for the reader, on stderr."""
    print(text, file=sys.stderr)


def complain(error: object, code: int) -> int:
    """One line on stderr that says what is wrong; returns the exit code."""
    print(f"error: {' '.join(str(error).split())}", file=sys.stderr)
    return code
