"""The robots and linkages of the catalog with their models, built once, and random states with closed loops."""

from __future__ import annotations

from functools import cache

import numpy as np

from nullbody import Model, State, build, catalog, derive
from nullbody.catalog.closed_form import ClosedForm
from nullbody.verify.sample import admissible_states

__all__ = ["FORMS", "NAMES", "form", "model", "nearest", "states", "turned"]

#: Robots and linkages; the published benchmarks have tests of their own.
NAMES = [name for name, entry in catalog.ENTRIES.items() if entry.group != "benchmark"]
#: Those with a closed form.
FORMS = [name for name in NAMES if name in catalog.CLOSED_FORMS]


@cache
def model(name: str) -> Model:
    """The model with the default parameters."""
    return build(derive(catalog.mechanism(name)))


@cache
def states(name: str) -> tuple[State, ...]:
    """Home, symmetric and tilted poses with random rates."""
    return tuple(admissible_states(model(name), 12, 5))


def form(name: str) -> ClosedForm:
    """The closed form."""
    found = catalog.closed_form_of(model(name).mechanism)
    assert found is not None
    return found


def turned(name: str, one: np.ndarray, other: np.ndarray) -> float:
    """The largest difference of coordinates, angles modulo a turn."""
    angular = [unit == "rad" for unit in model(name).mechanism.units.values()]
    difference = np.where(angular, np.angle(np.exp(1j * (one - other))), one - other)
    return float(np.abs(difference).max())


def nearest(name: str, found: list[dict[str, float]], state: State) -> float:
    """How far the nearest of some assemblies is from a state."""
    return min(turned(name, np.array([one[c] for c in state.coordinates]), state.q) for one in found)
