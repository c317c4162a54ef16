"""Null spaces by determinants, each computed on its own from numbers. A is m x n of rank m."""

from __future__ import annotations

import numpy as np

from nullbody.typing import FloatArray

__all__ = ["dai_jones", "determinants"]


def determinants(A: FloatArray) -> FloatArray:
    """N_ij = -|B(i <- C_j)| / |B| [11], the paper's proposed method: 28 determinants for a 9 x 12 matrix.

    The last n - m columns are the independent ones, C.
    """
    rows, size = A.shape
    B, C = A[:, :rows], A[:, rows:]
    N = np.eye(size)[:, rows:]
    delta = np.linalg.det(B)
    for j in range(size - rows):
        for i in range(rows):
            replaced = B.copy()
            replaced[:, i] = C[:, j]
            N[i, j] = -np.linalg.det(replaced) / delta
    return N


def dai_jones(A: FloatArray) -> FloatArray:
    """Cofactors of an augmenting row: for m x (m + 1) the null vector is x_k = (-1)^k |A without column k|.

    Several null vectors come from partitions: [B | C_j] for each independent column. Nothing is divided by, so that
    column j is N_j times +-|B|.

    J. S. Dai, J. Rees Jones: Null-space construction using cofactors from a screw-algebra context.
    Proc. R. Soc. Lond. A 458 (2002) 1845-1866.
    """
    rows, size = A.shape
    N = np.zeros((size, size - rows))
    for j in range(size - rows):
        columns = [*range(rows), rows + j]
        part = A[:, columns]
        for k, place in enumerate(columns):
            N[place, j] = (-1) ** k * np.linalg.det(np.delete(part, k, axis=1))
    return N
