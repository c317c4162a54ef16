"""Null spaces by CasADi, expressions of scalars (SX): its solve and its nullspace; constants are floats there."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from nullbody.bench.peer.given import Given, Solved, written

__all__ = ["METHODS"]

_COUNTED = ("ADD", "SUB", "MUL", "DIV", "SQ", "TWICE", "INV", "SQRT")


def _run(method: Callable[[Any, int], Any], given: Given) -> Callable[[], Solved]:
    """Write [B | C] for CasADi; `method` takes it and the size of B to N."""
    import casadi

    names = {name: casadi.SX.sym(name) for name in given.matrix.inputs}
    functions = {"sin": casadi.sin, "cos": casadi.cos}
    entries = written(given.matrix, names.__getitem__, lambda number: casadi.SX(float(number)), functions)
    A = casadi.vertcat(*(casadi.horzcat(*row) for row in entries))

    def solve() -> Solved:
        N = method(casadi.sparsify(A), len(entries))
        inputs = casadi.vertcat(*names.values())

        def count() -> int:
            shared = casadi.Function("N", [inputs], [casadi.cse(N)])
            counted = {getattr(casadi, f"OP_{name}") for name in _COUNTED}
            return sum(shared.instruction_id(k) in counted for k in range(shared.n_instructions()))

        def value(values: Any) -> Any:
            return np.array(casadi.Function("N", [inputs], [N])(list(values)).full(), dtype=np.float64)

        return Solved(count, value)

    return solve


def _solve(A: Any, rows: int) -> Any:
    import casadi

    free = A.shape[1] - rows
    return casadi.vertcat(-casadi.solve(A[:, :rows], A[:, rows:]), casadi.SX.eye(free))


def _nullspace(A: Any, rows: int) -> Any:
    import casadi

    return casadi.nullspace(casadi.densify(A))


#: For each method: given -> the function that is timed.
METHODS: dict[str, Callable[[Given], Callable[[], Solved]]] = {
    "casadi_solve": lambda given: _run(_solve, given),
    "casadi_nullspace": lambda given: _run(_nullspace, given),
}
