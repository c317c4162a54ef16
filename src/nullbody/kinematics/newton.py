"""Newton's method on the loop closures, and the projection onto the constraint manifold."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from nullbody.model import Model
from nullbody.tolerances import CLOSED, EPS, GIVEN_CLOSED, LONGEST_NEWTON_STEP, NEWTON_STEPS, SETTLED
from nullbody.typing import FloatArray, IndexArray

__all__ = ["Closed", "close_loops", "closed_to", "project"]

_RANK = 1e-9  # singular values below this part of the largest do not steer a Newton step


class Closed(NamedTuple):
    """What Newton reached: coordinates, largest |Phi| [m], steps, and the path length it moved along."""

    q: FloatArray
    residual: float
    steps: int
    moved: float
    converged: bool


def closed_to(A: FloatArray, q: FloatArray) -> float:
    """|Phi| at which loops count as closed [m]: 1e-14, or 32 roundings of the lengths where that is more, at most 1e-9.

    The lengths are max_i sum_j |A_ij| max(|q_j|, 1): levers times angles, and displacements.
    """
    lengths = np.abs(A) @ np.maximum(np.abs(q), 1.0)
    return max(CLOSED, min(32 * EPS * float(lengths.max(initial=0.0)), GIVEN_CLOSED))


def close_loops(model: Model, q: FloatArray, free: IndexArray, t: float = 0.0) -> Closed:
    """Solve Phi(q) = 0 for the free coordinates by Newton with least-squares steps.

        dq_free = -A_free^+ Phi

    The step is the shortest one, so that where more coordinates are free than needed the result is near the
    guess. The last step is one below 1e-8, after which quadratic convergence has reached the rounding level.

    Args:
        model: the model.
        q: a guess of all coordinates.
        free: indices of the coordinates that may change.
        t: the time [s].
    """
    q = q.copy()
    moved = 0.0
    rank = min(model.holonomic_rank, len(free))
    Phi, A = _closure(model, q, t)
    residual = float(np.abs(Phi).max(initial=0.0))
    step = 0
    for step in range(NEWTON_STEPS):
        if residual <= EPS or not np.isfinite(residual):
            return Closed(q, residual, step, moved, converged=residual <= EPS)
        change = _newton_step(A[:, free], Phi, rank)
        length = float(np.abs(change).max(initial=0.0))
        if length > LONGEST_NEWTON_STEP:
            change *= LONGEST_NEWTON_STEP / length
        q[free] += change
        moved += min(length, LONGEST_NEWTON_STEP)
        Phi, A = _closure(model, q, t)
        residual = float(np.abs(Phi).max(initial=0.0))
        if length <= SETTLED:
            break
    return Closed(q, residual, step + 1, moved, converged=bool(residual <= closed_to(A, q)))


def _closure(model: Model, q: FloatArray, t: float) -> tuple[FloatArray, FloatArray]:
    """Phi and its Jacobian."""
    Phi, A = model.evaluate("closure", q, t=t)
    return Phi, A.reshape(len(Phi), len(q))


def _newton_step(A: FloatArray, Phi: FloatArray, rank: int) -> FloatArray:
    """-A^+ Phi: by LU where A is square and regular, otherwise by that many singular values at most.

    Rows that repeat others only where the loops are closed have a small singular value nearby, which must not steer.
    """
    if A.shape[0] == A.shape[1] == rank:
        try:
            change = np.asarray(np.linalg.solve(A, -Phi), dtype=np.float64)
        except np.linalg.LinAlgError:
            pass
        else:
            if np.abs(change).max(initial=0.0) <= LONGEST_NEWTON_STEP:
                return change
    if not A.size:
        return np.zeros(A.shape[1])
    left, sizes, right = np.linalg.svd(A, full_matrices=False)
    used = min(rank, int(np.sum(sizes > _RANK * sizes[0])))
    change = -(right[:used].T @ ((left[:, :used].T @ Phi) / sizes[:used]))
    return np.asarray(change, dtype=np.float64)


def project(model: Model, q: FloatArray, t: float = 0.0) -> tuple[FloatArray, float]:
    """The nearest point of the constraint manifold and its |Phi|: q - A^+ Phi, repeated [m]."""
    closed = close_loops(model, q, np.arange(len(q)), t)
    return closed.q, closed.residual
