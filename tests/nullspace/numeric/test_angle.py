"""The angle between subspaces, also tiny ones."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest

from nullbody.errors import InputError
from nullbody.nullspace.numeric import subspace_angle


@pytest.mark.parametrize("angle", [0, 1e-15, 1e-12, 1e-8, 1e-4, 0.1, 0.7, 0.8, 1.5, np.pi / 2 - 1e-9, np.pi / 2])
def test_known_angles(angle: float) -> None:
    first = np.array([[1.0, 0], [0, 1], [0, 0], [0, 0]])
    second = np.array([[1.0, 0], [0, np.cos(angle)], [0, np.sin(angle)], [0, 0]])
    mixing = np.array([[2.0, 1], [1, -3]])
    assert subspace_angle(first, second) == pytest.approx(angle, rel=1e-12, abs=3e-16)
    assert subspace_angle(first @ mixing, second) == pytest.approx(angle, rel=1e-3, abs=1e-15)
    assert subspace_angle(second, first) == pytest.approx(subspace_angle(first, second), rel=1e-12, abs=3e-16)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("size", [1e-13, 1e-6, 1.0])
def test_against_sixty_digits(seed: int, size: float) -> None:
    generator = np.random.default_rng(seed)
    first = generator.normal(size=(6, 3))
    second = first + size * generator.normal(size=(6, 3))
    with mpmath.workdps(60):
        Q, Z = (mpmath.qr(mpmath.matrix(basis.tolist()), mode="skinny")[0] for basis in (first, second))
        rest = Z - Q * (Q.T * Z)
        sine = mpmath.sqrt(max(mpmath.eigsy(rest.T * rest, eigvals_only=True)))
        expected = float(mpmath.asin(sine))
    assert subspace_angle(first, second) == pytest.approx(expected, rel=1e-9, abs=3e-15)


def test_stacks_and_complex_bases() -> None:
    generator = np.random.default_rng(0)
    Z = generator.normal(size=(4, 5, 2)) + 1j * generator.normal(size=(4, 5, 2))
    turned = Z * np.exp(0.3j)
    found: Any = subspace_angle(Z, turned)
    assert found.shape == (4,)
    assert found.max() < 1e-15
    assert subspace_angle(Z, Z.conj()).min() > 0.1
    assert subspace_angle(Z[0], Z).shape == (4,)
    assert subspace_angle(np.zeros((3, 0)), np.zeros((3, 0))) == 0
    assert subspace_angle(np.zeros((2, 3, 0)), np.zeros((3, 0))).tolist() == [0, 0]


@pytest.mark.parametrize(
    ("first", "second", "message"),
    [
        (np.ones((3, 1)), np.ones((3, 2)), "of one size"),
        (np.ones(3), np.ones(3), "of one size"),
        (np.ones((2, 3, 1)), np.ones((4, 3, 1)), "2 and 4"),
        (np.ones((3, 1)), np.full((3, 1), np.nan), "N2 must be finite"),
    ],
)
def test_bad_bases(first: Any, second: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        subspace_angle(first, second)
