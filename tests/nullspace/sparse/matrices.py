"""Sparse matrices that the tests share, and what dense linear algebra says about them."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st
from scipy import sparse
from scipy.linalg import null_space

from nullbody.nullspace.sparse import SparseNullSpace

__all__ = ["chain", "dense", "incidence", "random_sparse", "regular_rows", "sparse_matrices", "svd_basis"]


def random_sparse(m: int, n: int, in_row: float, seed: int = 0, whole: bool = False) -> Any:
    """Normal entries, or integers in -2..2 with zeros among them, `in_row` a row on average."""
    rng = np.random.default_rng(seed)

    def entries(size: int) -> Any:
        return rng.integers(-2, 3, size).astype(float) if whole else rng.standard_normal(size)

    return sparse.random_array((m, n), density=min(1, in_row / n), rng=rng, data_sampler=entries, format="csr")


def regular_rows(m: int, n: int, in_row: float, seed: int = 0) -> Any:
    """Random rows that are independent: a large entry of its own in each."""
    own = sparse.csr_array((np.full(m, 5.0), (np.arange(m), np.arange(m))), shape=(m, n))
    return (random_sparse(m, n, in_row, seed) + own).tocsr()


def chain(loops: int, seed: int = 0) -> Any:
    """Constraint Jacobian of a chain of four-bars in absolute coordinates (x, y, angle), 8 N x 9 N.

    Each loop has three bars and four joints; it hangs at the coupler of the loop before.
    """
    rng = np.random.default_rng(seed)
    rows, columns, values = [], [], []
    for loop in range(loops):
        base = 9 * (loop - 1) + 3 if loop else None
        bars = [base, *(9 * loop + 3 * k for k in range(3)), base]
        for joint in range(4):
            for bar, sign in ((bars[joint], 1.0), (bars[joint + 1], -1.0)):
                angle, length = rng.uniform(0, 2 * np.pi), rng.uniform(0.2, 1)
                if bar is None:
                    continue
                for axis, arm in enumerate((-length * np.sin(angle), length * np.cos(angle))):
                    rows += [8 * loop + 2 * joint + axis] * 2
                    columns += [bar + axis, bar + 2]
                    values += [sign, sign * arm]
    return sparse.csr_array((values, (rows, columns)), shape=(8 * loops, 9 * loops))


def incidence(side: int) -> Any:
    """Nodes x edges of a square grid: rank is the number of nodes less 1, the null space are the grid's loops."""
    number = np.arange(side * side).reshape(side, side)
    ends = [(number[:, :-1], number[:, 1:]), (number[:-1], number[1:])]
    first, last = (np.concatenate([pair[k].ravel() for pair in ends]) for k in range(2))
    edges = np.arange(len(first))
    signs = np.concatenate([np.ones(len(edges)), -np.ones(len(edges))])
    return sparse.csr_array((signs, (np.concatenate([first, last]), np.tile(edges, 2))))


@st.composite
def sparse_matrices(draw: st.DrawFn) -> Any:
    """Many shapes and ranks: with combinations of rows, empty rows and columns, real and complex."""
    m, n, seed = draw(st.integers(1, 60)), draw(st.integers(2, 90)), draw(st.integers(0, 10**6))
    A = random_sparse(m, n, draw(st.integers(1, 4)), seed, draw(st.booleans()))
    if draw(st.booleans()):
        more = random_sparse(draw(st.integers(1, m)), m, 3, seed + 1, draw(st.booleans()))
        A = sparse.vstack([A, more @ A], format="csr")
        A = A[np.random.default_rng(seed).permutation(A.shape[0])]
    return A * (1 + 0.5j) + A * (A > 0) * 1j if draw(st.booleans()) else A


def svd_basis(A: Any) -> Any:
    """An orthonormal basis of the null space by dense SVD, rows scaled to a largest entry of 1."""
    full = A.toarray()
    size = abs(full).max(axis=1, initial=0)
    return null_space(full / np.where(size > 0, size, 1)[:, None])


def dense(space: SparseNullSpace) -> Any:
    """The reduced basis as a dense array."""
    return space.in_form("reduced").toarray()
