"""Reference numbers of published benchmarks, and the same motions simulated."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from nullbody import Model, Trajectory, build, catalog, derive, simulate
from nullbody.kinematics import consistent
from nullbody.typing import FloatArray

__all__ = ["begun", "moved", "reference"]

DATA = Path(__file__).parent.parent / "data" / "published"


@cache
def reference(name: str, motion: str) -> dict[str, FloatArray]:
    """Times t and columns of one motion of a file in tests/data/published."""
    motions = json.loads((DATA / f"{name}.json").read_text(encoding="utf-8"))["motions"]
    return {column: np.array(values) for column, values in motions[motion].items()}


@cache
def _model(name: str, **counts: int) -> Model:
    """A mechanism of the catalog with its own parameters, derived once."""
    return build(derive(catalog.mechanism(name, **counts)))


def begun(name: str, motion: str, **values: Any) -> tuple[Model, Any]:
    """The model and the state from which a motion starts; `n` counts, all other values are parameters."""
    counts = {key: values[key] for key in values if key == "n"}
    start = catalog.starts(name, **values)[motion]
    model = _model(name, **counts).replace(**start.mechanism.values())
    found = consistent(model, start.q, start.q_dot)
    assert found.open_by < 1e-14
    assert found.slipped_by < 1e-14
    return model, found.state


def moved(name: str, motion: str, t: FloatArray, values: dict[str, Any] | None = None, **options: Any) -> Trajectory:
    """The motion at given times, rtol 1e-12 unless told otherwise."""
    model, state = begun(name, motion, **(values or {}))
    return simulate(model, state, float(t[-1]), samples=t, **{"rtol": 1e-12, "progress": False, **options})
