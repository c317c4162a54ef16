"""The 3-PRS robot, its reference numbers and admissible states, made once for all tests."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from nullbody import Model, State, build, catalog, derive, inverse_kinematics
from nullbody.kinematics import with_rates

__all__ = ["HOME", "SLIDES", "equations", "fitted", "reference", "robot", "tilted", "upright"]

SLIDES = ("s1", "s2", "s3")
HOME = {"s1": 0.6, "s2": 0.6, "s3": 0.6}
DATA = Path(__file__).parent / "data"


@cache
def equations() -> Any:
    """The robot's equations with the slides independent."""
    return derive(catalog.three_prs(), SLIDES)


@cache
def robot() -> Model:
    """The robot with the paper's parameters."""
    return build(equations())


@cache
def reference(name: str) -> Any:
    """One of the files in tests/data."""
    return json.loads((DATA / f"prs3_{name}.json").read_text(encoding="utf-8"))


def fitted(parameters: dict[str, float]) -> Model:
    """The robot with the parameters of a reference file, all of them given."""
    names = ("a", "b", "l", "M", "m", "g", "Ixx", "Iyy", "Izz")
    return robot().replace(ms=parameters["m_slider"], **{name: parameters[name] for name in names})


def tilted(model: Model, count: int, seed: int = 0, tilt: float = 0.3) -> list[State]:
    """Random poses of the platform above the slides, away from singularities, with random velocities of it."""
    draw, reach = np.random.default_rng(seed), model.parameters["l"]
    states = []
    for _ in range(count):
        pose = {
            "y": reach * draw.uniform(0.45, 0.7),
            "psi": draw.uniform(-tilt, tilt),
            "phi": draw.uniform(-tilt, tilt),
        }
        rates = dict(zip(pose, draw.normal(size=3), strict=True))
        states.append(with_rates(model, inverse_kinematics(model, pose), rates))
    return states


def upright(model: Model, v: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> State:
    """The paper's start: all links vertical."""
    home = model.mechanism.home_values(model.parameters)
    return model.state(home, v)
