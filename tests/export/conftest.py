from __future__ import annotations

from pathlib import Path

import pytest

import nullbody
from nullbody import Equations, Trajectory


@pytest.fixture(scope="session")
def equations() -> Equations:
    return nullbody.derive(nullbody.catalog.three_prs())


@pytest.fixture(scope="session")
def trajectory(equations: Equations) -> Trajectory:
    """A short motion with a force, so that no column is constant."""
    model = nullbody.build(equations, {"l": 0.6})
    start = nullbody.assemble(model, {"s1": 0.6, "s2": 0.5, "s3": 0.6}, v=[0.1, 0.0, -0.2])
    return nullbody.simulate(model, start, 0.2, u=lambda t, x: [0.1 + t, -t / 3, 1e-9 * t], samples=21)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An empty folder that the tests look into afterwards."""
    place = tmp_path / "results"
    place.mkdir()
    return place
