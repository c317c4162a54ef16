"""Every method, form and type against elimination of Fractions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nullbody.errors import InputError
from nullbody.nullspace.numeric import ArrayNullSpace, array_null_space
from tests.nullspace.numeric.exact import exact_angle, exact_basis, exact_rank
from tests.nullspace.numeric.matrices import METHODS, defective

FORMS = ("reduced", "scaled", "orthogonal", "orthonormal")


def space_of(A: Any, *arguments: Any, **options: Any) -> ArrayNullSpace:
    space = array_null_space(A, *arguments, **options)
    assert isinstance(space, ArrayNullSpace)
    return space


@pytest.mark.parametrize("method", METHODS)
@given(A=defective())
def test_reduced_basis_rank_and_delta(method: str, A: Any) -> None:
    space = space_of(A, method=method)
    N = np.array(exact_basis(A, space.independent), float)
    np.testing.assert_allclose(space.basis, N, atol=1e-12 * np.abs(N).max())
    assert (space.basis[list(space.independent)] == np.eye(space.shape[1])).all()
    assert space.rank == exact_rank(A)
    B = A[list(space.rows)][:, list(space.dependent)]
    assert space.delta == pytest.approx(round(np.linalg.det(B)), rel=1e-12)
    assert space.delta != 0


@pytest.mark.parametrize("method", METHODS)
@given(A=defective())
def test_other_forms_follow_from_the_reduced_one(method: str, A: Any) -> None:
    space = space_of(A, method=method)
    N, d = space.reduced, space.shape[1]
    np.testing.assert_allclose(space.scaled, space.delta * N, rtol=1e-14)
    T = space.orthogonal[list(space.independent)]
    np.testing.assert_allclose(space.orthogonal, N @ T, atol=1e-12 * np.abs(N).max() ** 2)
    np.testing.assert_allclose(T, np.triu(T, 1) + np.eye(d), atol=1e-12)
    lengths = np.linalg.norm(space.orthogonal, axis=0)
    np.testing.assert_allclose(space.orthonormal * lengths, space.orthogonal, atol=1e-13 * lengths.max())
    np.testing.assert_allclose(space.orthonormal.T @ space.orthonormal, np.eye(d), atol=1e-14)


@given(A=defective(), random=st.randoms(use_true_random=False))
def test_methods_agree_in_any_chart(A: Any, random: Any) -> None:
    first = space_of(A)
    chart = random.sample(range(A.shape[1]), first.shape[1])
    dependent = [j for j in range(A.shape[1]) if j not in chart]
    if exact_rank(A[:, dependent]) < len(dependent):
        return
    for form in FORMS:
        expected = space_of(A, chart, form, "complete")
        assert expected.independent == tuple(chart)
        for method in ("auto", "lu", "qr", "svd", "minors"):
            basis = space_of(A, chart, form, method).basis
            if form == "scaled":  # redundant rows may be chosen otherwise, and |B| with them
                basis, reference = basis / basis[chart[0], 0], expected.reduced
            else:
                reference = expected.basis
            np.testing.assert_allclose(basis, reference, atol=1e-11 * np.abs(reference).max())


def test_methods_agree_for_complex_numbers() -> None:
    generator = np.random.default_rng(2)
    A = generator.normal(size=(3, 6)) + 1j * generator.normal(size=(3, 6))
    A = np.vstack([A, 1j * A[0] - A[2]])
    for form in ("reduced", "orthogonal", "orthonormal"):
        bases = [space_of(A, (4, 0, 3), form, method).basis for method in METHODS]
        assert np.abs(A @ bases[0]).max() < 1e-13
        for basis in bases[1:]:
            np.testing.assert_allclose(basis, bases[0], atol=1e-13)
    (repeated,) = space_of(A, method="qr").repeats.items()
    np.testing.assert_allclose(sum(x * A[k] for k, x in repeated[1].items()), A[repeated[0]], atol=1e-14)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    ("kind", "result"),
    [
        (np.float32, np.float32),
        (np.float64, np.float64),
        (np.complex64, np.complex64),
        (np.complex128, np.complex128),
        (np.int8, np.float64),
        (np.uint64, np.float64),
        (np.float16, np.float32),
    ],
)
def test_types(method: str, form: Any, kind: Any, result: Any) -> None:
    A = np.array([[1, 2, 0, 1, 5], [3, 0, 1, 1, 2], [4, 2, 1, 2, 7]]).astype(kind)
    if np.dtype(kind).kind == "c":
        A = A * np.array([1 + 2j, 1, 1j, 3, 1 - 1j], kind)
    space = space_of(A, form=form, method=method)
    eps = np.finfo(result).eps
    assert space.basis.dtype == space.delta.dtype == space.offset(A[:, 0]).dtype == result
    assert space.rank == 2
    assert np.abs(A @ space.basis).max() < 100 * eps * np.abs(space.basis).max()
    if form == "orthonormal":
        assert np.abs(space.basis.conj().T @ space.basis - np.eye(3)).max() < 10 * eps
    assert space.subspace_error < 100 * eps


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("A", "rank"),
    [
        (np.zeros((0, 3)), 0),
        (np.zeros((2, 3)), 0),
        (np.array([[0.0, 3.0, 0.0]]), 1),
        (np.array([[2.0, 0.0], [1.0, 0.0], [0.0, 0.0]]), 1),
        (np.outer([1.0, 2, 3, 4, 5], [1.0, 1, 2]), 1),
        (np.zeros((1, 1)), 0),
    ],
)
def test_shapes(method: str, A: Any, rank: int) -> None:
    space = space_of(A, method=method)
    assert (space.rank, space.shape) == (rank, (A.shape[1], A.shape[1] - rank))
    assert len(space.rows) + len(space.redundant) == len(A)
    assert np.abs(A @ space.basis).max(initial=0) < 1e-14
    if rank == 0:
        assert (space.basis == np.eye(A.shape[1])).all()
        assert (space.delta, space.condition, space.subspace_error) == (1, 1, 0)
    assert space.orthonormal.T @ space.orthonormal == pytest.approx(np.eye(space.shape[1]))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("A", [np.eye(3), np.array([[1.0, 2], [3, 4], [5, 6]]), np.ones((1, 1))])
@pytest.mark.parametrize("chart", [None, ()])
def test_full_column_rank_is_refused(method: str, A: Any, chart: Any) -> None:
    with pytest.raises(InputError, match=f"only 0 is in the null space: A has rank {A.shape[1]}|rank at most"):
        array_null_space(A, chart, method=method)


@pytest.mark.parametrize("method", ["complete", "qr", "svd"])
@pytest.mark.parametrize("seed", range(5))
def test_error_stays_below_its_estimate(method: str, seed: int) -> None:
    generator = np.random.default_rng(seed)
    A = generator.normal(size=(6, 9)) * 10.0 ** generator.integers(-6, 7, size=(6, 1))
    for form in ("reduced", "orthonormal"):
        space = space_of(A, form=form, method=method)
        angle = exact_angle(space.basis, exact_basis(A, space.independent))
        assert angle < min(space.subspace_error, 5e-15)
        assert space.subspace_error < 5e-14


def test_what_it_says() -> None:
    space = space_of(np.array([[1.0, 2, 4], [2, 4, 8]]), (1, 2))
    assert repr(space) == (
        "<NullSpace reduced 3 x 2, rank 1, independent columns [1, 2], redundant rows [1], by lu, condition 4.58>"
    )
    near = np.array([[1.0, 1, 2, 3], [1, 1 + 1e-9, 3, 5]])
    assert "condition" in repr(space_of(near, (2, 3), method="qr"))
    assert repr(space_of(near, (2, 3), form="orthonormal", method="qr")).endswith("by qr, subspace error 1e-14>")
    assert space.latex() == r"\begin{bmatrix} -2 & -4 \\ 1 & 0 \\ 0 & 1 \end{bmatrix}"
    assert np.array(space.to_sympy().tolist(), float).tolist() == [[-2, -4], [1, 0], [0, 1]]
    assert space.operations is None
    tiny = space_of(np.array([[1 + 1j, 3e-9j]]), (1,))
    assert "1.5 \\cdot 10^{-9} - 1.5 \\cdot 10^{-9} \\mathrm{i}" in tiny.latex().replace("-1.5", "1.5")
    with pytest.raises(ValueError, match="read-only"):
        space.basis[0, 0] = 1
