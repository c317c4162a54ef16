"""Derivatives of bases: identically on the graph, exactly in fractions, to second order by differences."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from nullbody.errors import InputError, SingularityError
from nullbody.expr import Expr, Graph, Tape, cos, directional, sin
from nullbody.expr.matrix import matmul
from nullbody.nullspace import null_space
from nullbody.nullspace.derivative import (
    basis_rate,
    delta_rate,
    gram_schmidt_rate,
    orthogonal_rate,
    orthonormal_rate,
    scaled_rate,
)
from nullbody.nullspace.gram import orthogonal

Rows = Sequence[Sequence[Any]]
FREE = (4, 5, 6)


def arrays(seed: int = 0, shape: tuple[int, ...] = (4, 7)) -> tuple[np.ndarray, np.ndarray]:
    A, A_dot = np.random.default_rng(seed).normal(size=(2, *shape))
    return A, A_dot


def order(function: Callable[[float], Any], derivative: Any, h: float = 4e-3) -> float:
    """The order with which central differences converge to the derivative: 2 where it is right."""
    errors = [np.abs((function(s) - function(-s)) / (2 * s) - derivative).max() for s in (h, h / 2)]
    return float(np.log2(errors[0] / errors[1]))


def moving() -> tuple[Any, list[list[Any]], list[list[Any]]]:
    """A(t) with a row that repeats others, and A'(t), expressions of one graph."""
    graph = Graph()
    t, a, b = (graph.symbol(name) for name in ("t", "a", "b"))
    A = [[t, a, sin(t), 1, b], [1, t * t, cos(t), a * t, 0]]
    A.insert(1, [t * x + y for x, y in zip(*A, strict=True)])
    rows = [[graph.constant(e) if isinstance(e, int) else e for e in row] for row in A]
    return t, rows, along(rows, t)


def along(rows: Rows, t: Any) -> list[list[Any]]:
    return [directional([t * 0 + e for e in row], {t: t.graph.constant(1)}) for row in rows]


def same(left: Rows, right: Rows) -> bool:
    return all(a == b for one, other in zip(left, right, strict=True) for a, b in zip(one, other, strict=True))


def test_rates_of_expressions_are_their_derivatives_identically() -> None:
    t, A, A_dot = moving()
    space = null_space(A, [2, 3, 4])
    assert space.redundant == (2,)
    assert same(basis_rate(space, A_dot), along(space.reduced, t))
    assert same(scaled_rate(space, A_dot), along(space.scaled, t))
    assert delta_rate(space, A_dot) == along([[space.delta]], t)[0][0]
    assert same(orthogonal_rate(space.reduced, basis_rate(space, A_dot)), along(orthogonal(space.reduced), t))
    t.graph.verify()


def test_the_orthonormal_basis_of_expressions_at_a_point() -> None:
    t, A, A_dot = moving()
    space, names, point = null_space(A, [2, 3, 4]), ("t", "a", "b"), (0.7, 1.3, -0.4)

    def numbers(rows: Rows) -> np.ndarray:
        flat = [t * 0 + entry for row in rows for entry in row]
        return np.array(Tape.of(flat, names).run(point)).reshape(len(rows), -1)

    found = gram_schmidt_rate(numbers(space.reduced), numbers(basis_rate(space, A_dot)))
    np.testing.assert_allclose(found, numbers(along(space.orthonormal, t)), rtol=1e-11, atol=1e-13)


@st.composite
def motions(draw: st.DrawFn) -> tuple[list[list[int]], list[list[int]]]:
    n, m = draw(st.integers(2, 6)), draw(st.integers(1, 4))
    matrices = st.lists(st.lists(st.integers(-5, 5), min_size=n, max_size=n), min_size=m, max_size=m)
    return draw(matrices), draw(matrices)


@given(motions())
def test_rates_of_exact_numbers(motion: tuple[list[list[int]], list[list[int]]]) -> None:
    """A N' = -A' N, N' is zero in the independent places, and delta' is the derivative of a polynomial."""
    A, A_dot = motion
    assume(np.linalg.matrix_rank(A) == len(A) < len(A[0]))
    space = null_space(A)
    rate = basis_rate(space, A_dot)
    assert matmul(A, rate) == [[-e for e in row] for row in matmul(A_dot, space.reduced)]
    assert not any(entry for j in space.independent for entry in rate[j])
    lifted = scaled_rate(space, A_dot)
    slope = delta_rate(space, A_dot)
    for row, N, N_dot in zip(lifted, space.reduced, rate, strict=True):
        assert list(row) == [slope * x + space.delta * y for x, y in zip(N, N_dot, strict=True)]
    assert all(isinstance(entry, int | Fraction) for row in lifted for entry in row)


@given(motions())
def test_orthogonal_rate_of_exact_numbers(motion: tuple[list[list[int]], list[list[int]]]) -> None:
    """d/dt (N^^T N^) stays diagonal, and N^' - N' T lies in N^ times a strictly upper triangle."""
    A, A_dot = motion
    assume(np.linalg.matrix_rank(A) == len(A) < len(A[0]))
    space = null_space(A)
    basis, rate = space.orthogonal, orthogonal_rate(space.reduced, basis_rate(space, A_dot))
    mixed = matmul(list(zip(*basis, strict=True)), rate)
    d = len(mixed)
    assert all(mixed[i][j] + mixed[j][i] == 0 for i in range(d) for j in range(i))
    assert matmul(A, rate) == [[-e for e in row] for row in matmul(A_dot, basis)]
    corner = [rate[j] for j in space.independent]
    assert all(corner[i][j] == 0 for i in range(d) for j in range(i + 1))


@pytest.mark.parametrize(
    ("form", "rate"),
    [
        ("reduced", basis_rate),
        ("scaled", scaled_rate),
        ("orthogonal", lambda space, A_dot: orthogonal_rate(space.reduced, basis_rate(space, A_dot))),
        ("orthonormal", lambda space, A_dot: gram_schmidt_rate(space.reduced, basis_rate(space, A_dot))),
    ],
)
def test_differences_converge_to_second_order(form: Any, rate: Callable[[Any, Any], Any]) -> None:
    A, A_dot = arrays()
    derivative = np.array(rate(null_space(A, FREE), A_dot))
    assert order(lambda t: null_space(A + t * A_dot, FREE, form).basis, derivative) == pytest.approx(2, abs=0.05)


def test_the_form_of_the_space_does_not_matter() -> None:
    A, A_dot = arrays(1)
    for rate in (basis_rate, scaled_rate, delta_rate):
        expected = rate(null_space(A, FREE), A_dot)
        for form in ("scaled", "orthogonal", "orthonormal"):
            np.testing.assert_allclose(rate(null_space(A, FREE, form), A_dot), expected, rtol=1e-9, atol=1e-11)


def test_delta_rate_by_differences_with_redundant_rows() -> None:
    A, A_dot = arrays(2)
    mix, mix_dot = arrays(3, (5, 4))
    product, product_dot = mix @ A, mix_dot @ A + mix @ A_dot

    def delta(t: float) -> float:
        return float(np.linalg.det(((mix + t * mix_dot) @ (A + t * A_dot))[np.ix_(space.rows, space.dependent)]))

    space = null_space(product, FREE)
    assert len(space.redundant) == 1
    assert order(delta, delta_rate(space, product_dot)) == pytest.approx(2, abs=0.05)


def test_stacks_are_done_one_by_one() -> None:
    A, A_dot = arrays(4, (3, 4, 7))
    stack = null_space(A, FREE)
    for rate in (basis_rate, scaled_rate, delta_rate):
        expected = np.array([rate(null_space(*pair), dot) for *pair, dot in zip(A, [FREE] * 3, A_dot, strict=True)])
        np.testing.assert_allclose(rate(stack, A_dot), expected, rtol=1e-9, atol=1e-11)
    with pytest.raises(InputError, match="a stack of 3 matrices, not of shape"):
        basis_rate(stack, A_dot[:2])


def test_gamma_is_the_rate_of_n_times_v() -> None:
    A, A_dot = arrays(5)
    space, v = null_space(A, FREE), np.array([0.3, -1.0, 0.7])
    np.testing.assert_allclose(basis_rate(space, A_dot) @ v, space.offset(A_dot @ (space.reduced @ v)), atol=1e-12)


def test_the_papers_rate_is_another_matrix_by_a_part_of_the_null_space() -> None:
    """[41]: -A^+ A' N has the same A-product; the difference is N times its rows in the independent places."""
    A, A_dot = arrays(6)
    space = null_space(A, FREE)
    N, right = space.reduced, basis_rate(space, A_dot)
    papers = -np.linalg.pinv(A) @ A_dot @ N
    np.testing.assert_allclose(A @ papers, A @ right, atol=1e-12)
    rows = papers[list(FREE)]
    assert np.abs(rows).min() > 0.01  # no entry of it is zero
    np.testing.assert_allclose(papers - right, N @ rows, atol=1e-12)
    assert abs(order(lambda t: null_space(A + t * A_dot, FREE).basis, papers)) < 0.1  # differences miss it


def test_the_stillest_orthonormal_basis() -> None:
    """It is the derivative of the orthonormal basis at t that is nearest to Z, and has no part along Z."""
    A, A_dot = arrays(7)
    Z = null_space(A, FREE, "orthonormal").basis
    rate = orthonormal_rate(A, A_dot, Z)
    np.testing.assert_allclose(A @ rate, -A_dot @ Z, atol=1e-12)
    np.testing.assert_allclose(Z.T @ rate, 0, atol=1e-12)

    def closest(t: float) -> Any:
        """Any orthonormal basis at t, turned by the polar factor of its product with Z."""
        there = null_space(A + t * A_dot, FREE, "orthonormal").basis
        left, _, right = np.linalg.svd(there.T @ Z)
        return there @ (left @ right)

    assert order(closest, rate) == pytest.approx(2, abs=0.05)


def test_both_orthonormal_rates_turn_the_same_subspace() -> None:
    A, A_dot = arrays(8)
    space = null_space(A, FREE)
    Z = null_space(A, FREE, "orthonormal").basis
    still, tied = orthonormal_rate(A, A_dot, Z), gram_schmidt_rate(space.reduced, basis_rate(space, A_dot))
    spin = Z.T @ tied
    np.testing.assert_allclose(spin, -spin.T, atol=1e-12)
    np.testing.assert_allclose(tied - still, Z @ spin, atol=1e-12)
    assert np.linalg.norm(still) < np.linalg.norm(tied)
    np.testing.assert_allclose(still, orthonormal_rate(np.vstack([A, A[:1]]), np.vstack([A_dot, A_dot[:1]]), Z))


def test_complex_bases_and_stacks() -> None:
    N, N_dot = arrays(9, (2, 6, 3))
    N, N_dot = N + 1j * arrays(10, (2, 6, 3))[0], N_dot + 1j * arrays(10, (2, 6, 3))[1]

    def factor(t: float) -> Any:
        there = N + t * N_dot
        R = np.linalg.cholesky(there.conj().swapaxes(1, 2) @ there).conj().swapaxes(1, 2)
        return there @ np.linalg.inv(R)

    assert order(factor, gram_schmidt_rate(N, N_dot)) == pytest.approx(2, abs=0.05)
    A, A_dot = (matrix.conj().swapaxes(1, 2)[:, :2] for matrix in (N, N_dot))
    Z = np.linalg.svd(A)[2][:, 2:].conj().swapaxes(1, 2)
    rate = orthonormal_rate(A, A_dot, Z)
    np.testing.assert_allclose(A @ rate, -A_dot @ Z, atol=1e-12)
    np.testing.assert_allclose(Z.conj().swapaxes(1, 2) @ rate, 0, atol=1e-12)


def test_nothing_moves_without_constraints() -> None:
    A = np.zeros((2, 3))
    assert not orthonormal_rate(A, A, np.eye(3)).any()
    assert not np.any(basis_rate(null_space(A), A))


@pytest.mark.parametrize(
    ("A_dot", "message"),
    [
        (np.ones((2, 3)), "shape of A, 1 x 3, not 2 x 3"),
        (np.ones(3), "shape of A, 1 x 3"),
        ([[1.0, 2.0, 3.0, 4.0]], "shape of A, 1 x 3, not 1 x 4"),
        ([[1.0, float("nan"), 0.0]], "must be finite"),
    ],
)
def test_wrong_rates_of_a(A_dot: Any, message: str) -> None:
    for A in ([[1.0, 2.0, 3.0]], [[1, 2, 3]]):
        for rate in (basis_rate, delta_rate, scaled_rate):
            with pytest.raises(InputError, match=message):
                rate(null_space(A), A_dot)


def test_wrong_bases() -> None:
    N = np.eye(4, 2)
    with pytest.raises(InputError, match=r"must be \(n, d\) or stacks"):
        gram_schmidt_rate(N, np.eye(4, 3))
    with pytest.raises(InputError, match="columns of N are dependent"):
        gram_schmidt_rate(np.ones((4, 2)), N)
    with pytest.raises(InputError, match="3 columns of length 2"):
        gram_schmidt_rate(np.eye(2, 3), np.eye(2, 3))
    with pytest.raises(InputError, match="N_dot must be finite"):
        gram_schmidt_rate(N, np.full((4, 2), np.inf))
    with pytest.raises(InputError, match="must have one shape"):
        orthogonal_rate([[1, 0], [0, 1]], [[1], [0]])
    with pytest.raises(InputError, match="column 1 of the basis is a combination"):
        orthogonal_rate([[1, 2], [2, 4]], [[1, 0], [0, 1]])


def test_wrong_orthonormal_bases_and_ranks_that_drop() -> None:
    A = np.eye(2, 4)
    Z = np.eye(4)[:, 2:]
    with pytest.raises(InputError, match=r"no orthonormal basis of A's null space: .A Z. / .A. = 1"):
        orthonormal_rate(A, A, np.eye(4)[:, 1:3])
    with pytest.raises(InputError, match=r".Z\^H Z - I. = 4"):
        orthonormal_rate(A, A, 2 * Z)
    with pytest.raises(InputError, match=r"must be \(m, n\), \(m, n\), \(n, d\)"):
        orthonormal_rate(A, A, Z[:3])
    with pytest.raises(InputError, match="too few columns"):
        orthonormal_rate(A, A, Z[:, :1])
    with pytest.raises(SingularityError, match="rank below 2 here: its null space has more than Z's 2 columns"):
        orthonormal_rate(np.diag([1.0, 0.0]) @ A, A, Z)


def test_rates_of_the_robot_are_those_of_its_gamma(three_prs_jacobian: list[list[Any]]) -> None:
    A = three_prs_jacobian
    graph = A[0][0].graph
    names = ("x", "y", "z", "psi", "theta", "phi", "alpha1", "alpha2", "alpha3", "s1", "s2", "s3")
    q = [graph.symbol(name) for name in names]
    seeds = {x: graph.symbol(f"{name}_dot") for name, x in zip(names, q, strict=True)}
    A_dot = [directional([graph.constant(0) + entry for entry in row], seeds) for row in A]
    space = null_space(A, [9, 10, 11])
    expected = [
        directional([e if isinstance(e, Expr) else graph.constant(e) for e in row], seeds) for row in space.reduced
    ]
    assert same(basis_rate(space, A_dot), expected)
