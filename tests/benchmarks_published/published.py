"""Reference numbers of published benchmarks, and the same motions simulated."""

from __future__ import annotations

from functools import cache
from typing import Any

from nullbody import Model, Trajectory, build, catalog, derive, simulate
from nullbody.kinematics import consistent
from nullbody.report.reference import reference
from nullbody.typing import FloatArray

__all__ = ["begun", "moved", "reference"]


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
