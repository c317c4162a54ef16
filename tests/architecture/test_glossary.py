"""The glossary agrees with the code: every public name, every output, coordinate, parameter and input has its entry."""

from __future__ import annotations

import re
from collections.abc import Iterator

import nullbody
from tests.architecture.source import ROOT

DOCS = ROOT / "docs"


def rows(title: str) -> Iterator[list[str]]:
    """The rows of the table below a heading of the glossary, cell by cell."""
    text = (DOCS / "glossary.md").read_text(encoding="utf-8")
    section = text.split(f"## {title}\n")[1].split("\n## ")[0]
    for line in section.splitlines():
        if line.startswith("| ") and not line.startswith("| symbol"):
            yield [cell.strip() for cell in line.strip("|").split("|")]


def codes(text: str) -> set[str]:
    """The names in backticks."""
    return set(re.findall(r"`(\w+)`", text))


def listed(title: str) -> set[str]:
    """The names in the column `code` of a table."""
    return {name for row in rows(title) for name in codes(row[1])}


def test_every_output_has_a_symbol() -> None:
    equations = nullbody.derive(nullbody.catalog.three_prs(), ("s1", "s2", "s3"))
    computed = {name for routine in equations.routines.values() for name in routine.outputs}
    assert {*equations.outputs, *computed, *equations.groups} <= listed("Symbols")


def test_every_name_of_the_robot_has_an_entry() -> None:
    robot = nullbody.catalog.three_prs()
    units = {**robot.units, **{p.name: p.unit for p in robot.parameters}}
    assert {*units, *robot.inputs} == listed("The 3-PRS robot")
    for _, names, unit, _ in rows("The 3-PRS robot"):
        for name in codes(names) & set(units):
            assert units[name].replace("^2", "²") == unit, name


def test_every_public_name_is_explained() -> None:
    text = (DOCS / "glossary.md").read_text(encoding="utf-8")
    api = set(
        re.findall(
            r"^### nullbody\.(?:\w+\.)*(\w+)$|^\| `(\w+)` \|", (DOCS / "api.md").read_text(encoding="utf-8"), re.M
        )
    )
    explained = codes(text) | {name for pair in api for name in pair}
    assert set(nullbody.__all__) <= explained


def test_no_symbol_stands_for_two_things() -> None:
    symbols = [row[0] for row in rows("Symbols")]
    assert len(symbols) == len(set(symbols))
