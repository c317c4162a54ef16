"""The source files that the architecture tests read."""

from __future__ import annotations

import ast
from pathlib import Path

__all__ = ["ROOT", "SRC", "parsed", "place"]

ROOT = Path(__file__).resolve().parents[2]
SRC = ROOT / "src" / "nullbody"


def parsed(folder: Path) -> list[tuple[Path, ast.Module]]:
    """Every Python file below a folder, with its syntax tree; an empty answer would make the tests hollow."""
    files = sorted(folder.rglob("*.py"))
    assert files, f"no Python files below {folder}"
    return [(file, ast.parse(file.read_text(encoding="utf-8"), str(file))) for file in files]


def place(file: Path, line: int) -> str:
    """`file:line`, relative to the repository where that is possible."""
    return f"{file.relative_to(ROOT) if file.is_relative_to(ROOT) else file}:{line}"
