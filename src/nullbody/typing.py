"""Types that appear in public signatures."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

__all__ = ["FloatArray", "IndexArray", "Scalar", "Triple"]

#: An array of doubles.
FloatArray = NDArray[np.float64]

#: An array of indices.
IndexArray = NDArray[np.intp]

#: A number, or a text in parameters such as "M*b^2/4" (grammar: `nullbody.expr.parse`).
Scalar = str | int | float | Fraction

#: Components along x, y, z.
Triple = tuple[Scalar, Scalar, Scalar]
