"""Spherical loop joint: two points coincide."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from nullbody.mechanism.joints.base import AbstractLoopJoint

__all__ = ["Spherical"]


@dataclass(frozen=True)
class Spherical(AbstractLoopJoint):
    """Point a of one body and point b of another coincide: Phi = a - b = 0, three equations [26].

    In a planar mechanism this is the loop's revolute joint: the equation across the plane repeats 0 = 0 and
    is left out by `derive`.
    """

    rows: ClassVar[tuple[str, ...]] = ("x", "y", "z")

    def closure(self, point_a: Sequence[Any], point_b: Sequence[Any]) -> list[Any]:
        """Phi = a - b [m]."""
        return [a - b for a, b in zip(point_a, point_b, strict=True)]
