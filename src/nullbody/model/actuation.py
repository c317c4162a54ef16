"""What inputs can do: over-actuated, under-actuated and exactly actuated mechanisms alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nullbody.errors import SingularityError
from nullbody.model.scale import coordinate_scales
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from nullbody.model.model import Model
    from nullbody.model.state import State

__all__ = ["Actuation", "required", "solved"]

_RANK = 1e-10  # relative; singular values of Br below it are zero
_DOUBT = 1e-6  # relative, in any units; above it Br is not looked at more closely


@dataclass(frozen=True, eq=False)
class Actuation:
    """Inputs for wanted accelerations, and what is left over.

    Attributes:
        u: the inputs, of least norm among those with the least residual [N, N m].
        residual: Qr - Br u, the generalized forces along v that no input can give; zero where the motion is feasible.
        null_space: nu x k, orthonormal; u + null_space a drives the same motion for any a (internal forces).
        rank: of Br: how many degrees of freedom the inputs drive.
        feasible: whether the residual is zero to rounding.
    """

    u: FloatArray
    residual: FloatArray
    null_space: FloatArray
    rank: int
    feasible: bool


def solved(model: Model, state: State, Qr: FloatArray, Br: FloatArray) -> Actuation:
    """Least squares by singular values; where Br is nothing but rounding, the inputs can do nothing."""
    nu = Br.shape[1]
    if np.abs(Br).max(initial=0.0) < _DOUBT and _largest(model, state, Br) < _RANK:
        Br = np.zeros_like(Br)
    if not nu:
        return Actuation(np.zeros(0), Qr.copy(), np.zeros((0, 0)), 0, not np.abs(Qr).max(initial=0.0) > 0)
    left, sizes, right = np.linalg.svd(Br)
    rank = int(np.sum(sizes > _RANK * sizes.max(initial=0.0))) if sizes.max(initial=0.0) > 0 else 0
    u = right[:rank].T @ ((left[:, :rank].T @ Qr) / sizes[:rank])
    residual = Qr - Br @ u
    size = float(np.abs(Qr).max(initial=0.0))
    feasible = bool(np.abs(residual).max(initial=0.0) <= _RANK * max(size, 1e-300))
    return Actuation(u, residual, right[rank:].T.copy(), rank, feasible)


def required(model: Model, state: State, Qr: FloatArray, u: FloatArray, Br: FloatArray) -> FloatArray:
    """u with Br u = Qr: the given solution of as many inputs as degrees of freedom, of least norm with more inputs.

    Raises:
        SingularityError: Br has not full rank, to rounding.
    """
    if len(model.inputs) > len(Qr):
        u = solved(model, state, Qr, Br).u
    if len(u) != len(model.inputs):
        where = "anywhere"
    elif not np.isfinite(u).all() or (_doubtful(Br) and _smallest(model, state, Br) < _RANK):
        where = "here: some motion needs no work of theirs"
    else:
        return u
    raise SingularityError(
        f"the inputs {', '.join(model.inputs)} cannot drive all degrees of freedom {where}. `actuation` gives the "
        "inputs that come nearest, and the forces that are missing"
    )


def _doubtful(Br: FloatArray) -> bool:
    """Whether Br may be singular, without regard to units."""
    sizes = np.linalg.svd(Br, compute_uv=False)
    return not sizes.min(initial=1.0) > _DOUBT * max(sizes.max(initial=1.0), 1.0)


def _smallest(model: Model, state: State, Br: FloatArray) -> float:
    """The smallest singular value of Br without units, against the largest or 1: motions of inputs per motion of v."""
    sizes = np.linalg.svd(_without_units(model, state, Br), compute_uv=False)
    return float(sizes.min(initial=1.0) / max(sizes.max(initial=1.0), 1.0))


def _largest(model: Model, state: State, Br: FloatArray) -> float:
    return float(np.abs(_without_units(model, state, Br)).max(initial=0.0))


def _without_units(model: Model, state: State, Br: FloatArray) -> FloatArray:
    """Br in radians and the mechanism's longest lever."""
    scales = coordinate_scales(model, model.all_rows(state.q, state.t)[1])
    scaled: FloatArray = scales[model.independent_columns, None] * Br / scales[model.actuated_columns]
    return scaled
