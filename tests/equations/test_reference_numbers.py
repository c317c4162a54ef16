"""Numbers of a 200-bit maximal-coordinate Newton-Euler computation (tests/data/README.md)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nullbody.equations import Equations
from tests.oracles.robot import COORDINATES, PARAMETERS
from tests.oracles.sample import INPUTS, evaluate

DATA = Path(__file__).parents[1] / "data"
TRAJECTORY = json.loads((DATA / "prs3_inverse_dynamics.json").read_text(encoding="utf-8"))
RANDOM = json.loads((DATA / "prs3_random_states.json").read_text(encoding="utf-8"))
RELATIVE = 1e-12


def _parameters(given: dict[str, float]) -> dict[str, float]:
    return {name: given[name] for name in PARAMETERS[:-1]} | {"ms": given["m_slider"]}


def _values(parameters: dict[str, float], q: list[float], qd: list[float], qdd: list[float], F: list[float]) -> dict:
    values = _parameters(parameters) | dict(zip(COORDINATES, q, strict=True)) | dict(zip(INPUTS, F, strict=True))
    for suffix, numbers in (("_dot", qd), ("_ddot", qdd)):
        values |= {name + suffix: x for name, x in zip(COORDINATES, numbers, strict=True)}
    return values


def _close(found: Any, expected: Any, scale: float) -> None:
    assert np.abs(np.asarray(found) - expected).max() <= RELATIVE * max(np.abs(expected).max(), scale)


def _accelerations(eq: Equations, values: Any, q_ddot: list[float]) -> np.ndarray:
    """q'' = N v' + gamma, from the independent entries of q'' alone."""
    found = evaluate(eq.routines["kinematics"].outputs, values)
    return found["N"] @ np.array(q_ddot[-3:]) + found["gamma"]


@pytest.mark.parametrize("state", RANDOM["states"], ids=lambda state: state["set"])
def test_random_states(state: dict[str, Any], three_prs_equations: Equations) -> None:
    parameters = RANDOM["parameter_sets"][state["set"]]
    routines = three_prs_equations.routines
    forward = _values(parameters, state["q"], state["qd"], state["qdd"], state["F"])
    size = np.abs(state["qdd"]).max()
    _close(evaluate(routines["forward_dynamics"].outputs, forward)["q_ddot"], state["qdd"], size)
    _close(evaluate(routines["reactions"].outputs, forward)["lam"], -np.array(state["lam"]), np.abs(state["F"]).max())
    inverse = _values(parameters, state["q"], state["qd"], state["qdd_inv"], state["F_inv"])
    _close(evaluate(routines["inverse_dynamics"].outputs, inverse)["u"], state["F_inv"], 1.0)
    _close(_accelerations(three_prs_equations, inverse, state["qdd_inv"]), state["qdd_inv"], 1.0)


@pytest.mark.parametrize("k", range(len(TRAJECTORY["t"])), ids=lambda k: f"t={TRAJECTORY['t'][k]}")
def test_the_papers_trajectory(k: int, three_prs_equations: Equations) -> None:
    motion = [TRAJECTORY[name][k] for name in ("q", "qd", "qdd", "F")]
    found = evaluate(three_prs_equations.routines["inverse_dynamics"].outputs, _values(TRAJECTORY["params"], *motion))
    _close(found["u"], TRAJECTORY["F"][k], 1.0)
    values = _values(TRAJECTORY["params"], *motion)
    _close(_accelerations(three_prs_equations, values, motion[2]), TRAJECTORY["qdd"][k], 1.0)


def test_the_vertical_start_is_regular(three_prs_equations: Equations) -> None:
    """|B| = 0.00675, alpha' = s'/l, y'' = -0.113333, psi'' = -1/6, phi'' = -0.288675 (theory 4)."""
    start = [TRAJECTORY[name][0] for name in ("q", "qd", "qdd", "F")]
    values = _values(TRAJECTORY["params"], *start)
    found = evaluate(three_prs_equations.routines["inverse_dynamics"].outputs, values)
    assert abs(found["delta"]) == pytest.approx(0.00675, rel=1e-13)
    named = dict(zip(COORDINATES, _accelerations(three_prs_equations, values, start[2]), strict=True))
    expected = {"y": -0.34 / 3, "psi": -1 / 6, "phi": -1 / np.sqrt(12)}
    assert {name: named[name] for name in expected} == pytest.approx(expected, rel=1e-13)
    rates = evaluate(three_prs_equations.routines["kinematics"].outputs, values)["q_dot"]
    np.testing.assert_allclose(rates, [0] * 6 + [0.4, -0.6, -0.4, 0.2, -0.3, -0.2], atol=1e-15)
