"""Every example runs; its last statement is its own check."""

from __future__ import annotations

import ast
import runpy
import tempfile
from pathlib import Path

import pytest

from tests.architecture.source import ROOT

EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def test_examples_are_numbered() -> None:
    assert [path.name[:3] for path in EXAMPLES] == [f"{number:02}_" for number in range(1, len(EXAMPLES) + 1)]
    assert len(EXAMPLES) >= 6


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import):
            pytest.importorskip(node.names[0].name, reason=f"{node.names[0].name} is not installed")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    runpy.run_path(str(path), run_name="__main__")


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_is_short_and_ends_with_a_check(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    last = tree.body[-1]
    inner = last.body[-1] if isinstance(last, ast.With) else last
    assert isinstance(inner, ast.Assert)
    assert len(text.splitlines()) <= 60
    assert ast.get_docstring(tree)
