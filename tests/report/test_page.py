"""The page: complete, self-contained, red where a number is wrong."""

from __future__ import annotations

import html
import re

from nullbody.report import Check, Figure, Section, Table, Text
from nullbody.report.page import page

FACTS = {"machine": "test <machine>"}
RED = "✗ differs"


def small(*checks: Check) -> Section:
    parts = (Text("<i>q</i>"), Table(("name", ">value"), (("a < b", "1"),)))
    return Section("one", "One & only", parts, checks)


def test_page_has_all_captions_and_titles(made: list[Section]) -> None:
    text = html.unescape(page(made, FACTS))
    captions = [caption for section in made for caption in section.captions]
    assert len(captions) >= 7
    for words in (*captions, *(section.title for section in made)):
        assert words in text


def test_every_caption_says_what_to_see(made: list[Section]) -> None:
    for caption in (caption for section in made for caption in section.captions):
        assert len(caption) > 100
        assert re.search(r"\b[Ss]ee\b", caption), caption


def test_page_needs_nothing_from_outside(made: list[Section]) -> None:
    text = page(made, FACTS)
    assert not re.findall(r'\b(?:src|href|data|action|poster)\s*=\s*"(?!#|data:)[^"]*"', text)
    assert not re.findall(r"@import|url\((?!#)|<script|<iframe|<link(?! rel=\"icon\")", text)


def test_verdict_turns_red_for_a_wrong_number() -> None:
    right, wrong = Check.at_most("error", 1e-15, 1e-12), Check.at_most("error", 1e-3, 1e-12)
    assert RED not in page([small(right)], FACTS)
    text = page([small(right, wrong)], FACTS)
    assert f'<span class="badge bad">{RED}</span>' in text
    assert "✗ 1 differ" in text


def test_cells_are_escaped_and_texts_are_not() -> None:
    text = page([small()], FACTS)
    assert "a &lt; b" in text and "test &lt;machine&gt;" in text and "One &amp; only" in text
    assert "<p><i>q</i></p>" in text


def test_figures_have_no_ids_in_common_with_other_content(made: list[Section]) -> None:
    """One SVG's clip path must not be another's: equal ids are allowed only for equal definitions."""
    seen: dict[str, str] = {}
    figures = [part for section in made for part in section.parts if isinstance(part, Figure)]
    for figure in figures:
        for name, body in re.findall(r'<clipPath id="([^"]+)">\s*(.*?)\s*</clipPath>', figure.svg, re.DOTALL):
            assert seen.setdefault(name, body) == body
