"""The list at the head of the package names every file of its folder, once."""

from __future__ import annotations

import re
from pathlib import Path

from nullbody import nullspace


def test_the_chapter_names_every_file() -> None:
    folder = Path(nullspace.__path__[0])
    parts = {file.stem for file in folder.glob("*.py")} | {file.parent.name for file in folder.glob("*/__init__.py")}
    named = re.findall(r"^    (\w+) {2,}\S", nullspace.__doc__ or "", re.M)
    assert sorted(named) == sorted(parts - {"__init__"})
