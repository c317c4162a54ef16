"""Random admissible states: closed, varied, repeatable, regular."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import AssemblyError, build, derive
from nullbody.model.check import check_facing
from nullbody.verify import admissible_states, sample
from nullbody.verify.sample import typical_length
from tests.verify.cases import CASES


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
    monkeypatch.setattr(sample, "project", lambda model, q, t: (q, 1.0))
    with pytest.raises(AssemblyError, match=r"no admissible pose of 'three_prs' .* s1, s2, s3 are singular"):
        admissible_states(robot, 1)


def model_of(name):
    return build(derive(CASES[name]()))


def test_euler_parameters_are_normalised_and_rates_keep_them_so() -> None:
    model = model_of("constraint RollingDisc")
    states = admissible_states(model, 6)
    at = [model.coordinates.index(f"e{k}") for k in range(4)]
    assert max(abs(np.linalg.norm(state.q[at]) - 1) for state in states) < 1e-14
    assert min(np.linalg.norm(state.q[at] - states[0].q[at]) for state in states[1:]) > 0.02
    for state in states:
        A, b = model.rows(state.q, state.t)
        assert np.abs(A @ model.velocity(state) + b).max() < 1e-13


def test_times_are_drawn_where_the_time_matters() -> None:
    driven = admissible_states(model_of("constraint Driver"), 5)
    assert driven[0].t == 0
    assert len({state.t for state in driven}) == 5
    assert all(0 <= state.t <= 1 for state in driven)
    assert {state.t for state in admissible_states(model_of("constraint Coupling"), 3)} == {0}


def test_loops_are_not_closed_the_wrong_way_round() -> None:
    model = model_of("loop Cylindrical")
    for state in admissible_states(model, 10):
        check_facing(model, state.q)


def test_typical_length_counts_placements_rods_and_radii(robot) -> None:
    assert typical_length(robot) == pytest.approx(0.866, abs=0.4)
    assert typical_length(model_of("loop Distance")) == pytest.approx(0.6)
    assert typical_length(model_of("tree Free").replace(p=40)) == pytest.approx(40, rel=0.01)
