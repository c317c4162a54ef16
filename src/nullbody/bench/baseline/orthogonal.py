"""Null spaces from orthogonal matrices, and their continuation along a motion. A is m x n of rank m."""

from __future__ import annotations

import numpy as np

from nullbody.typing import FloatArray

__all__ = ["KimVanderploeg", "householder", "kim_vanderploeg", "liang_lance", "singh_likins", "walton_steeves"]

_WIDEST = 1.0  # tangent of the angle between the subspaces beyond which the reference is renewed: 45 degrees


def singh_likins(A: FloatArray) -> FloatArray:
    """The right singular vectors of the zeros in A = U S V^T: orthonormal, but not continuous along a motion.

    R. P. Singh, P. W. Likins: Singular value decomposition for constrained dynamical systems.
    J. Applied Mechanics 52 (1985) 943-948; N. K. Mani, E. J. Haug, K. E. Atkinson (1985) likewise.
    """
    return np.linalg.svd(A)[2][len(A) :].T


def walton_steeves(A: FloatArray) -> FloatArray:
    """The eigenvectors of A^T A with eigenvalue 0: orthonormal; forming A^T A squares the condition of A.

    W. C. Walton, E. C. Steeves: A new matrix theorem and its application for establishing independent coordinates for
    complex dynamical systems with constraints. NASA TR R-326 (1969); with Kane's equations: J. W. Kamman, R. L. Huston,
    J. Applied Mechanics 51 (1984) 899-903.
    """
    return np.linalg.eigh(A.T @ A)[1][:, : A.shape[1] - len(A)]


def householder(A: FloatArray) -> FloatArray:
    """Q2 of A^T = [Q1 | Q2] [R; 0] by Householder reflections (LAPACK's geqrf)."""
    return np.linalg.qr(A.T, mode="complete")[0][:, len(A) :]


def kim_vanderploeg(A: FloatArray, Q: FloatArray) -> FloatArray:
    """The basis with Q2^T N = I, for Q = [Q1 | Q2] of a state near by: N = Q2 - Q1 (A Q1)^-1 A Q2.

    The independent velocities Q2^T q' keep their directions, so that N is smooth in A; not orthonormal but at the
    reference itself.

    S. S. Kim, M. J. Vanderploeg: QR decomposition for state space representation of constrained mechanical dynamic
    systems. J. Mechanisms, Transmissions, and Automation in Design 108 (1986) 183-188.
    """
    Q1, Q2 = Q[:, : len(A)], Q[:, len(A) :]
    return Q2 - Q1 @ np.linalg.solve(A @ Q1, A @ Q2)


class KimVanderploeg:
    """`kim_vanderploeg` along a motion: a new QR where the subspace has turned by 45 degrees since the last one.

    Attributes:
        factorisations: how many there were.
    """

    def __init__(self) -> None:
        self.factorisations = 0
        self._Q: FloatArray | None = None

    def __call__(self, A: FloatArray) -> FloatArray:
        """The basis at the next state."""
        if self._Q is not None and self._Q.shape[0] == A.shape[1]:
            N = kim_vanderploeg(A, self._Q)
            if np.linalg.norm(self._Q[:, : len(A)].T @ N) <= _WIDEST:
                return N
        self._Q = np.linalg.qr(A.T, mode="complete")[0]
        self.factorisations += 1
        return self._Q[:, len(A) :]


def liang_lance(A: FloatArray, complement: FloatArray | None = None) -> FloatArray:
    """Gram-Schmidt (modified) on [A^T | W]; the tail is orthonormal and, W being fixed, differentiable in A.

    C. G. Liang, G. M. Lance: A differentiable null space method for constrained dynamic analysis.
    J. Mechanisms, Transmissions, and Automation in Design 109 (1987) 405-411.

    Args:
        A: m x n.
        complement: W, n x (n - m), such that [A^T | W] is regular; by default the last unit vectors.
    """
    rows, size = A.shape
    W = np.eye(size)[:, rows:] if complement is None else complement
    Q = np.hstack([A.T, W])
    for k in range(size):
        Q[:, k] /= np.linalg.norm(Q[:, k])
        Q[:, k + 1 :] -= np.outer(Q[:, k], Q[:, k] @ Q[:, k + 1 :])
    return Q[:, rows:]
