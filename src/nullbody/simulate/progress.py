"""A progress bar for long runs, on the terminal only."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["progress_bar"]

_PATIENCE = 2.0  # seconds without a bar


@contextmanager
def progress_bar(title: str, begin: float, end: float, wanted: bool | None = None) -> Iterator[Callable[[float], None]]:
    """A function that takes the current value between begin and end.

    Args:
        title: what is running.
        begin, end: first and last value.
        wanted: True shows the bar at once, False never; None on a terminal, after two seconds.
    """
    if wanted is False or (wanted is None and not sys.stderr.isatty()):
        yield lambda value: None
        return
    bar = _Bar(title, begin, end, 0.0 if wanted else _PATIENCE)
    try:
        yield bar.advance
    finally:
        bar.close()


class _Bar:
    """A rich progress bar that appears when the run has taken long enough."""

    def __init__(self, title: str, begin: float, end: float, patience: float) -> None:
        self.title, self.begin, self.end = title, begin, end
        self.appears = time.monotonic() + patience
        self.shown: Callable[[float], None] | None = None
        self.stop: Callable[[], None] | None = None

    def advance(self, value: float) -> None:
        """Move the bar to a value."""
        if self.shown is None:
            if time.monotonic() < self.appears:
                return
            self._appear()
        if self.shown is not None:
            self.shown(value)

    def close(self) -> None:
        """Take the bar away."""
        if self.stop is not None:
            self.stop()

    def _appear(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

        columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
        progress = Progress(*columns, console=Console(stderr=True), transient=True)
        task = progress.add_task(self.title, total=self.end - self.begin)
        progress.start()
        self.shown = lambda value: progress.update(task, completed=value - self.begin)
        self.stop = progress.stop
