"""Matrices for the tests of numeric null spaces."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st

from nullbody.typing import FloatArray

__all__ = ["METHODS", "defective", "near_singular", "regular_stack"]

#: Every method that works one matrix after the other.
METHODS = ("complete", "lu", "qr", "svd", "minors")


@st.composite
def defective(draw: Any) -> FloatArray:
    """Small whole numbers with rank defects, zero rows and zero columns; never of full column rank."""
    n = draw(st.integers(2, 6))
    rows = draw(st.lists(st.lists(st.integers(-4, 4), min_size=n, max_size=n), min_size=1, max_size=n - 1))
    for _ in range(draw(st.integers(0, 3))):
        i, j = (draw(st.integers(0, len(rows) - 1)) for _ in range(2))
        factor = draw(st.integers(-2, 2))
        rows.insert(draw(st.integers(0, len(rows))), [a + factor * b for a, b in zip(rows[i], rows[j], strict=True)])
    A = np.array(rows, float)
    empty = draw(st.integers(-1, n - 1))
    if empty >= 0:
        A[:, empty] = 0
    return A


def regular_stack(k: int, m: int, n: int, seed: int = 0) -> FloatArray:
    return np.random.default_rng(seed).normal(size=(k, m, n))


def near_singular(distance: float, m: int = 5, n: int = 7, seed: int = 0) -> FloatArray:
    """Column m - 1 repeats the columns before it but for `distance`, so that the chart m..n-1 is almost singular."""
    generator = np.random.default_rng(seed)
    A = generator.normal(size=(m, n))
    A[:, m - 1] = A[:, : m - 1] @ generator.normal(size=m - 1) + distance * A[:, m - 1]
    return A
