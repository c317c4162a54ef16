"""Random admissible states: on the constraint manifold, away from singularities of the independent set."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from nullbody.errors import AssemblyError, SingularityError
from nullbody.formats import frame, loop_points
from nullbody.kinematics import project
from nullbody.model import Model, State
from nullbody.tolerances import CLOSED
from nullbody.typing import FloatArray

__all__ = ["admissible_states", "typical_length"]

_ANGLE = 0.8  # rad, of a random pose against the home
_LENGTH = 0.35  # of the typical length, likewise
_SPEED = 1.0  # 1/s: rates of angles, and of lengths in typical lengths
_SPREAD = 30.0  # largest entry of N in rad and typical lengths: farther from |B| = 0 both sides keep 14 digits
_SLACK = 10  # |Phi| of a sampled pose against CLOSED, for a typical length of 1 m
_TRIES = 40  # for each state


def admissible_states(model: Model, count: int, seed: int = 0) -> list[State]:
    """States with closed loops and random velocities: the home, symmetric ones, and poses tilted at random.

    The first is the home configuration, every fourth shifts all independent coordinates of a unit alike (legs
    equal), the others displace every coordinate at random; Newton steps of least norm then close the loops.
    Poses where an entry of N exceeds 30 (in radians and typical lengths) are drawn again.

    Args:
        model: any model whose mechanism has a home.
        count: number of states.
        seed: of the random generator; the same seed gives the same states.

    Raises:
        AssemblyError: near the home no pose closes the loops away from a singularity.
    """
    random = np.random.default_rng(seed)
    scale = _scales(model, model.coordinates)
    rate_scale = _scales(model, model.independent)
    home = np.array(list(model.mechanism.home_values(model.parameters).values()))
    states = []
    for number in range(count):
        for attempt in range(_TRIES):
            kind = _kind(number, attempt)
            rate = _SPEED * random.normal(size=len(rate_scale)) * rate_scale
            state = _state(model, home + _displacement(model, kind, random) * scale, rate)
            if state is not None and _regular(model, state, scale, rate_scale):
                states.append(state)
                break
        else:
            raise AssemblyError(
                f"no admissible pose of {model.mechanism.name!r} was found near its home in {_TRIES} tries: the loops "
                f"do not close there, or {', '.join(model.independent)} are singular. Check `home`, "
                "or derive with other independent coordinates"
            )
    return states


def _kind(number: int, attempt: int) -> str:
    """What a state is to be like; symmetric ones that fail too often become tilted ones."""
    if number == attempt == 0:
        return "home"
    return "symmetric" if number % 4 == 1 and attempt < _TRIES // 4 else "tilted"


def typical_length(model: Model) -> float:
    """The largest distance among placements and loop points [m]; 1 where there is none."""
    mechanism, values = model.mechanism, model.parameters
    points: list[Any] = [frame(joint.at, values).position for joint in mechanism.joints]
    points += [point for loop in mechanism.loops for point in loop_points(loop, values)]
    return max((float(np.linalg.norm(point)) for point in points), default=0.0) or 1.0


def _scales(model: Model, names: Iterable[str]) -> FloatArray:
    """What a coordinate is measured in: 1 rad, or the typical length."""
    length, units = typical_length(model), model.mechanism.units
    return np.array([length if units[name] == "m" else 1.0 for name in names])


def _displacement(model: Model, kind: str, random: np.random.Generator) -> FloatArray:
    """A displacement of all coordinates from the home, in radians and typical lengths."""
    units = [model.mechanism.units[name] for name in model.coordinates]
    reach = np.array([_LENGTH if unit == "m" else _ANGLE for unit in units])
    if kind == "home":
        return np.zeros(len(units))
    if kind == "symmetric":
        shift = dict(zip(sorted(set(units)), random.uniform(-1, 1, len(set(units))), strict=True))
        moved = [shift[unit] * (name in model.independent) for name, unit in zip(model.coordinates, units, strict=True)]
        return reach * np.array(moved)
    return reach * random.uniform(-1, 1, len(units))


def _state(model: Model, q: FloatArray, v: FloatArray) -> State | None:
    """The nearest pose with closed loops, or nothing where Newton does not get there."""
    closed, residual = project(model, q)
    return model.trusted_state(closed, v) if residual <= CLOSED * typical_length(model) * _SLACK else None


def _regular(model: Model, state: State, scale: FloatArray, rate_scale: FloatArray) -> bool:
    try:
        N = model.null_space(state).N
    except SingularityError:
        return False
    return float(np.abs(N * rate_scale / scale[:, None]).max(initial=0.0)) <= _SPREAD
