"""Elimination of the multipliers by the null space (theory 3, [39-46] corrected).

q' = N v,   q'' = N v' + gamma,   gamma = [-B^-1 c; 0]
Mr v' + hr = N^T Q,   Mr = N^T M N,   hr = N^T (h + M gamma)
B^T lambda = (Q - M q'' - h) in the dependent places
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.expr.matrix import Matrix, Vector, add, dot, matmul, matvec, scale, total, transpose

__all__ = ["Reduced", "reduce", "solve_symmetric"]


@dataclass(frozen=True)
class Reduced:
    """Mr (nv x nv) and hr (nv) for a given gamma."""

    Mr: list[list[Any]]
    hr: list[Any]


def reduce(M: Matrix, h: Vector, N: Matrix, gamma: Vector) -> Reduced:
    """Mr = N^T M N and hr = N^T (h + M gamma); the lower triangle of Mr is the upper one."""
    rows = transpose(N)
    MN = transpose(matmul(M, N))
    d = len(rows)
    upper = {(i, j): dot(rows[i], MN[j]) for i in range(d) for j in range(i, d)}
    Mr = [[upper[min(i, j), max(i, j)] for j in range(d)] for i in range(d)]
    return Reduced(Mr, matvec(rows, add(h, matvec(M, gamma))))


def solve_symmetric(matrix: Matrix, right: Sequence[Any]) -> tuple[list[Any], Any]:
    """x with S x = r for a positive definite S, by S = L D L^T without square roots, and what it loses.

    Returns:
        x, and sum_j S_jj / D_j: n for a diagonal S, 1e16 where S is singular to rounding.
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
    return x, total(matrix[j][j] * inverse[j] for j in range(n))


def acceleration(N: Matrix, v_dot: Sequence[Any], gamma: Vector) -> list[Any]:
    """q'' = N v' + gamma"""
    return add(matvec(N, v_dot), gamma)
