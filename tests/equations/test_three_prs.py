"""The equations of the robot against a second derivation that shares nothing with them (tests/oracles)."""

from __future__ import annotations

import cmath
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from nullbody.equations import Equations, flat
from nullbody.expr import Tape
from tests.oracles.check import ORACLES, close
from tests.oracles.robot import COORDINATES
from tests.oracles.sample import all_outputs, evaluate, sample

SEEDS = range(5)


def _complex(expressions: Any, values: Mapping[str, complex]) -> np.ndarray:
    functions = {"sin": cmath.sin, "cos": cmath.cos, "sqrt": cmath.sqrt}
    return np.array(Tape.of(list(flat(expressions)), tuple(values)).run(list(values.values()), functions), complex)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("oracle", ORACLES, ids=lambda oracle: oracle.__name__)
def test_oracle(oracle, seed: int, three_prs_equations: Equations) -> None:
    motion = sample(seed)
    oracle(evaluate(all_outputs(three_prs_equations), motion.values), motion)


def test_c_is_the_rate_of_the_jacobian(three_prs_equations: Equations) -> None:
    """c = A' q', with A' by a complex step of A along q'."""
    motion = sample(7)
    outputs = {name: three_prs_equations[name] for name in ("A", "c", "U", "h", "T")}
    shifted = {name: value + 1e-30j * motion.values.get(f"{name}_dot", 0.0) for name, value in motion.values.items()}
    rate = _complex(outputs["A"], shifted).imag / 1e-30
    close(evaluate(outputs, motion.values)["c"], rate.reshape(9, 12) @ motion.truth["q_dot"], "c")


def test_at_rest_h_is_the_gradient_of_u(three_prs_equations: Equations) -> None:
    motion = sample(8)
    still = {name: 0.0 if name.endswith("_dot") else value for name, value in motion.values.items()}
    gradient = [
        _complex([three_prs_equations["U"]], still | {name: still[name] + 1e-30j})[0].imag / 1e-30
        for name in COORDINATES
    ]
    close(evaluate({"h": three_prs_equations["h"]}, still)["h"], gradient, "h at rest")


def test_energy_gains_the_power_of_the_inputs(three_prs_equations: Equations) -> None:
    """d/dt (T + U) = u v along q'', by a complex step of time."""
    motion = sample(9)
    rate_of = {name: f"{name}_dot" for name in COORDINATES} | {f"{name}_dot": f"{name}_ddot" for name in COORDINATES}
    moved = {name: motion.values[name] + 1e-30j * motion.values[rate] for name, rate in rate_of.items()}
    total = three_prs_equations["T"] + three_prs_equations["U"]
    gained = _complex([total], motion.values | moved)[0].imag / 1e-30
    close(gained, motion.truth["u"] @ motion.truth["v"], "power", np.abs(motion.truth["h"]).max())


def test_h_is_quadratic_in_the_rates_plus_gravity(three_prs_equations: Equations) -> None:
    motion = sample(10)
    parts = {}
    for factor in (-1, 0, 1, 2):
        scaled = {name: factor * x if name.endswith("_dot") else x for name, x in motion.values.items()}
        parts[factor] = evaluate({"h": three_prs_equations["h"], "c": three_prs_equations["c"]}, scaled)
    close(parts[-1]["h"], parts[1]["h"], "h(-q')")
    close(parts[2]["h"] - parts[0]["h"], 4 * (parts[1]["h"] - parts[0]["h"]), "h(2 q')", np.abs(parts[1]["h"]).max())
    close(parts[2]["c"], 4 * parts[1]["c"], "c(2 q')")
