"""The page: sections rendered into one self-contained HTML file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.resources import files

from nullbody.report.section import Figure, Listing, Section, Table, Text, Verdict

__all__ = ["page"]

_KIND = {Text: "text", Figure: "figure", Table: "table", Listing: "listing"}
_CLASS = {Verdict.AGREES: "good", Verdict.DIFFERS: "bad", Verdict.MISSING: "none"}
_SIGN = {Verdict.AGREES: "✓", Verdict.DIFFERS: "✗", Verdict.MISSING: "–"}


def page(sections: Sequence[Section], facts: Mapping[str, str]) -> str:
    """The whole report as HTML, without any reference to the outside.

    Args:
        sections: in order.
        facts: what the page says about the run: machine, versions, run time.
    """
    from jinja2 import Environment, StrictUndefined

    source = files("nullbody.report").joinpath("page.html.jinja").read_text(encoding="utf-8")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters["kind"] = lambda part: _KIND[type(part)]
    verdicts = [check.verdict for section in sections for check in section.checks]
    return environment.from_string(source).render(
        sections=sections,
        facts=facts,
        counts={verdict.name.lower(): verdicts.count(verdict) for verdict in Verdict},
        css={verdict: _CLASS[verdict] for verdict in Verdict},
        sign={verdict: _SIGN[verdict] for verdict in Verdict},
        figures=sum(len(section.captions) for section in sections),
    )
