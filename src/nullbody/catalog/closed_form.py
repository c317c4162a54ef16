"""What the catalog knows in closed form about the kinematics of its mechanisms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

__all__ = ["ClosedForm"]

Values = Mapping[str, float]


class ClosedForm(NamedTuple):
    """Closed-form kinematics of one mechanism; each gives None for known coordinates that it does not cover.

    Attributes:
        assemblies: (parameters, known coordinates) -> all assemblies, every coordinate by name.
        inverse: (parameters, end-effector coordinates) -> all assemblies; raises AssemblyError out of reach.
    """

    assemblies: Callable[[Values, Values], list[dict[str, float]] | None]
    inverse: Callable[[Values, Values], list[dict[str, float]] | None]
