"""The 3-PRS of the speed benchmark: its model, random states, and what every tool is given there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nullbody import catalog
from nullbody.equations import derive
from nullbody.model import Model, State, build
from nullbody.typing import FloatArray
from nullbody.verify import admissible_states

__all__ = ["INDEPENDENT", "Sample", "robot_model", "sample"]

#: The slides, which the motors drive.
INDEPENDENT = ("s1", "s2", "s3")

_FORCE = 1.0  # [N], the size of random inputs


@dataclass(frozen=True)
class Sample:
    """States and inputs.

    Attributes:
        states: with closed loops.
        q, v, q_dot: row by row.
        u: random inputs, row by row.
        q_ddot: accelerations that they cause, by this package, row by row.
    """

    states: Sequence[State]
    q: FloatArray
    v: FloatArray
    q_dot: FloatArray
    u: FloatArray
    q_ddot: FloatArray


def robot_model() -> Model:
    """The 3-PRS with the paper's independent coordinates."""
    return build(derive(catalog.three_prs(), INDEPENDENT))


def sample(model: Model, count: int, seed: int = 0) -> Sample:
    """Random admissible states of a model."""
    states = admissible_states(model, count, seed)
    u = _FORCE * np.random.default_rng([seed, 1]).normal(size=(count, len(model.inputs)))
    return Sample(
        states,
        np.array([state.q for state in states]),
        np.array([state.v for state in states]),
        np.array([model.velocity(state) for state in states]),
        u,
        np.array([model.forward_dynamics(state, forces) for state, forces in zip(states, u, strict=True)]),
    )
