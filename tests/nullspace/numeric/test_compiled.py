"""Generated kernels for a zero pattern and a chart."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nullbody.errors import InputError, SingularityError
from nullbody.nullspace.numeric import array_null_space, subspace_angle
from tests.nullspace.numeric.exact import exact_angle, exact_basis
from tests.nullspace.numeric.matrices import near_singular, regular_stack

MASK = np.array([[1, 1, 0, 0, 1, 0, 1], [0, 1, 1, 0, 0, 1, 0], [1, 0, 1, 1, 0, 0, 1], [0, 0, 0, 1, 1, 1, 1]], bool)


def patterned(k: int, seed: int = 0) -> Any:
    return regular_stack(k, 4, 7, seed) * MASK


@pytest.mark.parametrize("k", [1, 2, 7, 8, 50])
@pytest.mark.parametrize("form", ["reduced", "orthonormal"])
def test_compiled_agrees_with_exact_arithmetic(k: int, form: Any) -> None:
    A = patterned(k)
    stack: Any = array_null_space(A, form=form, method="compiled")
    for i in range(0, k, 7):
        angle = exact_angle(stack.basis[i], exact_basis(A[i], stack[i].independent))
        assert angle < min(1e-13, stack.subspace_error[i])
    assert stack.method == "compiled"
    assert np.abs(A @ stack.basis).max() < 1e-12


def test_matrices_near_the_singularity_of_the_chart_get_another_one() -> None:
    A = np.stack([near_singular(10.0**-k, seed=1) for k in range(13)] * 3)
    A = np.concatenate([A, regular_stack(60, 5, 7)])
    stack: Any = array_null_space(A, method="compiled")
    reference: Any = array_null_space(A, form="orthonormal", method="qr")
    assert subspace_angle(stack.basis, reference.basis).max() < 1e-13
    fixed: Any = array_null_space(A, (5, 6), method="compiled")
    assert (fixed.independent == [5, 6]).all()
    assert subspace_angle(fixed.basis, reference.basis).max() > 1e-9
    assert (subspace_angle(fixed.basis, reference.basis) <= fixed.subspace_error).all()


def test_inner_pivots_that_happen_to_be_small_are_noticed() -> None:
    """A block of 9 is eliminated in a fixed order: an inner pivot may nearly vanish where |B| does not."""
    mask = np.random.default_rng(0).random((9, 12)) < 0.45
    A = regular_stack(1500, 9, 12) * (mask | np.eye(9, 12, dtype=bool))
    exact: Any = array_null_space(A, form="orthonormal", method="qr").basis
    assert subspace_angle(array_null_space(A, method="compiled").basis, exact).max() < 1e-13
    fixed: Any = array_null_space(A, (9, 10, 11), method="compiled")
    assert (subspace_angle(fixed.basis, exact) <= fixed.subspace_error).all()
    assert np.median(fixed.subspace_error) < 2e-13


def test_function_of_matrices() -> None:
    A = patterned(20)
    f = array_null_space(A[0]).to_function()
    N = f(A)
    assert N.shape == (20, 7, 3)
    np.testing.assert_allclose(f(A[4]), N[4], atol=1e-13 * np.abs(N[4]).max())
    for i in range(20):
        expected = array_null_space(A[i], f.independent, method="complete").basis
        np.testing.assert_allclose(N[i], expected, atol=1e-11 * np.abs(expected).max())
    assert repr(f).startswith(f"<ArrayFunction 4 x 7 -> 7 x 3, independent columns {list(f.independent)}, ")
    assert f(A[0].astype(np.float32)).dtype == np.float32
    assert f(A[:0]).shape == (0, 7, 3)


@pytest.mark.parametrize("scale", [1e-200, 1e-100, 1e100, 1e200])
def test_function_of_huge_and_tiny_matrices(scale: float) -> None:
    A = patterned(9)
    f = array_null_space(A[0]).to_function()
    np.testing.assert_allclose(f(scale * A), f(A), rtol=1e-10, atol=1e-10)


def test_kept_constants_take_fewer_operations_and_are_checked() -> None:
    A = np.array([[1.0, 0, -0.7, 0.5], [0, -1.0, 0.3, 2.0]])
    space: Any = array_null_space(A, (2, 3))
    f, g = space.to_function(keep_constants=True), space.to_function()
    assert f.operations.arithmetic < g.operations.arithmetic
    np.testing.assert_allclose(f(A), space.basis, rtol=1e-15)
    B = A.copy()
    B[1, 1] = 3
    np.testing.assert_allclose(g(B), array_null_space(B, (2, 3)).basis)
    with pytest.raises(InputError, match=r"A\[1, 1\] = -1; matrix 0 has 3"):
        f(B)


def test_entries_outside_the_pattern_are_refused() -> None:
    A = patterned(5)
    f = array_null_space(A[0]).to_function()
    A[3, 0, 2] = 1e-9
    with pytest.raises(InputError, match=r"A\[0, 2\] = 0; matrix 3 has 1e-09"):
        f(A)
    A[3, 0, 2], A[3, 0, 1] = 0, 0  # a zero inside the pattern is welcome
    assert np.abs(A[3] @ f(A)[3]).max() < 1e-12


def test_redundant_rows_must_stay_redundant() -> None:
    A = patterned(4)
    A = np.concatenate([A, A[:, :1] + A[:, 1:2]], axis=1)
    f = array_null_space(A[0]).to_function()
    assert np.abs(A @ f(A)).max() < 1e-12
    A[2, 4, 0] += 1e-3
    with pytest.raises(InputError, match="rank 5"):
        f(A)


def test_singular_and_bad_matrices_are_named() -> None:
    A = np.stack([near_singular(1, seed=i) for i in range(5)])
    f = array_null_space(A[0], (5, 6)).to_function()
    A[3] = near_singular(0, seed=7)
    with pytest.raises(SingularityError, match=r"of matrix 3 of the stack.*would do"):
        f(A)
    with pytest.raises(SingularityError, match=r"of A: .*would do"):
        f(A[3])
    A[3, 1, 1] = np.nan
    with pytest.raises(InputError, match="matrix 3, row 1, column 1 holds nan"):
        f(A)
    for bad in (A[:, :4], A[0] * 1j, "x", None):
        with pytest.raises(InputError, match="must be real, of shape"):
            f(bad)


@pytest.mark.parametrize("kind", [complex, np.complex64])
def test_complex_matrices_have_no_kernel(kind: Any) -> None:
    A = patterned(2).astype(kind)
    with pytest.raises(InputError, match="real"):
        array_null_space(A, method="compiled")
    with pytest.raises(InputError, match="real"):
        array_null_space(A[0]).to_function()


def test_without_constraints() -> None:
    f = array_null_space(np.zeros((2, 3))).to_function()
    assert f(np.zeros((2, 3))).tolist() == np.eye(3).tolist()
    assert f(np.zeros((4, 2, 3))).shape == (4, 3, 3)
    assert f(np.zeros((4, 2, 3))).any()
