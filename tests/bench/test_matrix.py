"""The matrices of the benchmark have the structure that they are named after."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import catalog, derive
from nullbody.bench.exact import exact_null_space
from nullbody.bench.matrix import (
    Matrix,
    absolute_chain,
    random_banded,
    random_dense,
    random_sparse,
    relative_chain,
    three_prs_generic,
    three_prs_trigonometric,
)
from nullbody.bench.robot import singular_height, state, state_near_singular

ALL = [
    three_prs_generic(),
    three_prs_trigonometric(),
    relative_chain(3),
    absolute_chain(3),
    random_dense(4, 6),
    random_sparse(8, 11),
    random_banded(12, 18),
]


@pytest.mark.parametrize("matrix", ALL, ids=lambda matrix: matrix.name)
def test_samples_are_regular(matrix: Matrix) -> None:
    A = matrix.samples(5)
    assert A.shape == (5, *matrix.shape)
    B = A[:, :, matrix.order[: matrix.shape[0]]]
    assert np.linalg.cond(B).max() < 1e8
    assert matrix.entries == np.count_nonzero(A[0])


def test_robot_has_32_symbols_and_46_entries() -> None:
    generic, trigonometric = ALL[:2]
    assert generic.shape == trigonometric.shape == (9, 12)
    assert (len(generic.inputs), generic.entries, trigonometric.entries) == (32, 46, 46)


def test_robot_matrix_is_the_models_and_generic_samples_are_its_states() -> None:
    equations = derive(catalog.three_prs(), ("s1", "s2", "s3"))
    assert str(equations["A"][4]) == str(ALL[1].rows[4])
    A = ALL[0].samples(3)
    assert np.abs(A - ALL[1].samples(3)).max() < 1e-15
    assert np.abs(np.linalg.det(A[:, :6, :6])).max() < 1e-15 < np.abs(np.linalg.det(A[:, :, :9])).min()


@pytest.mark.parametrize("links", [1, 2, 5])
def test_chains_have_their_degrees_of_freedom(links: int) -> None:
    relative, absolute = relative_chain(links), absolute_chain(links)
    assert relative.shape == (2 * links, 2 * links + 1) and len(relative.independent) == 1
    assert absolute.shape == (8 * links, 9 * links) and len(absolute.independent) == links
    assert relative.entries == 6 * links and absolute.entries == 26 * links - 8
    A = absolute.samples(1)[0]
    blocks = A.reshape(links, 8, links, 9).transpose(0, 2, 1, 3)
    assert all(not blocks[i, j].any() for i in range(links) for j in range(links) if j > i or j < i - 1)


def test_four_bars_move_alike_in_both_coordinates() -> None:
    """Rocker's speed over crank's of the first four-bar, from the same angles."""
    relative, absolute = relative_chain(1), absolute_chain(1)
    values = relative.sample(np.random.default_rng(3), 1)
    named = dict(zip(relative.inputs, values[0], strict=True))
    other = np.array([[named[name] for name in absolute.inputs]])
    left = exact_null_space(relative.numbers(values)[0])[:, 0]
    right = exact_null_space(absolute.numbers(other)[0])[:, 0]
    assert left[1] / left[2] == pytest.approx(right[8] / right[2], rel=1e-14)


def test_distance_from_singularity_is_what_it_says() -> None:
    matrix = three_prs_trigonometric()
    height = singular_height(matrix.numbers)

    def delta(distance: float) -> float:
        return float(np.linalg.det(matrix.numbers(state_near_singular(distance, height)[None])[0, :, :9]))

    assert abs(delta(0)) < 1e-18
    assert delta(1e-6) / delta(1e-8) == pytest.approx(100, rel=1e-4)
    A = matrix.numbers(state_near_singular(0, height)[None])[0]
    assert np.linalg.svd(A)[1].min() > 0.05


def test_states_close_the_loops() -> None:
    x, y, z, psi, theta, phi, *_ = state(0.4, 0.1, -0.2)
    assert np.sin(theta) * (1 + np.cos(phi) * np.cos(psi)) == pytest.approx(-np.sin(phi) * np.sin(psi))
    assert y == 0.4 and (x, z) != (0, 0)


def test_exact_null_space_is_exact() -> None:
    A = np.array([[1.0, 2.0, 0.0, 1.0], [5.0, 8.0, 1.0, 3.0]])
    N = exact_null_space(A)
    assert not (A @ N).any() and np.linalg.matrix_rank(N) == 2
