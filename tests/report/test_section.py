"""Checks and their verdicts."""

from __future__ import annotations

import math

import pytest

from nullbody.report import Check, Verdict
from nullbody.report.section import number


@pytest.mark.parametrize(
    ("check", "verdict"),
    [
        (Check.at_most("x", 1e-12, 1e-12), Verdict.AGREES),
        (Check.at_most("x", 1.1e-12, 1e-12), Verdict.DIFFERS),
        (Check.at_most("x", math.nan, 1e-12), Verdict.DIFFERS),
        (Check.at_most("x", None, 1e-12), Verdict.MISSING),
        (Check.at_least("x", 138.0, 138), Verdict.AGREES),
        (Check.at_least("x", 137.9, 138), Verdict.DIFFERS),
        (Check.near("x", 1.95, 1.93, 0.1), Verdict.AGREES),
        (Check.near("x", 1.75, 1.93, 0.1), Verdict.DIFFERS),
        (Check.holds("x", True), Verdict.AGREES),
        (Check.holds("x", False), Verdict.DIFFERS),
        (Check.holds("x", None), Verdict.MISSING),
    ],
)
def test_verdict(check: Check, verdict: Verdict) -> None:
    assert check.verdict is verdict


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (None, "-"),
        (0.0, "0"),
        (0.08712, "0.0871"),
        (2033.4, "2033"),
        (28295.7, "2.83e4"),
        (1.94e-15, "1.94e-15"),
        (-1e-4, "-1e-4"),
        (math.nan, "not a number"),
        (math.inf, "infinite"),
    ],
)
def test_numbers_are_for_people(value: float | None, shown: str) -> None:
    assert number(value) == shown


def test_words_of_a_check_name_limit_unit_and_source() -> None:
    check = Check.near("forces", 0.5, 1.0, 0.1, "N", "theory")
    assert check.expected == "1 ± 0.1 N (theory)"
    assert check.found == "0.5 N"
