"""What lengths are measured in: the longest lever of an angle, so that units decide nothing."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from nullbody.typing import FloatArray, IndexArray

if TYPE_CHECKING:
    from nullbody.model.model import Model

__all__ = ["coordinate_scales", "stack_without_units", "without_units"]

_KEPT = 64  # models in memory


def coordinate_scales(model: Model, A: FloatArray) -> FloatArray:
    """What coordinates are measured in: 1 rad, and the longest lever of an angle for lengths [m]."""
    return np.where(_lengths(model), _lever(model, A), 1.0)


def without_units(model: Model, A: FloatArray) -> FloatArray:
    """All rows of A with lengths and gaps in longest levers: A_ij times the scale of q_j, over that of row i."""
    lever = _lever(model, A)
    scaled: FloatArray = A * np.array((1 / lever, 1.0, lever))[_powers(model)]
    return scaled


def stack_without_units(model: Model, A: FloatArray) -> FloatArray:
    """The same for a stack of A (states, rows, nq), each with its own longest lever."""
    levers = (np.abs(A) * _levers(model)).max(axis=(1, 2), initial=0.0)
    lever = np.where(levers > 0, levers, 1.0)
    powers = np.stack([1 / lever, np.ones_like(lever), lever], axis=1)
    scaled: FloatArray = A * powers[:, _powers(model)]
    return scaled


def _lever(model: Model, A: FloatArray) -> float:
    lever = float((np.abs(A) * _levers(model)).max(initial=0.0))
    return lever if lever > 0 else 1.0


@lru_cache(maxsize=_KEPT)
def _levers(model: Model) -> FloatArray:
    """1 for entries of A that are levers, gaps over angles; 0 for others."""
    return (_gaps(model)[:, None] & ~_lengths(model)).astype(float)


@lru_cache(maxsize=_KEPT)
def _powers(model: Model) -> IndexArray:
    """For every entry of A which power of the lever scales it, less or more than one: 0, 1, 2."""
    return 1 + _lengths(model).astype(np.intp) - _gaps(model).astype(np.intp)[:, None]


def _lengths(model: Model) -> IndexArray:
    units = model.mechanism.units
    return np.array([units[name] == "m" for name in model.coordinates], dtype=bool)


def _gaps(model: Model) -> IndexArray:
    units = dict((*model.mechanism.holonomic_rows, *model.mechanism.nonholonomic_rows))
    return np.array([units[label].startswith("m") for label in model.all_labels], dtype=bool)
