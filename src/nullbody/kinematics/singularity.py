"""Singularity measures of a configuration: forward, inverse, and of the constraints themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nullbody.kinematics.chart import regularity
from nullbody.model import Model, State, checked_model
from nullbody.typing import FloatArray

__all__ = ["Singularity", "singularity"]


@dataclass(frozen=True)
class Singularity:
    """How far a configuration is from being singular: 0 is singular, 1 is best.

    Each measure is the ratio of the smallest to the largest singular value: of columns of A scaled to unit length, so
    that units of coordinates do not matter, or of A itself in radians and the mechanism's longest lever.

    Attributes:
        forward: of the dependent columns B for v = rates of the independent (usually actuated) coordinates.
            0: forward (type II) singularity, the actuators do not hold the mechanism.
        inverse: of the columns of all coordinates but the end effector's. 0: inverse (type I) singularity,
            some motion of the end effector is lost. NaN where no end effector is named.
        constraint: of A itself. 0: the closures depend on each other, a configuration singularity.
        delta: |B| itself.
        subspace_error: expected relative error of N, EPS |N|.
    """

    forward: float
    inverse: float
    constraint: float
    delta: float
    subspace_error: float


def singularity(model: Model, state: State) -> Singularity:
    """The singularity measures at a state (Gosselin and Angeles 1990 for the types)."""
    checked_model(model)
    state = model.own(state)
    A, _ = model.rows(state.q, state.t)
    names = list(model.coordinates)
    dependent = [names.index(name) for name in model.dependent]
    task: tuple[str, ...] = ()
    for joint in model.mechanism.joints:
        if joint.child == model.mechanism.end_effector:
            task = joint.coordinates
    others = [j for j, name in enumerate(names) if name not in task]
    _, _, _, delta, spread, _ = model.evaluate("kinematics", state.q, state.v, t=state.t)
    return Singularity(
        forward=_ratio(_unit_columns(A[:, dependent])),
        inverse=_ratio(_unit_columns(A[:, others])) if task else float("nan"),
        constraint=regularity(model, state.q, state.t),
        delta=float(delta),
        subspace_error=float(np.finfo(float).eps * np.sqrt(spread)) if np.isfinite(spread) else float("inf"),
    )


def _unit_columns(matrix: FloatArray) -> FloatArray:
    length = np.linalg.norm(matrix, axis=0)
    scaled: FloatArray = matrix / np.where(length > 0, length, 1.0)
    return scaled


def _ratio(matrix: FloatArray) -> float:
    if not matrix.size:
        return 1.0
    sizes = np.linalg.svd(matrix, compute_uv=False)
    return float(sizes[-1] / sizes[0]) if sizes[0] > 0 else 0.0
