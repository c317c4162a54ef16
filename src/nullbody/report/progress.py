"""The progress bar of the report: named steps, on standard error."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["named_steps"]


@contextmanager
def named_steps(title: str, count: int, wanted: bool | None = None) -> Iterator[Callable[[str], None]]:
    """A function that is told the name of each step as it begins.

    Args:
        title: what is running.
        count: number of steps.
        wanted: True shows the bar, False does not; None shows it on a terminal.
    """
    if wanted is False or (wanted is None and not sys.stderr.isatty()):
        yield lambda name: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description:<48}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=count)
        begun = 0

        def step(name: str) -> None:
            nonlocal begun
            bar.update(task, completed=begun, description=f"{title}: {name}")
            begun += 1

        yield step
        bar.update(task, completed=count)
