from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy import sparse
from scipy.optimize import brentq

from nullbody.errors import InputError, SingularityError
from nullbody.nullspace import null_space
from nullbody.nullspace.numeric import subspace_angle
from nullbody.nullspace.numeric.equilibrate import Matrices
from nullbody.nullspace.sample import generic_point, sampled
from nullbody.nullspace.switch import better_chart, conditions, orthonormal
from nullbody.tolerances import EPS

DRIVEN = (9, 10, 11)  # s1, s2, s3


def exact_basis(A: Any, independent: tuple[int, ...]) -> Any:
    """The null space of the doubles as they stand, in rationals, rounded once."""
    return np.array(null_space([[Fraction(a) for a in row] for row in A.tolist()], independent).basis, dtype=float)


def solved(A: Any, independent: tuple[int, ...]) -> Any:
    """N = [-B^-1 C; I] by LAPACK, in a fixed chart."""
    dependent = [j for j in range(A.shape[1]) if j not in independent]
    N = np.zeros((A.shape[1], len(independent)))
    N[list(independent)] = np.eye(len(independent))
    N[dependent] = -np.linalg.solve(A[:, dependent], A[:, list(independent)])
    return N


@pytest.fixture(scope="module")
def near(three_prs_jacobian: list[list[Any]]) -> Any:
    """A of the robot where alpha1 is a given distance away from a root of |B|, |B| linear in between."""
    symbols = three_prs_jacobian[0][0].graph.symbols
    dependent = [j for j in range(12) if j not in DRIVEN]

    def at(alpha: float) -> Any:
        return sampled(three_prs_jacobian, [{**generic_point(symbols), "alpha1": alpha}])[0]

    grid = np.linspace(-3, 3, 100)
    signs = np.sign([np.linalg.det(at(alpha)[:, dependent]) for alpha in grid])
    k = int(np.flatnonzero(signs[1:] != signs[:-1])[0])
    root = brentq(lambda alpha: np.linalg.det(at(alpha)[:, dependent]), grid[k], grid[k + 1], xtol=1e-16)
    return lambda distance: at(root + distance)


@pytest.mark.parametrize("distance", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
def test_switching_keeps_the_subspace_at_any_distance_from_a_singularity(near: Any, distance: float) -> None:
    A = near(distance)
    chart = better_chart(A, DRIVEN)
    assert subspace_angle(solved(A, chart), exact_basis(A, chart)) < 1e-13
    if distance <= 1e-6:
        assert chart != DRIVEN
        assert subspace_angle(solved(A, DRIVEN), exact_basis(A, DRIVEN)) > 1e-13
        assert better_chart(A, chart) == chart


def test_the_columns_at_hand_stay_while_they_are_good_enough(near: Any) -> None:
    A = near(1e-4)
    error = EPS * np.linalg.norm(solved(A, DRIVEN), 2)
    assert better_chart(A, DRIVEN, bound=1.01 * error) == DRIVEN
    assert better_chart(A, DRIVEN[::-1], bound=1.01 * error) == DRIVEN[::-1]
    assert better_chart(A, DRIVEN, bound=0.99 * error) != DRIVEN


def test_the_choice_does_not_depend_on_scales_or_repeated_rows(near: Any) -> None:
    A = near(1e-9)
    chart = better_chart(A, DRIVEN)
    assert better_chart(A * np.logspace(-150, 150, 9)[:, None], DRIVEN) == chart
    assert better_chart(np.vstack([A, A[:3] @ np.eye(12), np.zeros(12)]), DRIVEN) == chart
    assert np.linalg.norm(solved(A, chart), 2) < 10


def test_conditions_are_norms_of_reduced_bases() -> None:
    A = np.random.default_rng(3).normal(size=(4, 7))
    (Z,) = orthonormal(Matrices.of(A), 4)
    assert Z is not None
    charts = [(0, 1, 2), (4, 5, 6), (1, 3, 6)]
    expected = [np.linalg.norm(solved(A, chart), 2) for chart in charts]
    assert conditions(Z, np.array(charts)) == pytest.approx(expected, rel=1e-12)


def test_what_cannot_be_helped_is_named() -> None:
    with pytest.raises(SingularityError, match="A loses rank at this state"):
        better_chart([[1.0, 2, 3], [2, 4, 6]], [0])
    with pytest.raises(InputError, match="rank above 1: 2 independent columns are too many"):
        better_chart([[1.0, 2, 3], [2, 5, 6]], [0, 1])
    with pytest.raises(InputError, match=r"distinct and in 0\.\.2"):
        better_chart([[1.0, 2, 3]], [0, 3])
    for A in (sp.Matrix([[1, sp.Symbol("x"), 3]]), sparse.eye_array(1, 3, format="csr")):
        with pytest.raises(InputError, match=r"A needs numbers at one state: .* A\.toarray\(\) of a sparse matrix"):
            better_chart(A, [1, 2])
    with pytest.raises(InputError, match=r"N1 needs numbers"):
        subspace_angle(sparse.eye_array(3, 2, format="csr"), np.eye(3, 2))
    with pytest.raises(InputError, match="one state"):
        better_chart(np.ones((2, 1, 3)), [0, 1])
