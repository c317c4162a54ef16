"""What a section of the report is made of: text, figures, tables, listings, and checks with a verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

__all__ = ["Check", "Figure", "Listing", "Part", "Section", "Table", "Text", "Verdict", "number"]


class Verdict(Enum):
    """What a check says; the value is the word on the page."""

    AGREES = "agrees"
    DIFFERS = "differs"
    MISSING = "not run"


@dataclass(frozen=True)
class Text:
    """A paragraph; `html` may hold inline markup and is not escaped, so nothing but the report's own words enters."""

    html: str


@dataclass(frozen=True)
class Figure:
    """A picture as SVG, and a caption that says what to see."""

    svg: str
    caption: str


@dataclass(frozen=True)
class Table:
    """A table of plain text cells; columns whose head starts with ">" are flushed right."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""


@dataclass(frozen=True)
class Listing:
    """A long text that is folded away behind its title."""

    title: str
    text: str


Part = Text | Figure | Table | Listing


@dataclass(frozen=True)
class Check:
    """A number of the report against what it should be.

    Attributes:
        what: what was checked, in words.
        value: what was found; None where it could not be measured.
        low, high: the values between which it agrees.
        expected: the same in words, with where it comes from.
        unit: SI unit.
    """

    what: str
    value: float | None
    low: float
    high: float
    expected: str
    unit: str = ""

    @classmethod
    def at_most(cls, what: str, value: float | None, limit: float, unit: str = "", source: str = "") -> Check:
        """A size that must not exceed a limit."""
        return cls(what, value, -math.inf, limit, _joined(f"at most {number(limit)}", unit, source), unit)

    @classmethod
    def at_least(cls, what: str, value: float | None, limit: float, unit: str = "", source: str = "") -> Check:
        """A size that must reach a limit."""
        return cls(what, value, limit, math.inf, _joined(f"at least {number(limit)}", unit, source), unit)

    @classmethod
    def near(
        cls, what: str, value: float | None, expected: float, tolerance: float, unit: str = "", source: str = ""
    ) -> Check:
        """A number that must be the expected one within a tolerance."""
        words = f"{expected:.6g} ± {number(tolerance)}"
        return cls(what, value, expected - tolerance, expected + tolerance, _joined(words, unit, source), unit)

    @classmethod
    def holds(cls, what: str, value: bool | None, source: str = "") -> Check:
        """A statement that must be true."""
        return cls(what, None if value is None else float(value), 1, 1, _joined("yes", "", source), "yes or no")

    @property
    def verdict(self) -> Verdict:
        """Agrees inside the limits, differs outside and for NaN, missing without a value."""
        if self.value is None:
            return Verdict.MISSING
        return Verdict.AGREES if self.low <= self.value <= self.high else Verdict.DIFFERS

    @property
    def found(self) -> str:
        """The value in words."""
        if self.value is None:
            return "-"
        if self.unit == "yes or no":
            return "yes" if self.value == 1 else "no"
        return f"{number(self.value)} {self.unit}".strip()


@dataclass(frozen=True)
class Section:
    """One section of the report.

    Attributes:
        key: its anchor.
        title: its heading.
        parts: what it shows, in order.
        checks: its lines in the summary.
        numbers: its entries of summary.json, by dotted key.
    """

    key: str
    title: str
    parts: tuple[Part, ...]
    checks: tuple[Check, ...] = ()
    numbers: Mapping[str, Any] = field(default_factory=dict)

    @property
    def captions(self) -> tuple[str, ...]:
        """The captions of its figures."""
        return tuple(part.caption for part in self.parts if isinstance(part, Figure))


def number(value: float | None, digits: int = 3) -> str:
    """A number for people: 0.0871, 1.9e-15, 1200, "-" for None."""
    if value is None:
        return "-"
    if not math.isfinite(value):
        return "not a number" if math.isnan(value) else "infinite"
    if value != 0 and not 1e-3 <= abs(value) < 1e4:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
        return f"{mantissa}e{int(exponent)}"
    return f"{value:.{max(digits, len(str(int(abs(value)))))}g}"


def _joined(words: str, unit: str, source: str) -> str:
    text = f"{words} {unit}".strip()
    return f"{text} ({source})" if source else text
