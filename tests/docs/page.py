"""Markdown pages whose Python blocks are run: what they print, or raise, against what the page shows.

A block ```python is run after those above it, in one namespace for each page. A block ```text right below shows what
it prints. Where the nearest heading names an error or an Outcome, every block raises exactly that, and ```text is
its message. Numbers may differ by 2 %, and by 1e-9 altogether: other processors round otherwise.
"""

from __future__ import annotations

import io
import os
import re
import tempfile
import textwrap
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import dataclass
from math import isclose
from pathlib import Path

from nullbody import errors
from nullbody.simulate import Outcome
from tests.architecture.source import ROOT

__all__ = ["PAGES", "Block", "Ran", "agree", "blocks", "expected", "page_texts", "refreshed", "run"]

_CANDIDATES = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
PAGES = sorted(page for page in _CANDIDATES if "```python" in page.read_text(encoding="utf-8"))

_BLOCK = r"^```python\n(?P<code>.*?)^```$(?:\n*^```text\n(?P<shown>.*?)^```$)?"
_PARTS = re.compile(rf"^(?P<heading>#+ .*?)$|{_BLOCK}", re.M | re.S)
_NAME = re.compile(r"`(\w+)`")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?", re.I)
_WIDTH = 110
_HOME = "/home/you"  # what a page shows for the folder that it runs in


@dataclass(frozen=True)
class Block:
    """One block of Python: the heading above it, its line, what it should print, and where that stands."""

    heading: str
    line: int
    code: str
    shown: str | None
    span: tuple[int, int]


@dataclass(frozen=True)
class Ran:
    """What a block printed, or the error that it raised."""

    text: str
    error: Exception | None = None

    @property
    def kind(self) -> str:
        """Name of the error's class, for an ended simulation that of its Outcome; empty without an error."""
        if isinstance(self.error, errors.SimulationError) and self.error.trajectory is not None:
            return str(self.error.trajectory.outcome.name)
        return type(self.error).__name__ if self.error else ""


def blocks(text: str) -> Iterator[Block]:
    """The Python blocks of a page, in order."""
    heading = ""
    for part in _PARTS.finditer(text):
        if part["heading"]:
            heading = part["heading"]
            continue
        yield Block(heading, text.count("\n", 0, part.start()) + 1, part["code"], part["shown"], part.span("shown"))


def expected(heading: str) -> str:
    """The error or Outcome that a heading names, or nothing."""
    known = {*errors.__all__, *(outcome.name for outcome in Outcome if not outcome.ok), "TypeError"}
    return next((name for name in _NAME.findall(heading) if name in known), "")


def run(block: Block, namespace: dict[str, object], file: Path) -> Ran:
    """Run a block in the current folder; the environment is put back after it."""
    kept, printed = dict(os.environ), io.StringIO()
    code = compile("\n" * block.line + block.code, str(file), "exec")
    try:
        with redirect_stdout(printed):
            exec(code, namespace)
    except Exception as error:
        if not expected(block.heading):
            raise
        message = str(error).replace(str(Path.cwd()), _HOME)
        return Ran("\n".join(textwrap.wrap(message, _WIDTH, break_on_hyphens=False)) + "\n", error)
    finally:
        os.environ.clear()
        os.environ.update(kept)
    return Ran(printed.getvalue().replace(str(Path.cwd()), _HOME))


def agree(shown: str, real: str) -> bool:
    """Whether two texts say the same: equal but for line breaks and the last digits of numbers."""
    words = [" ".join(_NUMBER.sub("#", text).split()) for text in (shown, real)]
    numbers = [[float(number) for number in _NUMBER.findall(text)] for text in (shown, real)]
    close = (isclose(a, b, rel_tol=0.02, abs_tol=1e-9) for a, b in zip(*numbers, strict=False))
    return words[0] == words[1] and len(numbers[0]) == len(numbers[1]) and all(close)


def refreshed(text: str, file: Path) -> str:
    """The page with what its blocks really print."""
    namespace: dict[str, object] = {}
    done, parts = 0, []
    for block in list(blocks(text)):
        ran = run(block, namespace, file)
        if block.shown is not None:
            fresh = block.shown if agree(block.shown, ran.text) else ran.text
            parts += [text[done : block.span[0]], fresh]
            done = block.span[1]
    return "".join([*parts, text[done:]])


def page_texts() -> dict[Path, str]:
    """All pages with what their blocks really print, where that is no longer what they show."""
    texts, here = {}, Path.cwd()
    for page in PAGES:
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                texts[page] = refreshed(page.read_text(encoding="utf-8"), page)
            finally:
                os.chdir(here)
    return texts
