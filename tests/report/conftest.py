"""The report with little to compute: half a second of the motion, few states, no symbolic baselines."""

from __future__ import annotations

import pytest

from nullbody.report import Section, sections
from nullbody.report.case import Case, Settings, paper_case

SMALL = Settings(
    duration=0.5,
    samples=26,
    marks=6,
    states=3,
    errata_states=6,
    symbolic_limit=0.0,
    repeats=2,
)


@pytest.fixture(scope="session")
def case() -> Case:
    return paper_case(SMALL)


@pytest.fixture(scope="session")
def made() -> list[Section]:
    return sections(SMALL)


@pytest.fixture(scope="session")
def by_key(made: list[Section]) -> dict[str, Section]:
    return {section.key: section for section in made}
