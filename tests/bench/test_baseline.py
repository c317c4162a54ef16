"""Every baseline gives A N = 0 and the right subspace, and has the property for which it is known."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody.bench import baseline
from nullbody.bench.baseline import BASELINES, KimVanderploeg
from nullbody.bench.exact import exact_null_space, orthogonality, residual, subspace_error
from nullbody.bench.matrix import random_banded, random_sparse, three_prs_trigonometric
from nullbody.bench.robot import state

ROBOT = three_prs_trigonometric()


def path(t: float) -> np.ndarray:
    """A of the robot along a motion of its platform."""
    return ROBOT.numbers(state(0.4 + 0.02 * np.sin(t), 0.1 * np.sin(2 * t), 0.1 * t)[None])[0]


def matrices() -> list[np.ndarray]:
    random = np.random.default_rng(1)
    return [random.normal(size=(9, 12)), random.normal(size=(4, 5)), path(0.3), random_sparse(15, 20).samples(1)[0]]


@pytest.mark.parametrize("name", BASELINES)
@pytest.mark.parametrize("number", range(4))
def test_baseline_spans_the_null_space(name: str, number: int) -> None:
    A = matrices()[number]
    N = BASELINES[name].begin()(A)
    assert N.shape == (A.shape[1], A.shape[1] - A.shape[0])
    assert residual(A, N) < 1e-13
    assert subspace_error(N, exact_null_space(A)) < 1e-12


@pytest.mark.parametrize("name", [name for name, entry in BASELINES.items() if entry.kind == "orthonormal"])
def test_orthonormal_baseline_is_orthonormal(name: str) -> None:
    N = BASELINES[name].begin()(path(0.7))
    assert np.abs(N.T @ N - np.eye(3)).max() < 1e-14


@pytest.mark.parametrize("name", [name for name, entry in BASELINES.items() if entry.kind == "fixed"])
def test_fixed_baseline_is_the_identity_below_but_for_a_factor(name: str) -> None:
    tail = BASELINES[name].begin()(path(0.7))[9:]
    assert np.allclose(tail, np.diag(np.diag(tail))) and np.abs(np.diag(tail)).min() > 1e-3


def test_cofactors_are_scaled_by_the_determinant() -> None:
    A = path(0.7)
    expected = baseline.determinants(A) * np.linalg.det(A[:, :9])
    assert np.abs(np.abs(baseline.dai_jones(A)) - np.abs(expected)).max() < 1e-16


def test_maggi_kane_takes_any_speeds() -> None:
    A, U = path(0.7), np.random.default_rng(0).normal(size=(3, 12))
    N = baseline.maggi_kane(A, U)
    assert np.abs(U @ N - np.eye(3)).max() < 1e-13


def test_wehage_haug_chooses_large_pivots() -> None:
    A = np.array([[1e-14, 1.0, 2.0], [1e-14, 3.0, 4.0]])
    assert np.abs(baseline.wehage_haug(A)).max() < 1 + 1e-13 < np.abs(baseline.gauss_jordan(A)).max()


def test_gauss_jordan_names_a_singular_choice() -> None:
    with pytest.raises(np.linalg.LinAlgError):
        baseline.gauss_jordan(np.array([[0.0, 1.0, 2.0], [0.0, 3.0, 4.0]]))


def test_kim_vanderploeg_is_continuous_where_singular_vectors_are_not_bound_to_be() -> None:
    method = KimVanderploeg()
    first = method(path(0.0))
    later = [method(path(t)) for t in np.linspace(0.01, 1.5, 150)]
    assert method.factorisations == 1
    assert max(np.abs(b - a).max() for a, b in zip([first, *later], later, strict=False)) < 0.02
    assert np.abs(first.T @ later[-1] - np.eye(3)).max() < 1e-13


def test_kim_vanderploeg_factors_again_when_the_subspace_has_turned() -> None:
    method, random = KimVanderploeg(), np.random.default_rng(0)
    for _ in range(3):
        method(random.normal(size=(9, 12)))
    assert method.factorisations > 1


def test_liang_lance_is_differentiable() -> None:
    def slope(h: float) -> np.ndarray:
        return (baseline.liang_lance(path(0.7 + h)) - baseline.liang_lance(path(0.7 - h))) / (2 * h)

    wide, middle, narrow = slope(4e-3), slope(2e-3), slope(1e-3)
    ratio = np.abs(wide - middle).max() / np.abs(middle - narrow).max()
    assert 3.8 < ratio < 4.2  # central differences converge with order 2


@pytest.mark.parametrize("name", ["turnback", "Coleman-Pothen fundamental", "Coleman-Pothen triangular"])
def test_sparse_baseline_is_sparse(name: str) -> None:
    A = random_banded(30, 45).samples(1)[0]
    N = BASELINES[name].begin()(A)
    assert residual(A, N) < 1e-13 and np.linalg.matrix_rank(N) == 15
    assert np.count_nonzero(N) < 0.65 * np.count_nonzero(np.abs(baseline.singh_likins(A)) > 1e-13)


def test_turnback_keeps_the_band() -> None:
    N = baseline.turnback(random_banded(30, 45).samples(1)[0])
    first, last = (N != 0).argmax(axis=0), N.shape[0] - 1 - (N[::-1] != 0).argmax(axis=0)
    assert len(set(last)) == 15
    assert (last - first).max() < 15


def test_fundamental_uses_what_its_rows_reach() -> None:
    A = np.array([[1.0, 2.0, 0.0, 0.0, 3.0, 0.0], [0.0, 4.0, 0.0, 0.0, 5.0, 0.0], [0.0, 0.0, 6.0, 7.0, 0.0, 8.0]])
    assert np.count_nonzero(baseline.fundamental(A)) == 2 + 2 + 3
    assert np.count_nonzero(baseline.triangular(A)) == 2 + 2 + 3


def test_triangular_holds_a_triangle() -> None:
    N = baseline.triangular(random_sparse(15, 20).samples(1)[0])
    starts = [int(np.flatnonzero((N[:, k] != 0) & ~(N[:, k + 1 :] != 0).any(axis=1))[0]) for k in range(N.shape[1])]
    assert len(set(starts)) == N.shape[1]


def test_measures_see_a_wrong_entry() -> None:
    A = path(0.7)
    N = baseline.gauss_jordan(A)
    exact = exact_null_space(A)
    N[4, 1] *= 1 + 1e-6
    assert residual(A, N) > 1e-9 and subspace_error(N, exact) > 1e-8
    assert orthogonality(baseline.gauss_jordan(A)) > 1e-3
    # of rank one: which directions complete it is up to rounding, and differs between processors
    assert subspace_error(np.ones((12, 3)), exact) == pytest.approx(1.0, abs=1e-4)
