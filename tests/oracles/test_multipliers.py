"""The oracle agrees with the reference numbers, and does not where a sign error is planted in it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.oracles.multipliers import Multipliers, Terms, forward, inverse
from tests.robot import reference

AGREE = 1e-12  # relative; what Richardson's differences leave at velocities of 1 m/s is 5e-15


def parameters(name: str) -> dict[str, float]:
    given = reference("random_states")["parameter_sets"][name]
    return {**given, "ms": given["m_slider"]}


def worst(change: Callable[[Terms], Terms] = lambda t: t, **options: object) -> float:
    """Largest relative error of q'' and lambda over the reference states."""
    found = 0.0
    for case in reference("random_states")["states"]:
        oracle = Multipliers(parameters(case["set"]), **options)
        terms = change(oracle.terms(np.array(case["q"]), np.array(case["qd"])))
        for value, wanted in zip(
            forward(terms, np.array(case["F"])), (case["qdd"], -np.array(case["lam"])), strict=True
        ):
            found = max(found, np.abs(value - wanted).max() / np.abs(wanted).max())
    return found


def test_forward_agrees_with_the_reference() -> None:
    assert worst() < AGREE


def test_inverse_agrees_with_the_reference() -> None:
    for case in reference("random_states")["states"]:
        oracle = Multipliers(parameters(case["set"]))
        F, q_ddot, _ = inverse(oracle.terms(np.array(case["q"]), np.array(case["qd"])), np.array(case["sdd_inv"]))
        np.testing.assert_allclose(F, case["F_inv"], rtol=0, atol=AGREE * np.abs(case["F_inv"]).max())
        np.testing.assert_allclose(q_ddot, case["qdd_inv"], rtol=0, atol=AGREE * np.abs(case["qdd_inv"]).max())


def test_energy_agrees_with_the_reference() -> None:
    motion = reference("free_motion")["scenarios"]["S1_hanging_swing_zero_force"]
    oracle = Multipliers({**motion["params"], "ms": 0.0})
    for k in range(0, 41, 8):
        T, U = oracle.energy(np.array(motion["q"][k]), np.array(motion["qd"][k]))
        assert abs(T - motion["kinetic"][k]) < 1e-13 * 6
        assert abs(U - motion["potential"][k]) < 1e-13 * 6


def flip_entry(terms: Terms) -> Terms:
    M = terms.M.copy()
    M[6, 9] *= -1
    return terms._replace(M=M)


def flip_column(terms: Terms) -> Terms:
    A = terms.A.copy()
    A[0, 4] *= -1
    return terms._replace(A=A)


@pytest.mark.parametrize(
    ("change", "options"),
    [
        pytest.param(lambda t: t._replace(c=-t.c), {}, id="sign of c"),
        pytest.param(lambda t: t._replace(h=-t.h), {}, id="sign of h"),
        pytest.param(flip_entry, {}, id="one coupling of M"),
        pytest.param(flip_column, {}, id="one entry of A"),
        pytest.param(lambda t: t, {"up": -1.0}, id="gravity"),
        pytest.param(lambda t: t, {"rod": 1 / 3}, id="rod about its end"),
        pytest.param(lambda t: t, {"links": (1.0, -1.0, 1.0)}, id="energy of one link"),
    ],
)
def test_planted_error_is_seen(change: Callable[[Terms], Terms], options: dict[str, object]) -> None:
    assert worst(change, **options) > 1e-4
