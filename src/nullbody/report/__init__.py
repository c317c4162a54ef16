"""Layer 10: the paper's evidence computed anew, as a page and a JSON file of numbers; pictures of any mechanism."""

from nullbody.report.album import draw_catalog
from nullbody.report.draw import draw
from nullbody.report.picture import robot_picture
from nullbody.report.reproduce import reproduce, sections
from nullbody.report.section import Check, Figure, Listing, Section, Table, Text, Verdict

__all__ = [
    "Check",
    "Figure",
    "Listing",
    "Section",
    "Table",
    "Text",
    "Verdict",
    "draw",
    "draw_catalog",
    "reproduce",
    "robot_picture",
    "sections",
]
