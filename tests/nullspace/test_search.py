"""The search for fewer operations: the same null space, fewer operations, the same result every time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nullbody.bench.matrix import Matrix, three_prs_generic, three_prs_trigonometric
from nullbody.errors import SingularityError
from nullbody.expr import Exact, Expr, Graph, Operations, Tape, operations
from nullbody.nullspace import null_space
from nullbody.nullspace.result import FORMS

FUNCTIONS = {"sin": np.sin, "cos": np.cos, "sqrt": np.sqrt}


def values(matrix: Matrix, entries: Any, points: Any) -> Any:
    """Entries, nested lists of expressions and numbers, at points: count x ..."""
    flat = np.asarray(entries, dtype=object)
    graph = matrix.rows[0][0].graph
    tape = Tape.of([entry if isinstance(entry, Expr) else graph.constant(entry) for entry in flat.flat], matrix.inputs)
    found = [np.broadcast_to(np.asarray(x, dtype=float), len(points)) for x in tape.run(list(points.T), FUNCTIONS)]
    return np.stack(found, axis=-1).reshape(len(points), *flat.shape)


def arithmetic(matrix: Matrix, form: str, method: str, search: int) -> int:
    found: Operations = null_space(matrix.rows, matrix.independent, form, method, search=search).operations
    return found.arithmetic


@pytest.mark.parametrize(("form", "count"), [("reduced", 194), ("scaled", 230)])
def test_the_robot_by_elimination(form: str, count: int) -> None:
    assert arithmetic(three_prs_trigonometric(), form, "elimination", 20) == count


@pytest.mark.parametrize(("form", "count"), [("reduced", 223), ("scaled", 261)])
def test_the_robot_with_symbols_for_its_entries(form: str, count: int) -> None:
    assert arithmetic(three_prs_generic(), form, "elimination", 20) == count


@pytest.mark.parametrize("form", FORMS)
def test_every_form_has_the_same_values_in_fewer_operations(form: str) -> None:
    one, two = three_prs_trigonometric(), three_prs_trigonometric()
    points = one.sample(np.random.default_rng(3), 20)
    plain = null_space(one.rows, one.independent, form)
    found = null_space(two.rows, two.independent, form, search=3)
    assert found.operations.arithmetic < plain.operations.arithmetic
    basis = values(two, found.basis, points)
    assert basis == pytest.approx(values(one, plain.basis, points), rel=1e-9, abs=1e-12)
    assert abs(two.numbers(points) @ basis).max() < 1e-14 * abs(basis).max()


def test_more_trials_never_take_more_operations_and_the_same_number_takes_the_same() -> None:
    found = [null_space(m.rows, m.independent, search=k) for k in (0, 2, 5, 5) for m in [three_prs_generic()]]
    counts = [space.operations.arithmetic for space in found]
    assert counts == sorted(counts, reverse=True)
    assert found[2].latex() == found[3].latex()


def test_everything_else_fits_the_basis_that_was_found() -> None:
    matrix = three_prs_trigonometric()
    space = null_space(matrix.rows, matrix.independent, "scaled", "elimination", search=3)
    assert space.basis[matrix.independent[0]][0] == space.delta
    for scaled, reduced in zip(space.scaled, space.reduced, strict=True):
        assert [entry - space.delta * other for entry, other in zip(scaled, reduced, strict=True)] == [0, 0, 0]
    right = [row[0] for row in matrix.rows]
    offset = space.offset(right)
    for row, c in zip(matrix.rows, right, strict=True):
        assert sum((a * g for a, g in zip(row, offset, strict=True)), start=c) == 0
    together = [entry for row in (*space.scaled, offset) for entry in row if isinstance(entry, Expr)]
    assert operations(together).arithmetic < 2 * space.operations.arithmetic  # the factors are shared


def test_the_basis_stands_in_the_graph_of_the_matrix_without_older_forms() -> None:
    graph = Graph()
    x, y, z = (graph.symbol(name) for name in "xyz")
    space = null_space([[1, x * y, x * z], [0, 1, x * y + x]], search=1)  # N_0 = x y (x y + x) - x z
    assert space.basis[0][0].graph is graph
    assert space.basis[0][0] == x * (y * x * (y + 1) - z)
    assert (space.operations.add, space.operations.mul) == (2, 3)


def test_plain_numbers_have_nothing_to_search() -> None:
    assert null_space([[1, 2, 3]], search=5).basis == null_space([[1, 2, 3]]).basis
    surds = [[Exact.square_root(2), Exact.of(1)]]
    assert null_space(surds, search=2).basis == null_space(surds).basis


def test_sympy_matrices_are_searched_too() -> None:
    import sympy

    a, b, c = sympy.symbols("a b c")
    A = sympy.Matrix([[a, b, a * b, c], [b, a, a * c, 1]])
    for form in ("reduced", "scaled", "orthogonal"):
        space = null_space(A, form=form, search=4)
        assert (A * space.basis).applyfunc(sympy.simplify) == sympy.zeros(2, 2)
        assert space.operations.arithmetic <= null_space(A, form=form).operations.arithmetic


def test_singular_columns_are_named_before_anything_is_searched() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    with pytest.raises(SingularityError, match="would do"):
        null_space([[x, x, y], [y, y, 1]], independent=[2], search=3)
