"""All assemblies (branches) of a mechanism for given coordinates, and inverse kinematics among them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from nullbody.catalog import closed_form_of
from nullbody.errors import InputError, SingularityError
from nullbody.kinematics.assemble import assemble, known_coordinates, start_coordinates
from nullbody.kinematics.newton import close_loops
from nullbody.mechanism import Free
from nullbody.model import Model, State
from nullbody.tolerances import GIVEN_CLOSED
from nullbody.typing import FloatArray, IndexArray

__all__ = ["Branches", "branches", "inverse_kinematics"]

_STARTS = 400
_CHECKS = 40  # random starts that look for what a closed form missed
_SINGULAR = 1e-7  # ratio of singular values: Newton stops that far from a singular end
_SAME = 1e-6  # [m, rad] two assemblies that differ by less are one


@dataclass(frozen=True)
class Branches:
    """The assemblies for given coordinates, nearest to the guess first.

    Attributes:
        states: the assembled states, at rest.
        complete: True where a closed form gives all of them and some random starts found no other; False where
            there may be more.
    """

    states: tuple[State, ...]
    complete: bool

    def __len__(self) -> int:
        return len(self.states)

    def __iter__(self) -> Iterator[State]:
        return iter(self.states)

    def __getitem__(self, index: int) -> State:
        return self.states[index]


def branches(model: Model, known: Mapping[str, float], guess: State | Mapping[str, float] | None = None) -> Branches:
    """Every assembly for given coordinates, as many as there are degrees of freedom.

    Mechanisms of the catalog that have a closed form are solved completely; others by Newton from random starts.

    Args:
        model: the model.
        known: coordinates by name [m, rad].
        guess: sorts the result; the mechanism's home by default.

    Raises:
        UnknownName, InputError: unknown names, a wrong number of them, values that are no finite numbers.
    """
    fixed, values = known_coordinates(model, known)
    if len(fixed) != model.freedom:
        raise InputError(f"give {model.freedom} coordinates to enumerate branches, not {len(fixed)}")
    start = start_coordinates(model, guess)
    free = np.setdiff1d(np.arange(len(model.coordinates)), fixed)
    closed_form = closed_form_of(model.mechanism)
    candidates = closed_form.assemblies(model.parameters, known) if closed_form else None
    exact = [np.array([candidate[name] for name in model.coordinates]) for candidate in candidates or ()]
    count = _STARTS if candidates is None else _CHECKS
    found: list[FloatArray] = []
    complete = candidates is not None
    for number, q in enumerate([*exact, *_random_starts(model, start, fixed, values, count)]):
        q[fixed] = values
        closed = close_loops(model, q, free)
        q = _wrapped(model, closed.q)
        if closed.converged and _right_way(model, q) and not any(_distance(model, q, other) < _SAME for other in found):
            found.append(q)
            complete = complete and number < len(exact)
    found.sort(key=lambda q: _distance(model, q, start))
    rest = np.zeros(len(model.independent))
    return Branches(tuple(model.trusted_state(q, rest.copy()) for q in found), complete)


def inverse_kinematics(
    model: Model, pose: Mapping[str, float], guess: State | Mapping[str, float] | None = None
) -> State:
    """The state at rest in which the end effector has a given pose, on the branch nearest to the guess.

    Args:
        model: the model.
        pose: as many end-effector coordinates as there are degrees of freedom, by name [m, rad]; for the
            3-PRS y, psi, phi (or theta in place of one angle) are solved in closed form, also where the links
            are vertical.
        guess: a state near the wanted branch; the mechanism's home by default.

    Raises:
        UnknownName, InputError: unknown names, a wrong number of them, values that are no finite numbers.
        AssemblyError: the pose is out of reach; names the loop, the gap and the reach.
        SingularityError: the pose does not determine the mechanism.
    """
    fixed, values = known_coordinates(model, pose)
    if len(fixed) != model.freedom:
        raise InputError(
            f"a pose of {model.mechanism.name!r} is {model.freedom} of its coordinates, "
            f"usually of the end effector, not {len(fixed)}"
        )
    closed_form = closed_form_of(model.mechanism)
    start = start_coordinates(model, guess)
    candidates = closed_form.inverse(model.parameters, pose) if closed_form else None
    if candidates is None:
        return _determined(model, assemble(model, pose, guess=guess), pose, fixed)
    rest = np.zeros(len(model.independent))
    found = [np.array([candidate[name] for name in model.coordinates]) for candidate in candidates]
    q = _turned(model, min(found, key=lambda q: _distance(model, q, start)), start)
    q[fixed] = values
    free = np.setdiff1d(np.arange(len(q)), fixed)
    closed = close_loops(model, q, free)
    if not closed.converged:
        return assemble(model, pose, guess=dict(zip(model.coordinates, q.tolist(), strict=True)))
    return model.trusted_state(closed.q, rest)


def _determined(model: Model, state: State, pose: Mapping[str, float], fixed: IndexArray) -> State:
    """The state, if the pose determines it: the other coordinates cannot move with the pose held."""
    free = np.setdiff1d(np.arange(len(state.q)), fixed)
    sizes = np.linalg.svd(model.jacobian(state.q)[:, free], compute_uv=False)[: len(free)]
    if len(sizes) and sizes[-1] < _SINGULAR * sizes[0]:
        raise SingularityError(
            f"{', '.join(pose)} do not determine {model.mechanism.name!r} here (smallest to largest singular value "
            f"{sizes[-1] / sizes[0]:.1e}). Give other end-effector coordinates"
        )
    return state


def _random_starts(
    model: Model, start: FloatArray, fixed: IndexArray, values: FloatArray, count: int
) -> list[FloatArray]:
    draw = np.random.default_rng(0)
    angles = np.array(model.angular)
    size = max(1e-3, float(np.abs(start[~angles]).max(initial=0.0)), *(abs(x) for x in values))
    starts = [start.copy()]
    for _ in range(count):
        q = np.where(angles, draw.uniform(-np.pi, np.pi, len(start)), start + draw.uniform(-size, size, len(start)))
        starts.append(q)
    return starts


def _right_way(model: Model, q: FloatArray) -> bool:
    """Whether no loop is closed with an axis reversed, and no equation open that no coordinate changes."""
    facing, repeated = model.evaluate("facing", q)[0], model.evaluate("redundant", q)[0]
    return bool((facing > 0).all()) and bool(np.abs(repeated).max(initial=0.0) <= GIVEN_CLOSED)


def _wrapped(model: Model, q: FloatArray) -> FloatArray:
    """Angles within (-pi, pi], and of the two triples of a free joint's angles the one with |theta| <= pi/2.

    No equation of a mechanism changes by that.
    """
    q = q.copy()
    for joint in model.mechanism.joints:
        if isinstance(joint, Free):
            psi, theta, phi = (model.coordinates.index(name) for name in joint.coordinates[3:])
            if np.cos(q[theta]) < 0:
                q[[psi, phi]] += np.pi
                q[theta] = np.pi - q[theta]
    turned: FloatArray = np.where(model.angular, np.pi - np.mod(np.pi - q, 2 * np.pi), q)
    return turned


def _turned(model: Model, q: FloatArray, guess: FloatArray) -> FloatArray:
    """Angles within half a turn of the guess's."""
    turned: FloatArray = np.where(model.angular, q + 2 * np.pi * np.round((guess - q) / (2 * np.pi)), q)
    return turned


def _distance(model: Model, left: FloatArray, right: FloatArray) -> float:
    """Largest difference of coordinates, angles modulo a turn."""
    difference = left - right
    turned = np.where(model.angular, np.mod(difference + np.pi, 2 * np.pi) - np.pi, difference)
    return float(np.abs(turned).max(initial=0.0))
