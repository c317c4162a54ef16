"""Random admissible states: closed, varied, repeatable, regular."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import AssemblyError
from nullbody.verify import admissible_states, sample


def test_states_are_closed_and_begin_at_home(robot) -> None:
    states = admissible_states(robot, 20)
    assert states[0].q == pytest.approx(list(robot.mechanism.home_values(robot.parameters).values()), abs=1e-14)
    assert max(np.abs(robot.residual(state.q)).max() for state in states) < 1e-13
    assert min(np.abs(state.v).max() for state in states) > 0


def test_every_fourth_state_is_symmetric_and_others_are_tilted(robot) -> None:
    states = admissible_states(robot, 12)
    assert max(abs(state[name]) for state in states for name in ("psi", "theta", "phi")) > 0.3
    for number, state in enumerate(states[1:], 1):
        tilt = max(abs(state[name]) for name in ("psi", "theta", "phi"))
        legs = np.ptp([state[f"s{i}"] for i in (1, 2, 3)])
        if number % 4 == 1:
            assert max(tilt, legs) < 1e-12
            assert abs(state["s1"] - 0.6) > 1e-3
        else:
            assert max(tilt, legs) > 0.02


def test_same_seed_same_states(robot) -> None:
    first, again, other = (admissible_states(robot, 3, seed) for seed in (5, 5, 6))
    assert all(np.array_equal(a.q, b.q) and np.array_equal(a.v, b.v) for a, b in zip(first, again, strict=True))
    assert not np.array_equal(first[2].q, other[2].q)


def test_singular_poses_are_left_out(robot) -> None:
    largest = [np.abs(robot.null_space(state).N).max() for state in admissible_states(robot, 60)]
    assert max(largest) < 60


def test_no_state_is_an_error(robot, monkeypatch) -> None:
    monkeypatch.setattr(sample, "project", lambda model, q: (q, 1.0))
    with pytest.raises(AssemblyError, match=r"no admissible pose of 'three_prs' .* s1, s2, s3 are singular"):
        admissible_states(robot, 1)
