"""What the checks in C allow: the tolerances of the models for doubles, and their counterparts for floats.

A double may lose 7 of its 16 digits before a result is refused, a float 4 of its 7.
"""

from __future__ import annotations

from typing import NamedTuple

from nullbody.kernels.c99 import Real
from nullbody.tolerances import (
    EPS,
    GIVEN_CLOSED,
    LARGE_SPREAD,
    REGULAR_DOUBT,
    REGULAR_LOSS,
    REGULAR_SPREAD,
    SETTLED,
    SINGLE_DOUBT,
    SINGLE_EPS,
    SINGLE_LOSS,
    SINGLE_SPREAD,
)

__all__ = ["EPSILON", "LIMITS", "Limits"]

#: The distance from 1 to the next number.
EPSILON = {"double": EPS, "float": SINGLE_EPS}


class Limits(NamedTuple):
    """What results may reach.

    Attributes:
        closed: |Phi| of a closed state [m].
        spread, large_spread: |N|^2 of a good result, and where a bad one is put down to the coordinates.
        doubt: how far |B| may be rounding, as (ratio)^-2.
        loss: what cancels in N^T M N.
        rank: smallest pivot of Br against the largest, or 1.
        step: a Newton correction after which the next one is rounding [m, rad].
    """

    closed: float
    spread: float
    large_spread: float
    doubt: float
    loss: float
    rank: float
    step: float


LIMITS: dict[Real, Limits] = {
    "double": Limits(GIVEN_CLOSED, REGULAR_SPREAD, LARGE_SPREAD, REGULAR_DOUBT, REGULAR_LOSS, 1e-10, SETTLED),
    "float": Limits(
        closed=1e-5,  # 80 roundings of a metre
        spread=SINGLE_SPREAD,
        large_spread=LARGE_SPREAD,
        doubt=SINGLE_DOUBT,
        loss=SINGLE_LOSS,
        rank=1e-4,
        step=1e-4,
    ),
}
