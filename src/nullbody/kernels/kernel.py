"""A kernel: a native function called with NumPy arrays."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable
from math import prod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from nullbody.errors import InputError
from nullbody.kernels.block import BlockKernel, Code, label, real_numbers
from nullbody.kernels.program import Program

__all__ = ["Kernel"]

_ARRAY = np.ndarray
_FLOAT = np.dtype(np.float64)
_BITS = {np.dtype(np.float64): 64, np.dtype(np.float32): 32}
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

    Called with one vector for each input group, it returns one new array for each output group; `batch` does that for
    many states. Threads may call one kernel at the same time.

    Args:
        program: what it evaluates.
        code: the native function void(double* in, double* out).
        wide: gives the function over blocks of 8 states, of numbers with 64 or 32 bits.

    Attributes:
        address: where the native function is; its code lives as long as the kernel.
    """

    def __init__(self, program: Program, code: Code, wide: Callable[[int], Code]) -> None:
        self.program = program
        self.address = code.address
        self._owner = code.owner
        self._function = _SIGNATURE(code.address)
        self._buffers = _Buffers(program)
        self._wide = wide
        self._blocks: dict[np.dtype[Any], BlockKernel] = {}
        self._compiling = threading.Lock()

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
            raise InputError(f"kernel {label(self.program)} takes {len(views)} input groups, not {len(groups)}")
        for (view, shape), group in zip(views, groups):  # noqa: B905 - the lengths are equal
            if type(group) is not _ARRAY or group.dtype is not _FLOAT or group.shape != shape:
                return self(*(self._vector(k, other) for k, other in enumerate(groups)))
            view[...] = group
        self._function(source, target)
        return tuple([result.copy() for result in results])

    def batch(self, *groups: ArrayLike, dtype: DTypeLike = np.float64) -> tuple[NDArray[Any], ...]:
        """Evaluate the program for many states, 8 at a time; the GIL is free meanwhile.

        Args:
            groups: for every input group an array (states, size), or (size,) where all states share it (parameters);
                at least one of the former.
            dtype: float64, with the results of single calls; or float32, which takes half the memory and time: every
                operation is rounded to 6e-8, so that results lose what the program's cancellations lose.

        Returns:
            For every output group a new array (states, *shape).

        Raises:
            InputError: a group is missing, has another shape, holds no real numbers, or the numbers of states differ.
            CacheError: code for batches is compiled at the first call, and the cache cannot be used.
        """
        return self.blocks(dtype)(*groups)

    def blocks(self, dtype: DTypeLike = np.float64) -> BlockKernel:
        """The function over blocks of 8 states, compiled at the first call unless the library holds it.

        Raises:
            InputError: dtype is neither float64 nor float32.
            CacheError: the cache cannot be read, written or trusted.
        """
        kind = np.dtype(dtype)
        if kind not in _BITS:
            raise InputError(f"kernel {label(self.program)}: batches are float64 or float32, not {kind}")
        with self._compiling:
            if kind not in self._blocks:
                self._blocks[kind] = BlockKernel(self.program, self._wide(_BITS[kind]), kind)
            return self._blocks[kind]

    def __repr__(self) -> str:
        outputs = ", ".join(f"{name}{list(shape)}" for name, shape in self.program.outputs)
        return f"<Kernel {label(self.program)} -> {outputs}>"

    def _vector(self, index: int, group: ArrayLike) -> NDArray[np.float64]:
        """The group as a new vector of its size, or an InputError that names it."""
        name, size = self.program.inputs[index]
        array = real_numbers(self.program, index, group)
        if array.shape != (size,):
            raise InputError(f"kernel {label(self.program)}: input {name!r} has shape {array.shape}, not ({size},)")
        return np.array(array, dtype=_FLOAT)
