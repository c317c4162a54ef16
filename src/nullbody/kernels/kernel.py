"""A kernel: a native function called with NumPy arrays."""

from __future__ import annotations

import ctypes
import threading
from math import prod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nullbody.errors import InputError
from nullbody.kernels.program import Program

__all__ = ["Kernel"]

_ARRAY = np.ndarray
_FLOAT = np.dtype(np.float64)
_SIGNATURE = ctypes.PYFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_void_p
)  # keeps the GIL: a call takes less than giving it away


class _Buffers(threading.local):
    """Input and output memory of one program; every thread sees its own (the constructor runs once in each)."""

    def __init__(self, program: Program) -> None:
        source = np.zeros(max(1, sum(size for _, size in program.inputs)))
        target = np.zeros(max(1, sum(prod(shape) for _, shape in program.outputs)))
        views, start = [], 0
        for _, size in program.inputs:
            views.append((source[start : start + size], (size,)))
            start += size
        results, start = [], 0
        for _, shape in program.outputs:
            results.append(target[start : start + prod(shape)].reshape(shape))
            start += prod(shape)
        self.memory = source, target
        self.current = views, results, source.ctypes.data, target.ctypes.data


class Kernel:
    """The native function of a program.

    Called with one vector for each input group, it returns one new array for each output group. Threads may call one
    kernel at the same time.

    Args:
        program: what it evaluates.
        address: where the native function void(double* in, double* out) is.
        owner: whatever keeps that code in memory.
    """

    def __init__(self, program: Program, address: int, owner: Any) -> None:
        self.program = program
        self._owner = owner
        self._function = _SIGNATURE(address)
        self._buffers = _Buffers(program)

    def __call__(self, *groups: ArrayLike) -> tuple[NDArray[np.float64], ...]:
        """Evaluate the program.

        Args:
            groups: for every input group a vector of its size; float64 arrays are fastest.

        Returns:
            For every output group a new array of its shape.

        Raises:
            InputError: a group is missing, has another size, or holds no real numbers.
        """
        views, results, source, target = self._buffers.current
        if len(groups) != len(views):
            raise InputError(f"kernel {self._label()} takes {len(views)} input groups, not {len(groups)}")
        for (view, shape), group in zip(views, groups):  # noqa: B905 - the lengths are equal
            if type(group) is not _ARRAY or group.dtype is not _FLOAT or group.shape != shape:
                return self(*(self._vector(k, other) for k, other in enumerate(groups)))
            view[...] = group
        self._function(source, target)
        return tuple([result.copy() for result in results])

    def __repr__(self) -> str:
        outputs = ", ".join(f"{name}{list(shape)}" for name, shape in self.program.outputs)
        return f"<Kernel {self._label()} -> {outputs}>"

    def _label(self) -> str:
        return f"{self.program.name}({', '.join(f'{name}[{size}]' for name, size in self.program.inputs)})"

    def _vector(self, index: int, group: ArrayLike) -> NDArray[np.float64]:
        """The group as a new vector of its size, or an InputError that names it."""
        name, size = self.program.inputs[index]
        try:
            array = np.asarray(group)
        except (TypeError, ValueError) as error:
            raise InputError(f"kernel {self._label()}: input {name!r} is no vector of numbers: {error}") from None
        if array.shape != (size,):
            raise InputError(f"kernel {self._label()}: input {name!r} has shape {array.shape}, not ({size},)")
        if array.size and array.dtype.kind not in "iuf":
            raise InputError(f"kernel {self._label()}: input {name!r} holds {array.dtype}, not real numbers")
        return np.array(array, dtype=_FLOAT)
