"""Steps, inputs and tolerances of many robots that make no sense: refused by name, at once."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import simulate_batch
from nullbody.errors import InputError
from tests.robot import robot
from tests.simulate.test_batch import starts


def test_steps_that_the_time_cannot_count_are_refused() -> None:
    made, (q, v) = robot(), starts()
    for t, options, says in (
        (0.02, {"step": 1e-12}, "step = 1e-12 s is too small for times up to 0.02 s"),
        (0.02, {"step": 1e-320}, "is too small for times"),
        ([1e10, 1e10 + 0.01], {"step": 1e-6}, "is too small for times up to 1e"),
        (0.02, {"hold": 1e-12}, r"hold = 1e-12 s needs 2e\+10 steps"),
        (0.02, {"hold": 1e-300}, "Hold the inputs longer"),
    ):
        with pytest.raises(InputError, match=says):
            simulate_batch(made, (q, v), t, **options)  # type: ignore[arg-type]


def test_inputs_that_are_no_numbers_are_named() -> None:
    made, (q, v) = robot(), starts()
    for u, says in (
        ([[1], [1, 2]], "input values are no array of numbers"),
        (np.zeros((2, 9, 0)), r"\(2 intervals, 9 robots or 1, 3\), not one of shape \(2, 9, 0\)"),
        (lambda t, q, v: "push", r"at t = 0 s u\(t, q, v\): values must be real numbers"),
        (lambda t, q, v: np.zeros(3) * 1j, "must be real numbers, not complex128"),
        (lambda t, q, v: None, "must be real numbers, not object"),
        (lambda t, q, v: [[1], [1, 2]], "are no array of numbers"),
    ):
        with pytest.raises(InputError, match=says):
            simulate_batch(made, (q, v), [0, 0.01, 0.02], u)
    for rtol in ("x", None, [1e-8], 1e-8j):
        with pytest.raises(InputError, match="rtol must be a number"):
            simulate_batch(made, (q, v), 0.02, rtol=rtol, atol=1e-9)  # type: ignore[arg-type]
