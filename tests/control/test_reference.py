"""References: exact derivatives, rest at both ends, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nullbody import InputError
from nullbody.control import AbstractReference, Quintic, Sine, paper_reference

SINE = Sine((0.6, -0.2), (0.3, 0.7), omega=2.3, phase=0.4)
MOVE = Quintic((0.6, 0.1), (0.4, 0.9), duration=1.5, t0=0.5)


def slopes(reference: AbstractReference, t: float, h: float = 1e-3) -> tuple[np.ndarray, np.ndarray]:
    """First derivatives of position and rate, by differences of sixth order."""
    weights = np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * h)
    around = [reference(t + k * h) for k in range(-3, 4)]
    return weights @ np.array([d.position for d in around]), weights @ np.array([d.rate for d in around])


@pytest.mark.parametrize("reference", [SINE, paper_reference()])
@pytest.mark.parametrize("t", [0.0, 0.31, 2.0, -4.0, 50.0])
def test_derivatives_of_sines(reference: Sine, t: float) -> None:
    rate, acceleration = slopes(reference, t)
    np.testing.assert_allclose(reference(t).rate, rate, atol=1e-11)
    np.testing.assert_allclose(reference(t).acceleration, acceleration, atol=1e-11)


@given(t=st.floats(0.51, 1.99))
def test_derivatives_of_a_quintic(t: float) -> None:
    rate, acceleration = slopes(MOVE, t)
    np.testing.assert_allclose(MOVE(t).rate, rate, atol=1e-11)
    np.testing.assert_allclose(MOVE(t).acceleration, acceleration, atol=1e-11)


@given(t=st.floats(0.5, 2.0), h=st.just(1e-30))
def test_quintic_by_complex_step(t: float, h: float) -> None:
    x = complex(t, h) - 0.5
    x /= 1.5
    position = np.array(MOVE.start) + (np.array(MOVE.end) - MOVE.start) * x**3 * (10 - 15 * x + 6 * x * x)
    np.testing.assert_allclose(MOVE(t).position, position.real, atol=1e-15)
    np.testing.assert_allclose(MOVE(t).rate, position.imag / h, atol=1e-14)


@pytest.mark.parametrize(("t", "where"), [(-3.0, "start"), (0.5, "start"), (2.0, "end"), (99.0, "end")])
def test_quintic_rests_before_and_after(t: float, where: str) -> None:
    demand = MOVE(t)
    np.testing.assert_allclose(demand.position, getattr(MOVE, where), atol=1e-15)
    assert not demand.rate.any()
    assert not demand.acceleration.any()


@pytest.mark.parametrize("end", [0.5, 2.0])
def test_quintic_is_continuous_at_its_ends(end: float) -> None:
    before, after = MOVE(end - 1e-9), MOVE(end + 1e-9)
    for left, right, scale in zip(before, after, (1, 10, 100), strict=True):
        np.testing.assert_allclose(left, right, atol=scale * 1e-9)


def test_paper_reference() -> None:
    demand = paper_reference()(0.0)
    np.testing.assert_array_equal(demand.position, [0.6, 0.6, 0.6])
    np.testing.assert_allclose(demand.rate, [0.2, -0.3, -0.2])
    assert not demand.acceleration.any()
    np.testing.assert_allclose(paper_reference()(np.pi / 2).position, [0.8, 0.3, 0.4])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Sine((1, 2), (3,)), "as many values on both sides: 2 and 1"),
        (lambda: Sine((1, np.nan), (3, 4)), "finite numbers"),
        (lambda: Sine((1, 2), (3, "4")), "finite numbers"),
        (lambda: Sine((1,), (3,), omega=np.inf), "finite numbers"),
        (lambda: Sine((1,), (3,), phase=np.nan), "finite numbers"),
        (lambda: Sine(1, 3), "finite numbers"),
        (lambda: Quintic((1,), (2, 3), 1.0), "as many values on both sides: 1 and 2"),
        (lambda: Quintic((1,), (2,), 0.0), "duration must be positive, not 0"),
        (lambda: Quintic((1,), (2,), -1.0), "duration must be positive"),
        (lambda: Quintic((1,), (2,), np.nan), "finite numbers"),
        (lambda: Quintic((1,), (2,), "1"), "finite numbers"),
        (lambda: Quintic((1,), (2,), 1.0, t0=np.nan), "finite numbers"),
    ],
)
def test_wrong_references(make: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()
