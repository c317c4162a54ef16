"""The angle between subspaces: how far a computed null space is from the true one."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from nullbody.errors import InputError
from nullbody.nullspace.numeric.equilibrate import Array, finite_numbers
from nullbody.tolerances import EPS

__all__ = ["subspace_angle"]


def subspace_angle(N1: ArrayLike, N2: ArrayLike) -> Any:
    """The largest principal angle [rad] between the spaces spanned by the columns of N1 and N2.

    sin = |(I - Q1 Q1^H) Q2| with orthonormal bases Q1, Q2 by Householder QR: accurate also for tiny angles; where the
    sine is above 1/sqrt(2), the cosine is the smallest singular value of Q1^H Q2.

    Args:
        N1: a basis (n, d), or a stack of them (k, n, d).
        N2: likewise, of the same shape; one basis is compared with each one of a stack.

    Returns:
        A float, or an array (k,).

    Raises:
        InputError: different sizes, entries that are not finite, or dependent columns.

    Source: A. Bjorck, G. H. Golub, Mathematics of Computation 27 (1973) 579-594.
    """
    first, second = finite_numbers(N1, "N1")[0], finite_numbers(N2, "N2")[0]
    if first.ndim not in (2, 3) or second.ndim not in (2, 3) or first.shape[-2:] != second.shape[-2:]:
        raise InputError(f"two bases (n, d) of one size are compared, not shapes {first.shape} and {second.shape}")
    if first.ndim == second.ndim == 3 and len(first) != len(second):
        raise InputError(f"stacks of {len(first)} and {len(second)} bases cannot be compared one by one")
    if 0 in first.shape[-2:]:
        stacks = [len(basis) for basis in (first, second) if basis.ndim == 3]
        return np.zeros(stacks[0]) if stacks else 0.0
    Q1, Q2 = _orthonormal(first, "N1"), _orthonormal(second, "N2")
    cosines = Q1.conj().swapaxes(-1, -2) @ Q2
    rest = Q2 - Q1 @ cosines
    rest = rest - Q1 @ (Q1.conj().swapaxes(-1, -2) @ rest)  # once more: the first projection left rounding
    sine = np.minimum(np.linalg.svd(rest, compute_uv=False)[..., 0], 1)
    cosine = np.minimum(np.linalg.svd(cosines, compute_uv=False)[..., -1], 1)
    angle = np.where(sine**2 < 0.5, np.arcsin(sine), np.arccos(cosine))
    return angle if angle.ndim else float(angle)


def _orthonormal(N: Array, name: str) -> Array:
    """An orthonormal basis of the space that the columns span."""
    size = abs(N).max(axis=-2, keepdims=True)
    Q, R = np.linalg.qr(N / np.where(size > 0, size, 1))
    if R.shape[-2] < R.shape[-1] or (abs(np.diagonal(R, axis1=-2, axis2=-1)) <= EPS).any():
        raise InputError(f"the columns of {name} are dependent to rounding: they are no basis")
    return np.asarray(Q)
