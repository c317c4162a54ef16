"""Simple bodies that a picture is made of, in the ground frame, before they are seen from anywhere."""

from __future__ import annotations

from dataclasses import dataclass

from nullbody.typing import FloatArray

__all__ = ["Arrow", "Bar", "Face", "Line", "Mark", "Shape", "Text"]


@dataclass(frozen=True)
class Bar:
    """A rod between two points, in the colour of its body; `width` in points of the page."""

    points: FloatArray
    colour: str
    width: float = 5.0


@dataclass(frozen=True)
class Face:
    """A plane polygon: a plate, a side of a box, the floor. `back` is drawn behind everything."""

    points: FloatArray
    colour: str
    alpha: float = 0.95
    edge: bool = True
    back: bool = False


@dataclass(frozen=True)
class Line:
    """A thin line through points: a rail, a spring, a massless rod. `back` is drawn behind everything but the floor."""

    points: FloatArray
    colour: str
    width: float = 1.2
    dashed: bool = False
    back: bool = False


@dataclass(frozen=True)
class Mark:
    """A joint or a mass at a point: "pin", "ball" (a spherical joint), "mass" or "support"."""

    point: FloatArray
    kind: str
    colour: str = "white"


@dataclass(frozen=True)
class Arrow:
    """An input along a straight line or an arc, with its name where the line bends away or ends.

    `aside`: drawn beside the line, for a force between two bodies that lie on it.
    """

    points: FloatArray
    text: str
    aside: bool = False


@dataclass(frozen=True)
class Text:
    """A name at a point."""

    point: FloatArray
    text: str


Shape = Bar | Face | Line | Mark | Arrow | Text
