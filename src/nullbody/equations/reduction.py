"""Elimination of the multipliers by the null space (theory 3, [38-46] corrected).

q'  = N v                                                                                   [3, 9]
q'' = N v' + gamma,          gamma = [-B^-1 c; 0]                                           [40, 41 corrected]
Mr v' + hr = Br u,           Mr = N^T M N,  hr = N^T (h + M gamma),  Br u = N^T Q           [39, 42 corrected]
forward:                     v' = Mr^-1 (Br u - hr)                                         [43-46 corrected]
inverse:                     Br u = N^T (M (N v' + gamma) + h)                              [42]
reactions:                   B^T lambda = (Q - M q'' - h) in the dependent places           [34]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.errors import MechanismError
from nullbody.expr.matrix import Matrix, Vector, add, dot, matmul, matvec, scale, total, transpose
from nullbody.nullspace.elimination import eliminate
from nullbody.nullspace.plan import Plan
from nullbody.nullspace.scalar import is_zero
from nullbody.nullspace.steps import sparse_rows

__all__ = [
    "Reduced",
    "acceleration",
    "forward",
    "gross",
    "input_matrix",
    "inverse",
    "reduce",
    "required_inputs",
    "solve_symmetric",
]


@dataclass(frozen=True)
class Reduced:
    """Mr (nv x nv) and hr (nv) for a given gamma."""

    Mr: list[list[Any]]
    hr: list[Any]

    def plus(self, other: Reduced) -> Reduced:
        """The sum of two systems that move with the same velocities."""
        rows = zip(self.Mr, other.Mr, strict=True)
        return Reduced([add(a, b) for a, b in rows], add(self.hr, other.hr))


def reduce(M: Matrix, h: Vector, N: Matrix, gamma: Vector) -> Reduced:
    """Mr = N^T M N and hr = N^T (h + M gamma); the lower triangle of Mr is the upper one."""
    rows = transpose(N)
    MN = transpose(matmul(M, N))
    d = len(rows)
    upper = {(i, j): dot(rows[i], MN[j]) for i in range(d) for j in range(i, d)}
    Mr = [[upper[min(i, j), max(i, j)] for j in range(d)] for i in range(d)]
    return Reduced(Mr, matvec(rows, add(h, matvec(M, gamma))))


def acceleration(N: Matrix, v_dot: Sequence[Any], gamma: Vector) -> list[Any]:
    """q'' = N v' + gamma"""
    return add(matvec(N, v_dot), gamma)


def input_matrix(N: Matrix, columns: Sequence[Vector]) -> list[list[Any]]:
    """Br = N^T S, nv x nu: how the inputs act on v; `columns` are those of S."""
    return [[dot(column, s) for s in columns] for column in transpose(N)]


def gross(M: Matrix, N: Matrix) -> list[Any]:
    """sum_k N_kj^2 M_kk for each j: the size of what adds up to Mr_jj, before anything cancels."""
    diagonal = [M[k][k] for k in range(len(M))]
    return [dot([entry * entry for entry in column], diagonal) for column in transpose(N)]


def forward(reduced: Reduced, Br: Matrix, u: Vector, size: Vector) -> tuple[list[Any], Any]:
    """v' = Mr^-1 (Br u - hr), and its loss: sum_j size_j / D_j with the pivots D of Mr, `size` from `gross`.

    Raises:
        MechanismError: Mr is singular in every configuration.
    """
    try:
        v_dot, pivots = solve_symmetric(reduced.Mr, add(matvec(Br, u), scale(-1, reduced.hr)))
    except ZeroDivisionError:
        raise MechanismError(
            "the reduced mass matrix is singular in every configuration: some motion moves no mass; "
            "give the bodies that move with it a mass or an inertia"
        ) from None
    return v_dot, dot(size, pivots)


def inverse(M: Matrix, h: Vector, N: Matrix, q_ddot: Vector) -> list[Any]:
    """Qr = N^T (M q'' + h): the forces along v that accelerations need."""
    return matvec(transpose(N), add(matvec(M, q_ddot), h))


def required_inputs(Br: Matrix, Qr: Sequence[Any]) -> list[Any]:
    """u with Br u = Qr where there is one input for each degree of freedom; none otherwise."""
    if not Br or len(Br) != len(Br[0]):
        return []
    factors = eliminate(sparse_rows(Br), plan=Plan(simplify=False, offsets=True))
    return [] if is_zero(factors.delta) else factors.solve(Qr)


def solve_symmetric(matrix: Matrix, right: Sequence[Any]) -> tuple[list[Any], list[Any]]:
    """x with S x = r for a positive definite S, by S = L D L^T without square roots.

    Returns:
        x, and the reciprocals of the pivots D.
    """
    n = len(right)
    L: list[list[Any]] = [[0] * n for _ in range(n)]
    D: list[Any] = []
    inverse: list[Any] = []
    for j in range(n):
        LD = [L[j][k] * D[k] for k in range(j)]
        D.append(total((matrix[j][j], -dot(L[j][:j], LD))))
        inverse.append(1 / D[j])
        for i in range(j + 1, n):
            L[i][j] = total((matrix[i][j], -dot(L[i][:j], LD))) * inverse[j]
    y: list[Any] = []
    for i in range(n):
        y.append(total((right[i], -dot(L[i][:i], y))))
    x: list[Any] = scale(1, [a * b for a, b in zip(y, inverse, strict=True)])
    for i in reversed(range(n)):
        x[i] = total((x[i], -dot([L[k][i] for k in range(i + 1, n)], x[i + 1 :])))
    return x, inverse
