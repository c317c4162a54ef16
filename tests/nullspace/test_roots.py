"""Square roots of expressions: rows that repeat others only because sqrt(f) sqrt(g) = sqrt(f g)."""

from __future__ import annotations

from typing import Any

import pytest
import sympy as sp

from nullbody.errors import SingularityError
from nullbody.expr import Graph, sqrt
from nullbody.nullspace import null_space
from nullbody.nullspace.rank import sparse_echelon
from nullbody.nullspace.roots import generic_echelon, has_roots
from nullbody.nullspace.steps import sparse_rows

x, y = sp.symbols("x y", positive=True)
R2 = x**2 + y**2
R = sp.sqrt(R2)
TWICE = sp.sqrt(2 * x + 2), sp.sqrt(2) * sp.sqrt(x + 1)  # one number, written in two ways
LATE = sp.sqrt(2 * x - 3), sp.sqrt(2) * sp.sqrt(x - sp.Rational(3, 2))  # real at the second generic point only
EIGHTH = sp.sin(sp.pi / 8), sp.cos(sp.pi / 8)

REPEATED: list[Any] = [
    [[1 / R, x, 1], [R, x * R2, R2]],
    [[R, x, 1], [R2, x * R, R]],
    [[TWICE[0], 1, y], [TWICE[1], 1, y]],
    [[LATE[0], 1, y], [LATE[1], 1, y]],
    [[2 * EIGHTH[0] * EIGHTH[1], 1, x], [sp.sqrt(2) / 2, 1, x]],
]


@pytest.mark.parametrize("rows", REPEATED, ids=["1/r", "r", "twice", "late", "eighth"])
def test_rows_that_repeat_others_by_roots_are_found(rows: Any) -> None:
    space = null_space(sp.Matrix(rows))
    assert (space.rank, space.redundant) == (1, (1,))
    values = sp.Matrix(rows).subs({x: 2.5, y: 0.7}) * space.basis.subs({x: 2.5, y: 0.7})
    assert max(abs(complex(entry)) for entry in values) < 1e-14


@pytest.mark.parametrize("rows", [[[R, x, 1], [R2, x * R, 2 * R]], [[LATE[0], 1, y], [LATE[1], 2, y]]])
def test_rows_that_differ_stay(rows: Any) -> None:
    assert null_space(sp.Matrix(rows)).rank == 2


def test_a_choice_that_roots_make_singular_is_refused() -> None:
    A = sp.Matrix([[*TWICE, 1, 0], [1, 1, 0, y]])
    with pytest.raises(SingularityError, match=r"columns \[2, 3\] cannot .* columns \[1, 2\] would do"):
        null_space(A, [2, 3])
    assert null_space(A, [1, 2]).independent == (1, 2)


def test_the_field_alone_does_not_see_it() -> None:
    u = Graph().symbol("u")
    rows = sparse_rows([[sqrt(u) * sqrt(u + 1), 1 + 0 * u], [sqrt(u * u + u), 1 + 0 * u]])
    assert has_roots(rows)
    assert (sparse_echelon(rows, range(2)).rank, generic_echelon(rows, range(2)).rank) == (2, 1)
