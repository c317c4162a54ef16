"""The equations with multipliers, solved densely: the road that never eliminates anything.

[ M  A^T ] [ q''    ]   [ S u - h ]           [ S  -A^T ] [ u      ]
[ A   0  ] [ lambda ] = [  -c     ]                       [ lambda ] = M q'' + h
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping

import numpy as np

from nullbody.formats import number
from nullbody.mechanism import Mechanism
from nullbody.typing import FloatArray, IndexArray
from nullbody.verify.engine import AbstractEngine, Terms, input_matrix, kept_rows

__all__ = ["AbstractTermsEngine", "accelerations", "forces", "multipliers"]

_RANK = 1e-10  # relative; a redundant closure leaves about 1e-15, a regular state 1e-3 and more
_NOISE = 1e-12  # of a row whose point moves with its coordinate, for the heaviest body: below, it is rounding alone
_LIGHT = 1e-8  # M_ii against the largest: below, a coordinate is not scaled further (Euler parameters, massless parts)


class AbstractTermsEngine(AbstractEngine):
    """An engine that gives M, h, A, c: the dense solves are done here."""

    def __init__(self, mechanism: Mechanism, values: Mapping[str, float], labels: tuple[str, ...]) -> None:
        heaviest = max((number(body.mass, values) for body in mechanism.bodies), default=0.0)
        self._noise = _NOISE / np.sqrt(heaviest) if heaviest > 0 else 0.0
        self.labels = labels
        self._kept = kept_rows(mechanism, labels)
        self._S = input_matrix(mechanism)

    @abstractmethod
    def terms(self, q: FloatArray, q_dot: FloatArray, t: float = 0.0) -> Terms:
        """M, h, A, c at one state; A and c of all rows, holonomic ones first."""

    def forward_dynamics(
        self, q: FloatArray, q_dot: FloatArray, u: FloatArray, t: float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """(q'', lambda) for given inputs."""
        return accelerations(self.terms(q, q_dot, t), self._S @ u, self._kept, self._noise)

    def inverse_dynamics(
        self, q: FloatArray, q_dot: FloatArray, q_ddot: FloatArray, t: float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """(u, lambda) with S u - A^T lambda = M q'' + h."""
        return forces(self.terms(q, q_dot, t), self._S, q_ddot, self._kept, self._noise)

    def generalized_forces(self, q: FloatArray, q_dot: FloatArray, q_ddot: FloatArray, t: float = 0.0) -> FloatArray:
        """M q'' + h"""
        M, h, _, _ = self.terms(q, q_dot, t)
        return np.asarray(M @ q_ddot + h, dtype=np.float64)


def accelerations(
    terms: Terms, force: FloatArray, kept: IndexArray, noise: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """(q'', lambda) for generalized forces S u.

    All rows of A hold, redundant ones too; lambda is for the rows in `kept` alone (those must be independent).
    Coordinates are scaled by 1/sqrt(M_ii) and rows to unit length, so that units do not decide about rank. M may be
    singular along motions that A forbids, as that of Euler parameters along e. Scaled rows below `noise` hold nothing:
    they are what rounding leaves of a loop between two bodies that cannot move against each other.
    """
    M, h, A, c = terms
    size, rows = len(h), len(c)
    D, E = _scales(M, A, noise)
    A_scaled = E[:, None] * A * D
    matrix = np.block([[D[:, None] * M * D, A_scaled.T], [A_scaled, np.zeros((rows, rows))]])
    right = np.concatenate([D * (force - h), -E * c])
    regular = rows == 0 or np.linalg.matrix_rank(A_scaled, tol=_RANK) == rows
    solution: FloatArray = np.linalg.solve(matrix, right) if regular else np.linalg.lstsq(matrix, right, rcond=_RANK)[0]
    q_ddot: FloatArray = D * solution[:size]
    if len(kept) == rows:
        return q_ddot, E * solution[size:]
    return q_ddot, E[kept] * multipliers(A_scaled[kept], D * (force - M @ q_ddot - h))


def forces(
    terms: Terms, S: FloatArray, q_ddot: FloatArray, kept: IndexArray, noise: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """(u, lambda) for accelerations that fulfil A q'' + c = 0."""
    M, h, A, _ = terms
    D, E = _scales(M, A, noise)
    matrix = np.hstack([D[:, None] * S, -D[:, None] * A[kept].T * E[kept]])
    solution = np.asarray(np.linalg.lstsq(matrix, D * (M @ q_ddot + h), rcond=_RANK)[0], dtype=np.float64)
    inputs = S.shape[1]
    return solution[:inputs], E[kept] * solution[inputs:]


def multipliers(A: FloatArray, unbalanced: FloatArray) -> FloatArray:
    """lambda with A^T lambda = Q - M q'' - h."""
    return np.asarray(np.linalg.lstsq(A.T, unbalanced, rcond=_RANK)[0], dtype=np.float64)


def _scales(M: FloatArray, A: FloatArray, noise: float) -> tuple[FloatArray, FloatArray]:
    """D = 1/sqrt(M_ii) of the coordinates and E = 1/|A_i D| of the rows; 0 for rows that are noise."""
    inertia = np.diag(M)
    largest = float(inertia.max(initial=0.0))
    D = 1 / np.sqrt(np.maximum(inertia, _LIGHT * largest)) if largest > 0 else np.ones(len(inertia))
    length = np.linalg.norm(A * D, axis=1)
    counts = length > max(_RANK * float(length.max(initial=0.0)), noise)
    return D, counts / np.where(counts, length, 1.0)
