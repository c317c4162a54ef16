"""Units: the texts of parameters and coordinates as exponents of SI base units."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

__all__ = ["base_units", "display_unit", "times"]

#: What the texts are made of, in kg, m, s, rad and so on.
_KNOWN: Mapping[str, Mapping[str, int]] = {
    **{name: {name: 1} for name in ("kg", "m", "s", "rad", "A", "K", "mol", "cd")},
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "Hz": {"s": -1},
    "1": {},
}
_FACTOR = re.compile(r"(\*|/)?\s*([A-Za-z]+|1)(?:\^?(-?\d+))?\s*")


def base_units(unit: str) -> dict[str, int] | None:
    """The exponents of the base units of a text such as "N m s/rad"; None where it is none that is known.

    Factors stand beside each other or with * between; / divides by the one factor behind it.
    """
    exponents: dict[str, int] = {}
    place = 0
    while place < len(unit):
        match = _FACTOR.match(unit, place)
        if match is None or match[2] not in _KNOWN:
            return None
        power = int(match[3] or 1) * (-1 if match[1] == "/" else 1)
        for name, exponent in _KNOWN[match[2]].items():
            exponents[name] = exponents.get(name, 0) + power * exponent
        place = match.end()
    return {name: exponent for name, exponent in exponents.items() if exponent}


def display_unit(unit: str) -> tuple[str, float] | None:
    """The unit in which people read angles, their rates and accelerations, and its factor; None for all else."""
    names = {"rad": "deg", "rad/s": "deg/s", "rad/s^2": "deg/s^2"}
    return (names[unit], 180.0 / math.pi) if unit in names else None


def times(unit: str, factor: str) -> str:
    """A unit with a factor such as "/s" behind it; nothing times 1/s is 1/s."""
    return unit + factor if unit else f"1{factor}"
