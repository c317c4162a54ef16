"""The style of all figures. Figure objects are made directly, without pyplot, so that nothing global is left behind."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

__all__ = [
    "BLACK",
    "BLUE",
    "COLOURS",
    "GREEN",
    "GREY",
    "ORANGE",
    "PURPLE",
    "SKY",
    "drawing",
    "end_labels",
    "save",
    "svg",
]

# Okabe and Ito's palette: distinct for all common kinds of colour blindness and in grey.
BLUE, ORANGE, GREEN, PURPLE, SKY = "#0072B2", "#D55E00", "#009E73", "#AA4499", "#56B4E9"
BLACK, GREY = "#222222", "#8a8a8a"
COLOURS = (BLUE, ORANGE, GREEN)

_STYLE: dict[str, Any] = {
    "axes.axisbelow": True,
    "axes.edgecolor": "#555555",
    "axes.grid": True,
    "axes.labelsize": 9,
    "axes.prop_cycle": "",
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "figure.facecolor": "white",
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.6,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "lines.linewidth": 1.7,
    "lines.markersize": 5,
    "svg.fonttype": "path",
    "svg.hashsalt": "nullbody",
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
}
_NO_DATE = {"Date": None, "Creator": None, "Format": None, "Type": None}


@contextmanager
def drawing(width: float, height: float, *, fixed: bool = False) -> Iterator[Canvas]:
    """A new figure of a size in inches; draw and save it inside the `with` block, where the style holds.

    Places of axes are found by matplotlib, or `fixed` by the caller, which is faster for many axes.
    """
    import matplotlib
    from cycler import cycler
    from matplotlib.figure import Figure as Canvas

    style: Any = {**_STYLE, "axes.prop_cycle": cycler(color=[BLUE, ORANGE, GREEN, PURPLE, SKY, BLACK])}
    with matplotlib.rc_context(style):
        yield Canvas(figsize=(width, height), layout=None if fixed else "constrained")


def svg(canvas: Canvas) -> str:
    """The figure as an <svg> element that can stand inside a page: no prolog, no metadata, as wide as its place."""
    stream = io.StringIO()
    canvas.savefig(stream, format="svg", metadata=_NO_DATE)
    text = stream.getvalue()
    text = re.sub(r"\s*<metadata>.*?</metadata>", "", text[text.index("<svg") :], flags=re.DOTALL)
    text = re.sub(r'(<svg [^>]*?) width="[^"]*"', r"\1", text, count=1)
    text = re.sub(r'(<svg [^>]*?) height="[^"]*"', r"\1", text, count=1)
    return text.replace("<svg ", '<svg role="img" ', 1).strip()


def save(canvas: Canvas, path: Path) -> None:
    """Write the figure in the format of the path's suffix."""
    canvas.savefig(path, dpi=200)


def end_labels(axes: Axes, entries: list[tuple[float, str, str]], gap: float = 0.085) -> None:
    """Labels right of the axes, at the heights of the curves' ends, moved apart where they would overlap.

    Args:
        axes: with its limits set.
        entries: (height in data units, label, colour).
        gap: smallest distance of two labels, as a part of the axes' height.
    """
    to_axes = axes.transData + axes.transAxes.inverted()
    groups: list[list[tuple[float, str, str]]] = []
    for height, label, colour in sorted(entries):
        groups.append([(float(to_axes.transform((0, height))[1]), label, colour)])
        while len(groups) > 1 and _reach(groups[-2], gap)[1] + gap > _reach(groups[-1], gap)[0]:
            groups[-2:] = [groups[-2] + groups[-1]]
    for group in groups:
        low, _ = _reach(group, gap)
        for place, (_, label, colour) in enumerate(group):
            y = low + place * gap
            axes.text(1.015, y, label, color=colour, transform=axes.transAxes, va="center", fontsize=8.5, clip_on=False)


def _reach(group: list[tuple[float, str, str]], gap: float) -> tuple[float, float]:
    """Lowest and highest label of a group that is spread about its mean."""
    middle, half = sum(y for y, _, _ in group) / len(group), (len(group) - 1) * gap / 2
    return middle - half, middle + half
