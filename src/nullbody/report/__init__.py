"""Layer 9: the paper's evidence computed anew, as a self-contained page and a JSON file of numbers."""

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
    "reproduce",
    "robot_picture",
    "sections",
]
