"""Curves over an error panel: how Figs. 5 to 7 are drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nullbody.report.figure import BLACK, COLOURS, end_labels
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Error", "Panel", "Series", "draw_panel"]

_FLOOR = 1e-17  # what a difference of exactly zero is drawn as


@dataclass(frozen=True, eq=False)
class Series:
    """Several quantities over time (times x quantities), drawn in one way.

    Attributes:
        times, values: may end before the panel does.
        marker: "" for a line.
        line: matplotlib's line style.
        every: draw each so many-th point.
        faded: a quiet line in the colour of the quantity.
    """

    times: FloatArray
    values: FloatArray
    marker: str = ""
    line: str = "-"
    every: int = 1
    faded: bool = False


@dataclass(frozen=True, eq=False)
class Error:
    """One line of the error panel: the largest error over all quantities."""

    label: str
    times: FloatArray
    values: FloatArray
    colour: str
    line: str = "-"


@dataclass(frozen=True, eq=False)
class Panel:
    """A set of quantities with its error panel beneath.

    Attributes:
        title, unit: of the quantities.
        names: labels at the curves' ends.
        series: first the reference, which decides the limits of the axis.
        errors: lines of the error panel.
        limits: the error panel's.
    """

    title: str
    unit: str
    names: tuple[str, ...]
    series: Sequence[Series]
    errors: Sequence[Error]
    limits: tuple[float, float] = (1e-18, 1e1)


def draw_panel(top: Axes, bottom: Axes, panel: Panel, end: float) -> None:
    """Draw the curves into `top` and the errors, on a logarithmic axis, into `bottom`."""
    top.set_title(panel.title)
    top.set_ylabel(panel.unit)
    reference = panel.series[0].values
    margin = 0.12 * float(np.ptp(reference)) or 1.0
    top.set_ylim(float(reference.min()) - margin, float(reference.max()) + margin)
    for series in panel.series:
        for k, colour in enumerate(COLOURS[: len(panel.names)]):
            style = {"alpha": 0.9, "lw": 1.1} if series.faded else {}
            top.plot(
                series.times[:: series.every],
                series.values[:: series.every, k],
                color=colour,
                ls=series.line,
                marker=series.marker or None,
                mfc="none" if series.marker in "os" else colour,
                mec=BLACK if series.marker in "x+" else colour,
                **style,  # type: ignore[arg-type]
            )
    for axes in (top, bottom):
        axes.set_xlim(0, end)
    ends = [(float(reference[-1, k]), name, COLOURS[k]) for k, name in enumerate(panel.names)]
    end_labels(top, ends)
    top.tick_params(labelbottom=False)
    for error in panel.errors:
        shown = np.maximum(np.abs(error.values), _FLOOR)
        bottom.semilogy(error.times, shown, color=error.colour, ls=error.line, lw=1.3, label=error.label)
    bottom.set_ylim(*panel.limits)
    low, high = (round(np.log10(limit)) for limit in panel.limits)
    bottom.set_yticks([10.0**power for power in range(low + 1, high + 1, max(1, (high - low) // 4))])
    bottom.minorticks_off()
    bottom.set_ylabel(f"error [{panel.unit.split('[')[-1]}")
