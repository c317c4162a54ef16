"""Velocity and acceleration transport: from any nv given rates to all of them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from nullbody.errors import InputError, SingularityError
from nullbody.kinematics.assemble import known_coordinates
from nullbody.model import Model, State
from nullbody.typing import FloatArray

__all__ = ["accelerations", "velocities", "with_rates"]

_SMALLEST_RATIO = 1e-9  # of singular values, below which the given rates do not determine the others


def velocities(model: Model, q: State | FloatArray, known: Mapping[str, float]) -> FloatArray:
    """All rates q' with A q' + b = 0 for given rates of nv coordinates, e.g. of the platform [m/s, rad/s].

    Raises:
        InputError: not as many rates as degrees of freedom.
        SingularityError: these rates do not determine the others here.
    """
    position, t = (q.q, q.t) if isinstance(q, State) else (q, 0.0)
    A, b = model.rows(position, t)
    return _completed(model, A, known, b, "rate")


def accelerations(model: Model, state: State, known: Mapping[str, float]) -> FloatArray:
    """All accelerations q'' with A q'' + c = 0 for given accelerations of nv coordinates [m/s^2, rad/s^2].

    Raises:
        InputError: not as many accelerations as degrees of freedom.
        SingularityError: these accelerations do not determine the others here.
    """
    gamma = model.null_space(state).gamma
    A, _ = model.rows(state.q, state.t)
    return _completed(model, A, known, -A @ gamma, "acceleration")


def with_rates(model: Model, state: State, known: Mapping[str, float]) -> State:
    """The state with the same coordinates whose rates continue given rates of any nv coordinates.

    Raises:
        InputError, SingularityError: as `velocities`.
    """
    q_dot = velocities(model, state, known)
    return model.trusted_state(state.q.copy(), q_dot[model.independent_columns], state.t)


def _completed(model: Model, A: FloatArray, known: Mapping[str, float], c: FloatArray, kind: str) -> FloatArray:
    """x with A x + c = 0 and given entries."""
    fixed, values = known_coordinates(model, known)
    if len(fixed) != len(model.independent):
        raise InputError(f"give the {kind}s of {len(model.independent)} coordinates, not of {len(fixed)}")
    free = np.setdiff1d(np.arange(len(model.coordinates)), fixed)
    left, sizes, right = np.linalg.svd(A[:, free], full_matrices=False)
    if len(sizes) and sizes[-1] < _SMALLEST_RATIO * sizes[0]:
        raise SingularityError(
            f"the {kind}s of {', '.join(known)} do not determine the others here "
            f"(smallest to largest singular value {sizes[-1] / sizes[0]:.1e}). Give those of other coordinates"
        )
    x = np.empty(len(model.coordinates))
    x[fixed] = values
    x[free] = right.T @ ((left.T @ (-c - A[:, fixed] @ values)) / sizes)
    return x
