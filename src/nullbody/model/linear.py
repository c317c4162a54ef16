"""The exact Jacobian of the state's rate, for implicit integration: from the graph, compiled when first asked for."""

from __future__ import annotations

import numpy as np

from nullbody.model.chart import Key
from nullbody.model.jacobian_programs import jacobian_kernel
from nullbody.model.model import Model
from nullbody.typing import FloatArray

__all__ = ["rate_jacobian"]


def rate_jacobian(model: Model, q: FloatArray, v: FloatArray, u: FloatArray, t: float = 0.0) -> FloatArray:
    """d(q', v', power)/d(q, v) at constant inputs, (nq + nv + 1) x (nq + nv), without any check."""
    kernel = jacobian_kernel(Key(model.mechanism), model.independent, model.labels, "rate_power", False)
    groups = (q, v, u, np.array([t])) if model.rheonomic else (q, v, u)
    return kernel(*groups, np.array(model.values))[0]
