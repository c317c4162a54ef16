"""How much a chart magnifies, without forming N: largest singular values by power iteration with the factors."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from nullbody.nullspace.numeric.equilibrate import Array
from nullbody.nullspace.sparse.factor import Factors

__all__ = ["largest_of_basis", "largest_of_inverse"]

#: The iteration ends when a step changes the value by less, relatively, or after so many steps.
_SETTLED, _STEPS = 1e-4, 100

#: The first vector is random, with a fixed seed.
_SEED = 0


def largest_of_basis(factors: Factors) -> float:
    """The largest singular value of N = [-B^-1 C; I], to about three digits, from below."""
    return _largest(
        factors.move,
        lambda x: factors.transposed(x.conj())[1].conj(),
        len(factors.independent),
    )


def largest_of_inverse(factors: Factors) -> float:
    """The largest singular value of B^-1 for rows scaled to a largest entry near 1, likewise; 0 without rows."""
    m, used = factors.shape[0], factors.rows
    if not len(used):
        return 0.0

    def backwards(x: Array) -> Array:
        return factors.transposed(x.conj())[0][used].conj()

    def forwards(b: Array) -> Array:
        right = np.zeros((m, 1), b.dtype)
        right[used] = b
        return factors.solve(right)

    return _largest(forwards, backwards, len(used))


def _largest(forwards: Callable[[Array], Array], backwards: Callable[[Array], Array], size: int) -> float:
    v: Array = np.random.default_rng(_SEED).standard_normal((size, 1))
    v /= np.linalg.norm(v)
    value = 0.0
    for _ in range(_STEPS):
        image = forwards(v)
        before, value = value, float(np.linalg.norm(image))
        if value <= before * (1 + _SETTLED) or not np.isfinite(value):
            break
        v = backwards(image / value)
        v /= np.linalg.norm(v)
    return value
