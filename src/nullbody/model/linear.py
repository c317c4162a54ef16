"""The exact Jacobian of the state's rate, for implicit integration: from the graph, compiled when first asked for."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from nullbody.equations import derive, flat
from nullbody.expr import Tape, jacobian
from nullbody.kernels import Kernel, Program, compile_programs
from nullbody.model.chart import Key
from nullbody.model.model import Model
from nullbody.typing import FloatArray

__all__ = ["rate_jacobian"]

_KEPT = 16  # Jacobians in memory


def rate_jacobian(model: Model, q: FloatArray, v: FloatArray, u: FloatArray, t: float = 0.0) -> FloatArray:
    """d(q', v', power)/d(q, v) at constant inputs, (nq + nv + 1) x (nq + nv), without any check."""
    kernel = _compiled(Key(model.mechanism), model.independent, model.labels)
    size = len(q) + len(v)
    groups = (q, v, u, np.array([t])) if model.rheonomic else (q, v, u)
    found: FloatArray = kernel(*groups, np.array(model.values))[0].reshape(size + 1, size)
    return found


@lru_cache(maxsize=_KEPT)
def _compiled(key: Key, independent: tuple[str, ...], labels: tuple[str, ...]) -> Kernel:
    """The kernel, by forward differentiation of the routine forward_dynamics."""
    equations = derive(key.mechanism, independent, rows=labels)
    outputs = equations.routines["forward_dynamics"].outputs
    places = [equations.coordinates.index(name) for name in independent]
    rates = [*outputs["q_dot"], *(outputs["q_ddot"][k] for k in places), outputs["power"]]
    symbols = [equations.graph.symbol(name) for group in ("q", "v") for name in equations.groups[group]]
    rows = jacobian(rates, symbols)
    groups = ["q", "v", "u", *(["t"] if equations.groups["t"] else []), "p"]
    program = Program(
        name="rate_jacobian",
        inputs=tuple((group, len(equations.groups[group])) for group in groups),
        outputs=(("J", (len(rates), len(symbols))),),
        tape=Tape.of(list(flat(rows)), [name for group in groups for name in equations.groups[group]]),
    )
    return compile_programs([program]).kernels["rate_jacobian"]
