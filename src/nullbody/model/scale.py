"""What lengths are measured in: the longest lever of an angle, so that units decide nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nullbody.typing import FloatArray, IndexArray

if TYPE_CHECKING:
    from nullbody.model.model import Model

__all__ = ["coordinate_scales", "row_scales"]


def coordinate_scales(model: Model, A: FloatArray) -> FloatArray:
    """What coordinates are measured in: 1 rad, and the longest lever of an angle for lengths [m]."""
    return np.where(_lengths(model), _lever(model, A), 1.0)


def row_scales(model: Model, A: FloatArray) -> FloatArray:
    """What the residuals of all rows are measured in."""
    return np.where(_gaps(model), _lever(model, A), 1.0)


def _lever(model: Model, A: FloatArray) -> float:
    lever = float(np.abs(A[_gaps(model)][:, ~_lengths(model)]).max(initial=0.0))
    return lever if lever > 0 else 1.0


def _lengths(model: Model) -> IndexArray:
    units = model.mechanism.units
    return np.array([units[name] == "m" for name in model.coordinates], dtype=bool)


def _gaps(model: Model) -> IndexArray:
    units = dict((*model.mechanism.holonomic_rows, *model.mechanism.nonholonomic_rows))
    return np.array([units[label].startswith("m") for label in model.all_labels], dtype=bool)
