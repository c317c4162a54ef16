"""Random admissible states: on the constraint manifold, away from singularities of the independent set."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from nullbody.errors import AssemblyError, SingularityError, StateError
from nullbody.formats import frame, number, triple
from nullbody.kinematics import project
from nullbody.mechanism import Distance, RollingDisc
from nullbody.model import Model, State
from nullbody.model.check import check_facing, check_redundant
from nullbody.tolerances import CLOSED
from nullbody.typing import FloatArray

__all__ = ["admissible_states", "typical_length"]

_ANGLE = 0.8  # rad, of a random pose against the home
_EULER = 0.4  # likewise, of Euler parameters: half angles
_LENGTH = 0.35  # of the typical length, likewise
_SPEED = 1.0  # 1/s: rates of angles, and of lengths in typical lengths
_SPREAD = 30.0  # largest entry of N in rad and typical lengths: farther from |B| = 0 both sides keep 14 digits
_CONDITION = 1e4  # of A with rows of about length 1: beyond, it is about to lose rank, and lambda grows
_SLACK = 10  # |Phi| of a sampled pose against CLOSED, for a typical length of 1 m
_TRIES = 40  # for each state
_TIMES = 1.0  # s, of states of mechanisms that the time drives
_PATIENCE = 5  # failed tries after which one looks at half the distance from the home, and bears twice the spread


def admissible_states(model: Model, count: int, seed: int = 0) -> list[State]:
    """States with closed loops and random velocities: the home, symmetric ones, and poses tilted at random.

    The first is the home configuration, every fourth shifts all independent coordinates of a unit alike (legs
    equal), the others displace every coordinate at random; Newton steps of least norm then close the loops and
    normalise Euler parameters. Poses where an entry of N exceeds 30 (in radians and typical lengths) are drawn again.
    Mechanisms with drivers get random times within a second.

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
    for index in range(count):
        for attempt in range(_TRIES):
            kind = _kind(index, attempt)
            rate = _SPEED * random.normal(size=len(rate_scale)) * rate_scale
            reach = 0.5 ** (attempt // _PATIENCE)
            moved = home + reach * _displacement(model, kind, random) * scale
            t = random.uniform(0, _TIMES * reach) if model.rheonomic and kind != "home" else 0.0
            state = _state(model, moved, rate, t)
            if state is not None and _regular(model, state, home, (scale, rate_scale), _SPREAD / reach):
                states.append(state)
                break
        else:
            raise AssemblyError(
                f"no admissible pose of {model.mechanism.name!r} was found near its home in {_TRIES} tries: the loops "
                f"do not close there, or {', '.join(model.independent)} are singular. Check `home`, "
                "or derive with other independent coordinates"
            )
    return states


def _kind(index: int, attempt: int) -> str:
    """What a state is to be like; symmetric ones that fail too often become tilted ones."""
    if index == attempt == 0:
        return "home"
    return "symmetric" if index % 4 == 1 and attempt < _TRIES // 4 else "tilted"


def typical_length(model: Model) -> float:
    """The largest distance among placements, centres of mass, rods and radii [m]; 1 where there is none."""
    mechanism, values = model.mechanism, model.parameters
    joints = (*mechanism.joints, *mechanism.loops)
    points = [frame(place, values).position for joint in joints for place in (joint.at, joint.on)]
    points += [triple(body.centre, values) for body in mechanism.bodies]
    lengths = [float(np.linalg.norm(point)) for point in points]
    lengths += [number(loop.length, values) for loop in mechanism.loops if isinstance(loop, Distance)]
    lengths += [number(disc.radius, values) for disc in mechanism.constraints if isinstance(disc, RollingDisc)]
    return max(lengths, default=0.0) or 1.0


def _scales(model: Model, names: Iterable[str]) -> FloatArray:
    """What a coordinate is measured in: 1 rad or Euler parameter, or the typical length."""
    length, units = typical_length(model), model.mechanism.units
    return np.array([length if units[name] == "m" else 1.0 for name in names])


def _displacement(model: Model, kind: str, random: np.random.Generator) -> FloatArray:
    """A displacement of all coordinates from the home, in radians and typical lengths."""
    units = [model.mechanism.units[name] for name in model.coordinates]
    reach = np.array([{"m": _LENGTH, "rad": _ANGLE, "": _EULER}[unit] for unit in units])
    if kind == "home":
        return np.zeros(len(units))
    if kind == "symmetric":
        shift = dict(zip(sorted(set(units)), random.uniform(-1, 1, len(set(units))), strict=True))
        moved = [shift[unit] * (name in model.independent) for name, unit in zip(model.coordinates, units, strict=True)]
        return reach * np.array(moved)
    return reach * random.uniform(-1, 1, len(units))


def _state(model: Model, q: FloatArray, v: FloatArray, t: float) -> State | None:
    """The nearest pose with closed loops, or nothing where Newton gets elsewhere or nowhere."""
    closed, residual = project(model, q, t)
    if residual > CLOSED * max(typical_length(model), 1.0) * _SLACK:
        return None
    try:
        check_facing(model, closed, t)
        check_redundant(model, closed, t)
    except (StateError, AssemblyError):
        return None
    return model.trusted_state(closed, v, t)


def _regular(
    model: Model, state: State, home: FloatArray, scales: tuple[FloatArray, FloatArray], spread: float
) -> bool:
    """Whether N stays below a bound and A keeps its rank, in radians and typical lengths."""
    scale, rate_scale = scales
    try:
        N = model.null_space(state).N
    except SingularityError:
        return False
    if float(np.abs(N * rate_scale / scale[:, None]).max(initial=0.0)) > spread:
        return False
    A, at_home = model.rows(state.q, state.t)[0] * scale, model.rows(home, 0.0)[0] * scale
    length = np.maximum(np.linalg.norm(A, axis=1), np.linalg.norm(at_home, axis=1))
    return bool(length.all()) and (not len(A) or float(np.linalg.cond(A / length[:, None])) < _CONDITION)
