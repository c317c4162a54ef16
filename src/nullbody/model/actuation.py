"""What inputs can do: over-actuated, under-actuated and exactly actuated mechanisms alike."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nullbody.typing import FloatArray

__all__ = ["Actuation", "solved"]

_RANK = 1e-10  # relative; singular values of Br below it are zero


@dataclass(frozen=True, eq=False)
class Actuation:
    """Inputs for wanted accelerations, and what is left over.

    Attributes:
        u: the inputs, of least norm among those with the least residual [N, N m].
        residual: Qr - Br u, the generalized forces along v that no input can give; zero where the motion is feasible.
        null_space: nu x k, orthonormal; u + null_space a drives the same motion for any a (internal forces).
        rank: of Br: how many degrees of freedom the inputs drive.
        feasible: whether the residual is zero to rounding.
    """

    u: FloatArray
    residual: FloatArray
    null_space: FloatArray
    rank: int
    feasible: bool


def solved(Qr: FloatArray, Br: FloatArray) -> Actuation:
    """Least squares by singular values."""
    nu = Br.shape[1]
    if not nu:
        return Actuation(np.zeros(0), Qr.copy(), np.zeros((0, 0)), 0, not np.abs(Qr).max(initial=0.0) > 0)
    left, sizes, right = np.linalg.svd(Br)
    rank = int(np.sum(sizes > _RANK * sizes.max(initial=0.0))) if sizes.max(initial=0.0) > 0 else 0
    u = right[:rank].T @ ((left[:, :rank].T @ Qr) / sizes[:rank])
    residual = Qr - Br @ u
    size = float(np.abs(Qr).max(initial=0.0))
    feasible = bool(np.abs(residual).max(initial=0.0) <= _RANK * max(size, 1e-300))
    return Actuation(u, residual, right[rank:].T.copy(), rank, feasible)
