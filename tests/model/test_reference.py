"""The robot's numbers against the 200-bit reference and the multipliers' oracle."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nullbody import Model, State
from tests.oracles.multipliers import Multipliers, forward, inverse
from tests.robot import fitted, reference, robot, tilted, upright

EXACT = 1e-12  # relative, required of every number
ORACLE = 1e-9  # relative; the oracle's differences leave 1e-12 of the larger terms

GENERAL = {
    "a": 1.1,
    "b": 0.31,
    "l": 0.7,
    "M": 3.0,
    "m": 0.4,
    "g": 3.7,
    "Ixx": 0.05,
    "Iyy": 0.07,
    "Izz": 0.03,
    "ms": 0.6,
}


def assert_close(value: Any, wanted: Any, relative: float = EXACT) -> None:
    wanted = np.array(wanted)
    np.testing.assert_allclose(value, wanted, rtol=0, atol=relative * np.abs(wanted).max())


def cases() -> list[tuple[Model, State, dict[str, Any]]]:
    sets = reference("random_states")["parameter_sets"]
    made = []
    for case in reference("random_states")["states"]:
        model = fitted(sets[case["set"]])
        made.append((model, model.state(case["q"], case["qd"][9:]), case))
    return made


def test_the_file_holds_both_parameter_sets() -> None:
    used = [case["set"] for case in reference("random_states")["states"]]
    assert len(used) == 20
    assert set(used) == {"paper", "rnd1"}


def test_velocity() -> None:
    for model, state, case in cases():
        assert_close(model.velocity(state), case["qd"])


def test_forward_dynamics() -> None:
    for model, state, case in cases():
        assert_close(model.forward_dynamics(state, case["F"]), case["qdd"])


def test_reactions_have_the_opposite_sign_of_the_reference() -> None:
    for model, state, case in cases():
        assert_close(-model.reactions(state, case["F"]), case["lam"])


def test_inverse_dynamics() -> None:
    for model, state, case in cases():
        assert_close(model.inverse_dynamics(state, case["sdd_inv"]), case["F_inv"])
        assert_close(model.acceleration(state, case["sdd_inv"]), case["qdd_inv"])


def test_inverse_dynamics_along_the_paper_s_trajectory() -> None:
    motion = reference("inverse_dynamics")
    model = fitted(motion["params"])
    for k, t in enumerate(motion["t"]):
        state = model.state(motion["q"][k], motion["qd"][k][9:])
        F = model.inverse_dynamics(state, motion["qdd"][k][9:])
        np.testing.assert_allclose(F, motion["F"][k], rtol=0, atol=EXACT * max(1.0, np.abs(motion["F"][k]).max()))
        assert_close(model.acceleration(state, motion["qdd"][k][9:]), motion["qdd"][k])
        assert_close(-model.reactions(state, F), motion["lam"][k])
        assert_close(model.forward_dynamics(state, motion["F"][k])[9:], motion["qdd"][k][9:]) if t else None


def test_start_with_all_links_vertical() -> None:
    model, motion = robot(), reference("inverse_dynamics")
    state = upright(model, (0.2, -0.3, -0.2))
    assert_close(model.velocity(state), motion["qd"][0])
    assert_close(model.acceleration(state, np.zeros(3)), motion["qdd"][0])
    assert np.abs(model.inverse_dynamics(state, np.zeros(3))).max() < 1e-14
    assert model.null_space(state).delta == pytest.approx(0.00675, rel=1e-13)


@pytest.mark.parametrize("changes", [{}, GENERAL, {"ms": 2.5}, {"Ixx": 0.02, "Izz": 0.015, "Iyy": 0.03}])
def test_forward_dynamics_against_multipliers(changes: dict[str, float]) -> None:
    model = robot().replace(**changes)
    oracle, draw = Multipliers(model.parameters), np.random.default_rng(5)
    for state in tilted(model, 12, seed=1):
        F = draw.normal(scale=5, size=3)
        q_ddot, lam = forward(oracle.terms(state.q, model.velocity(state)), F)
        assert_close(model.forward_dynamics(state, F), q_ddot, ORACLE)
        assert_close(model.reactions(state, F), lam, ORACLE)


@pytest.mark.parametrize("changes", [{}, GENERAL])
def test_inverse_dynamics_against_multipliers(changes: dict[str, float]) -> None:
    model = robot().replace(**changes)
    oracle, draw = Multipliers(model.parameters), np.random.default_rng(6)
    for state in tilted(model, 12, seed=2):
        s_ddot = draw.normal(scale=3, size=3)
        F, q_ddot, _ = inverse(oracle.terms(state.q, model.velocity(state)), s_ddot)
        assert_close(model.inverse_dynamics(state, s_ddot), F, ORACLE)
        assert_close(model.acceleration(state, s_ddot), q_ddot, ORACLE)


@pytest.mark.parametrize("changes", [{}, GENERAL])
def test_energy_against_the_oracle(changes: dict[str, float]) -> None:
    model = robot().replace(**changes)
    oracle = Multipliers(model.parameters)
    for state in tilted(model, 20, seed=3):
        T, U = oracle.energy(state.q, model.velocity(state))
        assert_close(model.energy(state), (T, U))
        assert model.energy(state).total == pytest.approx(T + U, rel=EXACT)


def test_derived_defaults_equal_given_ones() -> None:
    model = robot().replace(M=2.0, b=0.25)
    given = robot().replace(M=2.0, b=0.25, Ixx=2 * 0.25**2 / 4, Iyy=2 * 0.25**2 / 2, Izz=2 * 0.25**2 / 4)
    (state,) = tilted(model, 1)
    assert_close(model.forward_dynamics(state, (1, 2, 3)), given.forward_dynamics(state, (1, 2, 3)), 1e-14)
