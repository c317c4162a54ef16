"""Stacks give what single calls give."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nullbody.errors import InputError, SingularityError
from nullbody.nullspace.numeric import ArrayNullSpace, NullSpaceStack, array_null_space
from tests.nullspace.numeric.matrices import METHODS, near_singular, regular_stack


def defective_stack(kind: Any = float) -> Any:
    A = regular_stack(7, 4, 6).astype(kind)
    if np.iscomplexobj(A):
        A += 1j * regular_stack(7, 4, 6, seed=1)
    A[:, 2] = A[:, 0] * 2 - A[:, 3]
    return A


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("form", ["reduced", "scaled", "orthogonal", "orthonormal"])
@pytest.mark.parametrize("chart", [None, (5, 0, 1)])
@pytest.mark.parametrize("kind", [float, np.float32, complex])
def test_stack_equals_single_results(method: str, form: Any, chart: Any, kind: Any) -> None:
    A = defective_stack(kind)
    stack: Any = array_null_space(A, chart, form, method)
    assert isinstance(stack, NullSpaceStack)
    eps = float(np.finfo(A.dtype).eps)
    for i, space in enumerate(stack):
        alone: Any = array_null_space(A[i], chart, form, method)
        assert isinstance(space, ArrayNullSpace)
        assert (space.independent, space.rows) == (alone.independent, alone.rows)
        assert tuple(stack.dependent[i]) == alone.dependent
        assert tuple(stack.redundant[i]) == alone.redundant
        assert np.abs(stack.basis[i] - alone.basis).max() <= 100 * eps * np.abs(alone.basis).max()
        assert stack.delta[i] == pytest.approx(alone.delta, rel=100 * eps)
        assert stack.condition[i] == pytest.approx(alone.condition)
        assert stack.subspace_error[i] == pytest.approx(alone.subspace_error)
        assert space.basis == pytest.approx(stack.basis[i])


def test_parts() -> None:
    stack: Any = array_null_space(defective_stack())
    assert len(stack) == 7
    assert len(stack[2:5]) == 3
    assert (stack[2:5].basis == stack.basis[2:5]).all()
    assert (stack[-1].basis == stack.basis[6]).all()
    assert (stack[2:5][1].delta) == stack.delta[3]
    with pytest.raises(IndexError):
        stack[7]
    assert repr(stack).startswith("<NullSpaceStack 7 x reduced 6 x 3, rank 3, by complete, worst condition")
    assert "largest subspace error" in repr(array_null_space(stack.matrices, form="orthonormal"))


def test_offsets_of_a_stack() -> None:
    A = defective_stack()
    stack: Any = array_null_space(A)
    c = A @ np.arange(6.0)
    gamma = stack.offset(c)
    np.testing.assert_allclose((A @ gamma[:, :, None])[:, :, 0], -c, atol=1e-12)
    assert gamma.shape == (7, 6)
    c[4, 2] += 1
    with pytest.raises(InputError, match="of matrix 4 of the stack repeats"):
        stack.offset(c)
    common = array_null_space(regular_stack(3, 2, 4))
    assert np.asarray(common.offset([1.0, 2.0])).shape == (3, 4)
    with pytest.raises(InputError, match=r"shape \(2,\) or \(3, 2\)"):
        common.offset([1.0, 2.0, 3.0])


@pytest.mark.parametrize("method", [*METHODS, "compiled"])
def test_different_ranks_are_named(method: str) -> None:
    A = regular_stack(5, 3, 5)
    A[3, 1] = A[3, 0]
    with pytest.raises(InputError, match=r"must have one rank: .*matrix 3 .*rank 2"):
        array_null_space(A, method=method)


@pytest.mark.parametrize("method", [*METHODS, "compiled"])
def test_the_singular_matrix_is_named(method: str) -> None:
    A = np.stack([near_singular(1, seed=i) for i in range(4)])
    A[2] = near_singular(0, seed=9)
    with pytest.raises(SingularityError, match="of matrix 2 of the stack"):
        array_null_space(A, (5, 6), method=method)


@pytest.mark.parametrize(("chart", "d"), [(None, 2), ((1, 3), 2), ((1, 3, 4), 3)])
def test_empty_stacks(chart: Any, d: int) -> None:
    stack: Any = array_null_space(np.zeros((0, 3, 5), np.float32), chart)
    assert (len(stack), stack.shape, stack.basis.shape, stack.basis.dtype) == (0, (5, d), (0, 5, d), np.float32)
    assert stack.delta.shape == stack.condition.shape == stack.subspace_error.shape == (0,)
    assert stack.independent.shape == (0, d)
    assert stack.in_form("orthonormal").shape == stack.in_form("scaled").shape == (0, 5, d)
    assert "0 x reduced" in repr(stack)
    assert stack.offset(np.zeros((0, 3))).shape == (0, 5)


@pytest.mark.parametrize(("shape", "chart"), [((0, 3, 3), None), ((0, 4, 3), None), ((0, 1, 3), (0,))])
def test_empty_stacks_without_an_answer(shape: tuple[int, ...], chart: Any) -> None:
    with pytest.raises(InputError, match="shows no rank"):
        array_null_space(np.zeros(shape), chart)


def test_long_stacks_are_worked_on_in_parts() -> None:
    A = regular_stack(2500, 2, 4)
    stack: Any = array_null_space(A)
    assert np.abs(A @ stack.basis).max() < 1e-13
    assert (array_null_space(A[2400]).basis == stack.basis[2400]).all()
