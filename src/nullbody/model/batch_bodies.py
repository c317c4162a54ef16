"""Whether bodies can exist for parameters that differ from state to state: the rule of `mechanism.check`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nullbody.errors import ParameterError
from nullbody.expr.parse import names_in, parse
from nullbody.mechanism import Body, Mechanism
from nullbody.mechanism.check import INERTIA_SLACK
from nullbody.model.batch_inputs import ARRAY_FUNCTIONS, parameter_rows
from nullbody.typing import FloatArray, Scalar

if TYPE_CHECKING:
    from nullbody.model.model import Model

__all__ = ["checked_parameters"]


def checked_parameters(model: Model, given: object, states: int) -> FloatArray:
    """Parameters as `parameter_rows` gives them, for bodies that can exist.

    Raises:
        UnknownName, InputError, ParameterError: as `parameter_rows`; a body could not exist: names the first state.
    """
    parameters = parameter_rows(model, given, states, np.dtype(np.float64))
    if given is not None:
        _check_bodies(model.mechanism, parameters)
    return parameters


def _check_bodies(mechanism: Mechanism, parameters: FloatArray) -> None:
    """Raise where a body would have a negative mass, or moments of inertia that no body has.

    Args:
        mechanism: whose bodies they are.
        parameters: (np,) or (states, np).

    Raises:
        ParameterError: names the body and the first state.
    """
    table = np.atleast_2d(parameters)
    if not len(table):
        return
    columns = {p.name: table[:, k] for k, p in enumerate(mechanism.parameters)}
    varied = {name for name, column in columns.items() if (column != column[0]).any()}
    first = {name: column[:1] for name, column in columns.items()}
    for body in mechanism.bodies:
        entries = [body.mass, *(entry for row in body.inertia_matrix for entry in row)]
        differs = any(names_in(entry) & varied for entry in entries)
        _check(body, columns if differs else first, len(table) if differs else 1)


def _check(body: Body, columns: dict[str, FloatArray], states: int) -> None:
    def number(source: Scalar) -> FloatArray:
        with np.errstate(all="ignore"):
            found = parse(source, columns.__getitem__, functions=ARRAY_FUNCTIONS)
        return np.broadcast_to(np.asarray(found, dtype=np.float64), (states,))

    mass = number(body.mass)
    if (wrong := ~(mass >= 0)).any():
        place = int(np.flatnonzero(wrong)[0])
        raise ParameterError(f"body {body.name!r} would have the mass {mass[place]:g} kg in state {place}")
    I_C = [[number(entry) for entry in row] for row in body.inertia_matrix]
    diagonal = np.stack([I_C[k][k] for k in range(3)], axis=1)
    if any(I_C[i][j].any() for i in range(3) for j in range(3) if i != j):
        matrices = np.stack([np.stack(row, axis=1) for row in I_C], axis=1)
        moments = np.linalg.eigvalsh(np.nan_to_num(matrices, nan=-1.0, posinf=-1.0, neginf=-1.0))
    else:
        moments = np.sort(diagonal, axis=1)
    slack = INERTIA_SLACK * np.abs(moments).max(axis=1)
    wrong = ~((moments[:, 0] >= -slack) & (moments[:, 2] <= moments[:, 0] + moments[:, 1] + slack))
    if wrong.any():
        place = int(np.flatnonzero(wrong)[0])
        shown = ", ".join(f"{moment:.6g}" for moment in moments[place])
        raise ParameterError(
            f"body {body.name!r} would have the principal moments of inertia {shown} kg m^2 in state {place} "
            f"({int(wrong.sum())} states in all): none may be negative or above the sum of the other two"
        )
