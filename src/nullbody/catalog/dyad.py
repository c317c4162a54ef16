"""Where two bars meet: the closed form behind the home configurations of planar mechanisms."""

from __future__ import annotations

from math import acos, atan2, cos, hypot, sin

__all__ = ["Point", "dyad", "meets"]

#: x, y [m]
Point = tuple[float, float]


def dyad(a: Point, b: Point, ra: float, rb: float) -> Point:
    """The point at the distance ra from a and rb from b, on the left of the way from a to b [m].

    cos(turn) = (ra^2 + d^2 - rb^2) / (2 ra d) with d = |b - a|. Bars that are too short or too long to meet are
    stretched out: the point is at the distance ra from a, nearest to where rb would be.
    """
    x, y = b[0] - a[0], b[1] - a[1]
    d = hypot(x, y)
    cosine = (ra * ra + d * d - rb * rb) / (2 * ra * d) if d else 0.0
    heading = atan2(y, x) + acos(max(-1.0, min(1.0, cosine)))
    return a[0] + ra * cos(heading), a[1] + ra * sin(heading)


def meets(a: Point, b: Point, ra: float, rb: float) -> bool:
    """Whether the two bars are long enough and not too long: |ra - rb| < d < ra + rb."""
    return abs(ra - rb) < hypot(b[0] - a[0], b[1] - a[1]) < ra + rb
