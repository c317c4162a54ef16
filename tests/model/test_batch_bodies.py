"""Parameters of every state: bodies that cannot exist are refused, as for one model."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody import MechanismBuilder, assemble, build, simulate_batch
from nullbody.errors import ParameterError
from tests.robot import robot


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_bodies_that_cannot_exist_are_refused(dtype: type) -> None:
    made = robot()
    q, v = np.tile(assemble(made, {}).q, (5, 1)), np.zeros((5, 3))
    b = np.array([0.2, 0.21, 0.22, 0.23, 0.24])
    made.batch.forward_dynamics(q, v, parameters={"b": b, "M": 1 + b}, dtype=dtype, singular="nan")
    heavy = np.array([0.01, 0.01, 0.01, 100.0, 0.01])
    refused = r"body 'platform' would have the principal moments of inertia .* in state 3 \(1 states in all\)"
    for batch in (made.batch.forward_dynamics, made.batch.inverse_dynamics):
        with pytest.raises(ParameterError, match=refused):
            batch(q, v, np.zeros((5, 3)), parameters={"Ixx": heavy}, dtype=dtype)
    with pytest.raises(ParameterError, match="in state 0"):
        made.batch.forward_dynamics(q, v, parameters={"Ixx": 100.0}, dtype=dtype)
    with pytest.raises(ParameterError, match="in state 3"):
        simulate_batch(made, (q, v), [0, 0.01], parameters={"Ixx": heavy})


def test_tensors_of_inertia_of_every_state_are_checked() -> None:
    b = MechanismBuilder("tumbling")
    b.parameter("I", 0.1, "kg m^2", sign="any")
    b.body("rock", 1.0, inertia=(1, 1, 1, "I", 0, 0))
    b.free("joint", "rock")
    made = build(b.build())
    q, v = np.tile(assemble(made, {}).q, (3, 1)), np.zeros((3, 6))
    made.batch.forward_dynamics(q, v, parameters={"I": np.array([0.1, -0.2, 0.3])})
    with pytest.raises(ParameterError, match=r"principal moments of inertia -1, 1, 3 .* in state 1"):
        made.batch.forward_dynamics(q, v, parameters={"I": np.array([0.1, 2.0, 0.3])})
