"""Every Python block of README.md and docs/ runs and prints, or raises, what the page shows."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from nullbody import errors
from nullbody.simulate import Outcome
from tests.architecture.source import ROOT, SRC, place
from tests.docs.page import PAGES, agree, blocks, expected, run


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_page_shows_what_its_blocks_do(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, object] = {}
    for block in blocks(page.read_text(encoding="utf-8")):
        ran = run(block, namespace, page)
        where = place(page, block.line)
        assert ran.kind == expected(block.heading), f"{where}: {ran.error!r}"
        if block.shown is not None:
            assert agree(block.shown, ran.text), f"{where} prints\n{ran.text}\nbut the page shows\n{block.shown}"


@pytest.mark.parametrize("page", sorted((ROOT / "docs").glob("*.md")), ids=lambda page: page.name)
def test_modules_that_a_page_names_exist(page: Path) -> None:
    named = set(re.findall(r"`((?:[a-z_]+/)*[a-z_]+\.py)`", page.read_text(encoding="utf-8")))
    assert not {name for name in named if not (SRC / name).is_file()}


def test_every_error_and_outcome_has_its_section() -> None:
    text = (ROOT / "docs" / "troubleshooting.md").read_text(encoding="utf-8")
    headings = "\n".join(line for line in text.splitlines() if line.startswith("#"))
    for name in [*errors.__all__, *(outcome.name for outcome in Outcome)]:
        assert f"`{name}`" in headings, f"troubleshooting.md has no section on {name}"


@pytest.mark.parametrize(
    ("shown", "real", "same"),
    [
        ("|B| = 0.00675 m", "|B| =  0.006750001\nm", True),
        ("closure 2.8e-17 m", "closure 5.6e-17 m", True),
        ("energy 1.5 J", "energy 1.6 J", False),
        ("energy 1.5 J", "energy -1.5 J", False),
        ("1.5 J", "1.5 N", False),
        ("1 2", "1 2 3", False),
    ],
)
def test_comparison_of_texts(shown: str, real: str, same: bool) -> None:
    assert agree(shown, real) is same


def test_wrong_page_is_noticed(tmp_path: Path) -> None:
    text = "# `StateError`\n\n```python\nraise ValueError('no')\n```\n\n```text\nno\n```\n"
    (block,) = blocks(text)
    ran = run(block, {}, tmp_path / "page.md")
    assert (block.line, expected(block.heading), ran.kind, ran.text) == (3, "StateError", "ValueError", "no\n")
