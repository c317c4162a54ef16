"""The section on Tables 3 and 4, and the page of the whole benchmark."""

from __future__ import annotations

import html
import re
from dataclasses import replace

from nullbody.bench import Benchmark, Settings, bench_null_space
from nullbody.report import Section
from nullbody.report.bench_page import bench_page


def small() -> Benchmark:
    settings = Settings(limit=0.0, repeats=2, patience=0.01, states=2, accuracy_states=20, chains=(1, 2), search=1)
    return bench_null_space(settings.only(["symbolic", "accuracy", "chains"]))


def test_section_has_the_papers_figures_beside_ours(by_key: dict[str, Section]) -> None:
    section = by_key["nullspace"]
    text = str(section.parts)
    assert all(words in text for words in ("298.1 s", "753 µs", "nullbody compiled: state to N", "determinants"))
    assert section.numbers["nullspace.numeric_ratio_vs_gauss_jordan"] > 3.7
    assert section.numbers["nullspace.symbolic_ratio_vs_gauss_jordan"] is None  # no time was given
    assert section.numbers["nullspace.numeric_ns_8_wide"] > 0


def test_page_of_the_benchmark_stands_alone() -> None:
    found = replace(small(), missing={"casadi": "not installed"})
    text = html.unescape(bench_page(None, found))
    assert not re.findall(r'\b(?:src|href|data)\s*=\s*"(?!#|data:)[^"]*"', text)
    assert "The null space, measured" in text and "reproduced and checked" not in text
    for words in ("Wehage-Haug", "chains, absolute coordinates: operations for N", "casadi: not installed"):
        assert words in text
    assert text.count("<svg") == 2
