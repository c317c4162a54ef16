"""The second road inside: dense multipliers with redundant closures and coordinates that move no mass."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import UnknownName
from nullbody.verify import MultiplierEngine
from nullbody.verify.kkt import accelerations, forces
from tests.mechanisms import four_bar


def test_redundant_closures_hold_and_the_labelled_ones_carry_the_load() -> None:
    """A unit mass on a line, held twice by the same closure: q'' = 0, lambda = S u - h in the one that is kept."""
    terms = (np.eye(2), np.array([0.0, 4.0]), np.array([[0.0, 1.0], [0.0, 2.0]]), np.zeros(2))
    q_ddot, lam = accelerations(terms, np.array([3.0, 0.0]), np.array([1]))
    assert q_ddot == pytest.approx([3.0, 0.0], abs=1e-14)
    assert lam == pytest.approx([-2.0])
    u, again = forces(terms, np.array([[1.0], [0.0]]), q_ddot, np.array([1]))
    assert u == pytest.approx([3.0])
    assert again == pytest.approx([-2.0])


def test_a_closure_that_the_model_dropped_still_counts() -> None:
    """q'' fulfils all rows, not the labelled ones only: a row dropped by mistake is noticed."""
    terms = (np.eye(2), np.zeros(2), np.eye(2), np.array([0.0, -1.0]))
    q_ddot, _ = accelerations(terms, np.array([5.0, 5.0]), np.array([0]))
    assert q_ddot == pytest.approx([0.0, 1.0])


def test_scaling_of_units_does_not_decide_about_rank() -> None:
    """A mechanism of micrometres and milligrams has the same q'' in radians."""
    A, M = np.array([[1.0, 2.0, 0.5]]), np.diag([1.0, 2.0, 3.0])
    plain = accelerations((M, np.ones(3), A, np.ones(1)), np.zeros(3), np.array([0]))[0]
    tiny = accelerations((M * 1e-15, np.ones(3) * 1e-15, A * 1e-6, np.ones(1) * 1e-6), np.zeros(3), np.array([0]))[0]
    assert tiny == pytest.approx(plain, rel=1e-13)


def test_coordinates_without_mass_that_a_closure_holds() -> None:
    """M is singular along the second coordinate, as along the length of Euler parameters; A q'' + c = 0 gives it."""
    terms = (np.diag([2.0, 0.0]), np.array([1.0, 0.0]), np.array([[0.0, 1.0]]), np.array([-3.0]))
    q_ddot, lam = accelerations(terms, np.array([5.0, 0.25]), np.array([0]))
    assert q_ddot == pytest.approx([2.0, 3.0])
    assert lam == pytest.approx([0.25])


def test_unknown_closure_is_named() -> None:
    bar = four_bar()
    with pytest.raises(UnknownName, match="no constraint equation 'pin w'"):
        MultiplierEngine(bar, bar.values(), ("pin w",))
