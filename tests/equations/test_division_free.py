"""Forward dynamics without a division (theory 3.7): from outputs alone, against (3.6) and the kernel."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nullbody.equations import Equations
from nullbody.model import Model, build
from tests.oracles.robot import COORDINATES, PARAMETERS
from tests.oracles.sample import INPUTS, Quantities, evaluate, sample

OUTPUTS = ("M", "h", "Q", "delta", "N_scaled", "gamma_scaled", "Mr", "hr", "Br")
TOLERANCE = 1e-11  # of the largest entry


@pytest.fixture(scope="module")
def model(three_prs_equations: Equations) -> Model:
    return build(three_prs_equations)


def division_free(found: Quantities) -> NDArray[np.float64]:
    """v' of (N~^T M N~) v' = Delta N~^T Q - N~^T (Delta h + M gamma~)."""
    N, delta, M = found["N_scaled"], found["delta"], found["M"]
    right = delta * (N.T @ found["Q"]) - N.T @ (delta * found["h"] + M @ found["gamma_scaled"])
    return np.asarray(np.linalg.solve(N.T @ M @ N, right), dtype=np.float64)


def agree(found: NDArray[np.float64], expected: NDArray[np.float64]) -> bool:
    return bool(np.abs(found - expected).max() <= TOLERANCE * np.abs(expected).max())


@pytest.mark.parametrize("seed", range(20))
def test_it_is_the_forward_dynamics_divided_once(seed: int, three_prs_equations: Equations, model: Model) -> None:
    values = sample(seed).values
    found = evaluate({name: three_prs_equations[name] for name in OUTPUTS}, values)
    u = np.array([values[name] for name in INPUTS])
    v_dot = division_free(found)
    assert agree(v_dot, np.linalg.solve(found["Mr"], found["Br"] @ u - found["hr"]))  # (3.6)
    q, v = [values[name] for name in COORDINATES], [values[f"{name}_dot"] for name in COORDINATES[9:]]
    there = model.replace(**{name: values[name] for name in PARAMETERS})
    q_ddot = there.evaluate("forward_dynamics", np.array(q), np.array(v), u)[0]
    assert agree(v_dot, q_ddot[9:])


@pytest.mark.parametrize("name", ["gamma_scaled", "h", "Q"])
def test_a_planted_sign_is_noticed(name: str, three_prs_equations: Equations) -> None:
    found = evaluate({name: three_prs_equations[name] for name in OUTPUTS}, sample(0).values)
    assert not agree(division_free({**found, name: -found[name]}), division_free(found))


def test_it_has_no_division(three_prs_equations: Equations) -> None:
    outputs = ("M", "h", "Q", "delta", "N_scaled", "gamma_scaled")
    assert [three_prs_equations.operations(name).div for name in outputs] == [0] * 6
