"""The paper's appendix: A = [[1, 2, 0, 1], [5, 8, 1, 3]], exactly."""

from __future__ import annotations

from fractions import Fraction

import sympy

from nullbody.expr import Graph
from nullbody.nullspace import adjugate, null_space, orthogonal_basis

A = ((1, 2, 0, 1), (5, 8, 1, 3))
HALF, THIRD = Fraction(1, 2), Fraction(1, 3)
N = ((-1, 1), (HALF, -1), (1, 0), (0, 1))
SCALED = ((2, -2), (-1, 2), (-2, 0), (0, -2))
ORTHOGONAL = ((-1, THIRD), (HALF, -2 * THIRD), (1, 2 * THIRD), (0, 1))


def test_basis_scaled_basis_and_determinant() -> None:
    space = null_space(A)
    assert space.delta == -2
    assert space.basis == N
    assert space.scaled == SCALED
    assert (space.dependent, space.independent, space.redundant) == ((0, 1), (2, 3), ())
    assert all(isinstance(entry, int | Fraction) for row in space.basis for entry in row)


def test_orthogonal_basis_and_its_gram_matrix() -> None:
    basis = orthogonal_basis(A)
    assert basis == ORTHOGONAL
    columns = list(zip(*basis, strict=True))
    gram = [[sum(a * b for a, b in zip(u, v, strict=True)) for v in columns] for u in columns]
    assert gram == [[Fraction(9, 4), 0], [0, 2]]


def test_the_same_in_sympy_numbers_and_graph_constants() -> None:
    theirs = null_space([[sympy.Integer(e) for e in row] for row in A])
    assert theirs.delta == -2
    assert [list(row) for row in theirs.basis] == [list(row) for row in N]
    graph = Graph()
    ours = null_space([[graph.constant(e) for e in row] for row in A])
    assert ours.delta == -2
    assert all(a == b for row, expected in zip(ours.basis, N, strict=True) for a, b in zip(row, expected, strict=True))


def test_adjugate_of_its_dependent_columns() -> None:
    adj, delta = adjugate([[1, 2], [5, 8]])
    assert (adj, delta) == ([[8, -2], [-5, 1]], -2)
