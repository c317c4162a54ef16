"""What the kernels give at a state, refused where it has lost its digits.

The dynamics are written in a basis of coordinates that may be singular where the independent ones are not: there the
kernels that are written in those answer instead.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from nullbody.errors import SingularityError
from nullbody.model.check import check_dynamic, check_regular
from nullbody.model.state import State
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from nullbody.model.model import Model

__all__ = ["forward", "inverse", "kinematics"]


def kinematics(model: Model, state: State) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """(N, gamma, q', delta).

    Raises:
        SingularityError: |B| vanishes for the independent coordinates.
    """
    state = model.own(state)
    N, gamma, q_dot, delta, spread, doubt = model.evaluate("kinematics", state.q, state.v, t=state.t)
    check_regular(model.independent, delta, spread, doubt)
    return N, gamma, q_dot, delta


def forward(model: Model, state: State, inputs: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(q'', q') of a state in the model's own coordinates.

    Raises:
        SingularityError: |B| vanishes for the independent coordinates, or Mr is singular.
    """
    q_ddot, q_dot, *measures, _ = model.evaluate("forward_dynamics", state.q, state.v, inputs, t=state.t)
    try:
        check_dynamic(model.independent, q_ddot, *measures)
    except SingularityError:
        if model.plain is model:
            raise
        return forward(model.plain, state, inputs)
    return q_ddot, q_dot


def inverse(model: Model, state: State, v_dot: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(Qr, u, Br) of a state in the model's own coordinates.

    Raises:
        SingularityError: as `forward`.
    """
    Qr, u, Br, *measures = model.evaluate("inverse_dynamics", state.q, state.v, v_dot, t=state.t)
    try:
        check_dynamic(model.independent, Qr, *measures)
    except SingularityError:
        if model.plain is model:
            raise
        return inverse(model.plain, state, v_dot)
    return Qr, u, Br
