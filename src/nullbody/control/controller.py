"""Controllers u(t, x): feed-forward, feed-forward with PD, computed torque."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nullbody.control.desired import DesiredMotion
from nullbody.control.reference import AbstractReference
from nullbody.errors import InputError
from nullbody.model import Model, State
from nullbody.typing import FloatArray

__all__ = ["ComputedTorque", "FeedForward"]

Gain = float | Sequence[float]


@dataclass(frozen=True, eq=False)
class FeedForward:
    """Inverse-dynamics feed-forward, with PD feedback where gains are given.

        u = Br_d^-1 (Mr_d v'_d + hr_d) + Kp (s_d - s) + Kd (s'_d - s')

    Kp = Kd = 0 is open loop. The independent coordinates must be the actuated ones.

    Attributes:
        desired: the desired motion; its model may differ from the one that is controlled.
        kp: [N/m, N m/rad] for each coordinate, or one for all.
        kd: [N s/m, N m s/rad]
    """

    desired: DesiredMotion
    kp: Gain = 0.0
    kd: Gain = 0.0

    def __post_init__(self) -> None:
        model = self.desired.model
        if model.independent != model.mechanism.actuated:
            raise InputError(
                f"PD feedback acts on the actuated coordinates {', '.join(model.mechanism.actuated)}: "
                f"derive with these as the independent ones, not {', '.join(model.independent)}"
            )
        _gain(self.kp, len(model.independent), "kp")
        _gain(self.kd, len(model.independent), "kd")

    def __call__(self, t: float, x: State) -> FloatArray:
        """The inputs at time t in state x."""
        demand, n = self.desired.demand(t), len(x.v)
        error = demand.position - _independent(x)
        feedback = _gain(self.kp, n, "kp") * error + _gain(self.kd, n, "kd") * (demand.rate - x.v)
        total: FloatArray = self.desired.inputs(t) + feedback
        return total


@dataclass(frozen=True, eq=False)
class ComputedTorque:
    """Computed torque: the model linearises the robot at the actual state.

        u = Br^-1 (Mr v'_cmd + hr),   v'_cmd = v'_d + Kd (s'_d - s') + Kp (s_d - s)

    so that the error obeys e'' + Kd e' + Kp e = 0 where the model is right.

    Attributes:
        model: the controller's model of the robot.
        reference: desired motion of the independent coordinates.
        kp: [1/s^2] for each coordinate, or one for all.
        kd: [1/s]
    """

    model: Model
    reference: AbstractReference
    kp: Gain = 100.0
    kd: Gain = 20.0

    def __post_init__(self) -> None:
        n = len(self.model.independent)
        _gain(self.kp, n, "kp")
        _gain(self.kd, n, "kd")
        if len(self.reference(0.0).position) != n:
            raise InputError(f"the reference moves {len(self.reference(0.0).position)} coordinates, the model has {n}")

    def __call__(self, t: float, x: State) -> FloatArray:
        """The inputs at time t in state x."""
        demand, n = self.reference(t), len(x.v)
        error = demand.position - _independent(x)
        command = demand.acceleration + _gain(self.kd, n, "kd") * (demand.rate - x.v) + _gain(self.kp, n, "kp") * error
        measured = self.model.trusted_state(x.q.copy(), x.v.copy())  # of a robot that is not quite the model
        return self.model.inverse_dynamics(measured, command)


def _independent(x: State) -> FloatArray:
    return x.q[[x.coordinates.index(name) for name in x.independent]]


def _gain(gain: Gain, n: int, name: str) -> FloatArray:
    try:
        array = np.asarray(gain, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if array.shape not in ((), (n,)) or not np.isfinite(array).all() or (array < 0).any():
        raise InputError(f"{name} must be one gain or {n} of them, finite and not negative, not {gain!r}")
    return array
