"""Every relative link of every Markdown page leads to a file, and to a heading where it names one."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.architecture.source import ROOT, place

_LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)|<img [^>]*src=\"([^\"]+)\"")
_CODE = re.compile(r"^```.*?^```|`[^`\n]*`", re.M | re.S)
_SKIPPED = {".venv", ".git", "out", "build", "dist"}


def pages(folder: Path) -> list[Path]:
    """All Markdown pages of the repository, but for what is made or installed."""
    return [page for page in sorted(folder.rglob("*.md")) if not hidden(page.relative_to(folder))]


def hidden(page: Path) -> bool:
    return any(part in _SKIPPED or part.startswith(".") for part in page.parts)


def anchors(page: Path) -> set[str]:
    """The anchors that forges give to the headings of a page."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    titles = re.findall(r"^#+ (.*?)\s*$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", title.replace("`", "").lower()).replace(" ", "-") for title in titles}


def broken(page: Path) -> Iterator[str]:
    """`file:line: link` for every relative link that leads nowhere."""
    text = page.read_text(encoding="utf-8")
    prose = _CODE.sub(lambda code: re.sub(r"[^\n]", " ", code[0]), text)
    for found in _LINK.finditer(prose):
        link = found[1] or found[2]
        target, _, anchor = link.partition("#")
        if "://" in link or link.startswith("mailto:"):
            continue
        file = page if not target else (page.parent / target)
        if not file.exists() or (anchor and file.suffix == ".md" and anchor not in anchors(file)):
            yield f"{place(page, prose.count(chr(10), 0, found.start()) + 1)}: {link}"


def test_links_lead_somewhere() -> None:
    found = [line for page in pages(ROOT) for line in broken(page)]
    assert not found, "\n" + "\n".join(found)


@pytest.mark.parametrize(
    ("link", "good"),
    [
        ("[a](other.md)", True),
        ("[a](other.md#one-two)", True),
        ("[a](#here)", True),
        ("[a](https://example.org/x)", True),
        ("`[a](none.md)`", True),
        ("[a](none.md)", False),
        ("[a](other.md#three)", False),
        ("[a](#there)", False),
        ('<img src="none.svg">', False),
    ],
)
def test_a_broken_link_is_found(tmp_path: Path, link: str, good: bool) -> None:
    (tmp_path / "other.md").write_text("# One, `two`\n")
    page = tmp_path / "page.md"
    page.write_text(f"# Here\n\n{link}\n")
    assert [line.rpartition(":")[0] for line in broken(page)] == ([] if good else [f"{page}:3"])
