"""The page: sections rendered into one self-contained HTML file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files

from nullbody.report.section import Figure, Listing, Section, Table, Text, Verdict

__all__ = ["REPRODUCTION", "Cover", "page"]

_KIND = {Text: "text", Figure: "figure", Table: "table", Listing: "listing"}
_CLASS = {Verdict.AGREES: "good", Verdict.DIFFERS: "bad", Verdict.MISSING: "none"}
_SIGN = {Verdict.AGREES: "✓", Verdict.DIFFERS: "✗", Verdict.MISSING: "–"}


@dataclass(frozen=True)
class Cover:
    """What stands on top of a page.

    Attributes:
        name: of the window.
        title: the heading.
        about: a paragraph below it.
    """

    name: str
    title: str
    about: str


REPRODUCTION = Cover(
    "nullbody reproduce: the 3-PRS robot",
    "The 3-PRS robot, reproduced and checked",
    "This page redoes the evidence of a 2020 paper on modelling a 3-PRS parallel robot by the null space of its "
    "constraint Jacobian (natural orthogonal complement). Every number was computed on this machine when the page was "
    "made; only those marked as the paper's or as a reference are quoted. Equation and figure numbers in brackets are "
    "the paper's. The last three sections leave the paper: other mechanisms, singularities, published benchmarks.",
)


def page(sections: Sequence[Section], facts: Mapping[str, str], cover: Cover = REPRODUCTION) -> str:
    """A whole page as HTML, without any reference to the outside.

    Args:
        sections: in order.
        facts: what the page says about the run: machine, versions, run time.
        cover: what stands on top.
    """
    from jinja2 import Environment, StrictUndefined

    source = files("nullbody.report").joinpath("page.html.jinja").read_text(encoding="utf-8")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["kind"] = lambda part: _KIND[type(part)]
    verdicts = [check.verdict for section in sections for check in section.checks]
    return environment.from_string(source).render(
        cover=cover,
        sections=sections,
        facts=facts,
        counts={verdict.name.lower(): verdicts.count(verdict) for verdict in Verdict},
        css={verdict: _CLASS[verdict] for verdict in Verdict},
        sign={verdict: _SIGN[verdict] for verdict in Verdict},
        figures=sum(len(section.captions) for section in sections),
    )
