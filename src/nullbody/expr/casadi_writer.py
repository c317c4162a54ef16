"""Tapes as CasADi functions: the same operations on SX scalars, for CasADi's derivatives, solvers and C code."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from math import prod
from typing import Any

from nullbody.errors import InputError
from nullbody.expr.tape import Tape

__all__ = ["casadi_function"]


def casadi_function(
    name: str, tape: Tape, inputs: Sequence[tuple[str, int]], outputs: Sequence[tuple[str, tuple[int, ...]]]
) -> Any:
    """A `casadi.Function` of SX that evaluates a tape.

    Args:
        name: its name, an identifier of letters and digits, as CasADi wants it.
        tape: the operations.
        inputs: (name, size) of vectors that are the tape's inputs one after the other.
        outputs: (name, shape) of scalars, vectors or matrices, row by row the tape's outputs.

    Raises:
        InputError: CasADi is not installed, or sizes and tape do not fit.
    """
    try:
        casadi: Any = import_module("casadi")
    except ImportError:
        raise InputError("CasADi is not installed; run: python -m pip install 'nullbody[optimal]'") from None
    wanted = sum(size for _, size in inputs), sum(prod(shape) for _, shape in outputs)
    if wanted != (len(tape.inputs), len(tape.outputs)):
        raise InputError(
            f"{name}: groups of {wanted[0]} inputs and {wanted[1]} outputs do not fit a tape with "
            f"{len(tape.inputs)} and {len(tape.outputs)}"
        )
    given = [casadi.SX.sym(group, size) for group, size in inputs]
    scalars = [vector[k] for vector in given for k in range(vector.numel())]
    functions = {"sin": casadi.sin, "cos": casadi.cos, "sqrt": casadi.sqrt}
    values = iter([casadi.SX(value) for value in tape.run(scalars, functions)])
    results = [_shaped(casadi, shape, [next(values) for _ in range(prod(shape))]) for _, shape in outputs]
    return casadi.Function(name, given, results, [group for group, _ in inputs], [group for group, _ in outputs])


def _shaped(casadi: Any, shape: tuple[int, ...], entries: list[Any]) -> Any:
    """The entries, which come row by row, as a dense column or matrix; CasADi stores column by column."""
    rows, columns = (*shape, 1, 1)[:2]
    if not entries:
        return casadi.SX.zeros(rows, columns)
    return casadi.densify(casadi.reshape(casadi.vertcat(*entries), columns, rows).T)
