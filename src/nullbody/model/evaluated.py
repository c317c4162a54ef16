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
    plain = _instead(model, q_ddot, measures)
    return (q_ddot, q_dot) if plain is None else forward(plain, state, inputs)


def inverse(model: Model, state: State, v_dot: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(Qr, u, Br) of a state in the model's own coordinates.

    Raises:
        SingularityError: as `forward`.
    """
    Qr, u, Br, *measures = model.evaluate("inverse_dynamics", state.q, state.v, v_dot, t=state.t)
    plain = _instead(model, Qr, measures)
    return (Qr, u, Br) if plain is None else inverse(plain, state, v_dot)


def _instead(model: Model, result: FloatArray, measures: list[FloatArray]) -> Model | None:
    """The model to ask where a result has lost too many digits; None where it has not.

    Raises:
        SingularityError: it has, and the model's kernels are the plain ones already.
    """
    try:
        check_dynamic(model.independent, result, *measures)
    except SingularityError:
        plain = model.plain
        if plain is model:
            raise
        return plain
    return None
