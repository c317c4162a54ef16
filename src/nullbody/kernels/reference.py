"""The NumPy reference of every kernel: the tape's own interpreter, for one state or a batch of them."""

from __future__ import annotations

from math import prod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nullbody.errors import InputError
from nullbody.kernels.program import Program

__all__ = ["FUNCTIONS", "interpret"]

#: The functions with which a tape runs on arrays.
FUNCTIONS = {"sin": np.sin, "cos": np.cos, "sqrt": np.sqrt}


def interpret(program: Program, *groups: ArrayLike) -> tuple[NDArray[np.float64], ...]:
    """Run a program with NumPy, operation by operation.

    Args:
        program: the program.
        groups: for every input group an array (..., size); the leading axes (a batch) broadcast.

    Returns:
        For every output group an array (..., *shape). Division by zero gives inf or nan, as in native code.

    Raises:
        InputError: the number of groups or the size of one is wrong.
    """
    arrays = [np.asarray(group, dtype=np.float64) for group in groups]
    if len(arrays) != len(program.inputs):
        raise InputError(f"program {program.name!r} takes {len(program.inputs)} input groups, not {len(arrays)}")
    for (name, size), array in zip(program.inputs, arrays, strict=True):
        if array.ndim == 0 or array.shape[-1] != size:
            raise InputError(
                f"program {program.name!r}: input {name!r} has shape {array.shape}; its last axis must be {size}"
            )
    batch = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
    inputs: list[Any] = [array[..., k] for array in arrays for k in range(array.shape[-1])]
    with np.errstate(all="ignore"):
        values = program.tape.run(inputs, FUNCTIONS)
    flat = np.empty((*batch, len(values)))
    for k, value in enumerate(values):
        flat[..., k] = value
    results, start = [], 0
    for _, shape in program.outputs:
        results.append(flat[..., start : start + prod(shape)].reshape((*batch, *shape)))
        start += prod(shape)
    return tuple(results)
