"""A kernel: a native function called with NumPy arrays."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable, Sequence
from math import prod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from nullbody.errors import InputError
from nullbody.kernels.block import BlockKernel, Code, label, real_numbers
from nullbody.kernels.bound import BoundKernel, group_views
from nullbody.kernels.compose import part
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
        source, target = np.zeros(max(1, len(program.tape.inputs))), np.zeros(max(1, len(program.tape.outputs)))
        views = [(view, view.shape) for view in group_views(source, program.inputs).values()]
        self.memory = source
        self.current = views, target, source.ctypes.data, target.ctypes.data


def _spans(program: Program) -> tuple[tuple[Any, tuple[int, ...] | None], ...]:
    """For every output group its place in all outputs, and the shape of a matrix."""
    spans: list[tuple[Any, tuple[int, ...] | None]] = []
    start = 0
    for _, shape in program.outputs:
        end = start + prod(shape)
        spans.append((slice(start, end), shape if len(shape) > 1 else None) if shape else (start, None))
        start = end
    return tuple(spans)


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
        function: the native function, to be called with two addresses.
    """

    def __init__(self, program: Program, code: Code, wide: Callable[[int], Code]) -> None:
        self.program = program
        self.address = code.address
        self._owner = code.owner
        self.function = _SIGNATURE(code.address)
        self._buffers = _Buffers(program)
        self._spans = _spans(program)
        self._wide = wide
        self._blocks: dict[tuple[np.dtype[Any], tuple[str, ...] | None], BlockKernel] = {}
        self._compiling = threading.Lock()

    def __call__(self, *groups: ArrayLike) -> tuple[NDArray[np.float64], ...]:
        """Evaluate the program.

        Args:
            groups: for every input group a vector of its size; float64 arrays are fastest.

        Returns:
            For every output group an array of its shape, or a number; new ones, parts of one piece of memory.

        Raises:
            InputError: a group is missing, has another size, or holds no real numbers.
        """
        views, target, source, place = self._buffers.current
        if len(groups) != len(views):
            raise InputError(f"kernel {label(self.program)} takes {len(views)} input groups, not {len(groups)}")
        for (view, shape), group in zip(views, groups):  # noqa: B905 - the lengths are equal
            if type(group) is not _ARRAY or group.dtype is not _FLOAT or group.shape != shape:
                return self(*(self._vector(k, other) for k, other in enumerate(groups)))
            view[...] = group
        self.function(source, place)
        results = target.copy()
        return tuple([results[span] if shape is None else results[span].reshape(shape) for span, shape in self._spans])

    def bound(self) -> BoundKernel:
        """The kernel with memory of its own: a call copies the inputs that it is given, and allocates no arrays."""
        return BoundKernel(self)

    def batch(
        self,
        *groups: ArrayLike,
        dtype: DTypeLike = np.float64,
        out: Sequence[NDArray[Any]] | None = None,
        threads: int | None = None,
    ) -> tuple[NDArray[Any], ...]:
        """Evaluate the program for many states, 8 at a time; the GIL is free meanwhile.

        Args:
            groups: for every input group an array (states, size), or (size,) where all states share it (parameters);
                at least one of the former. Arrays of this type with contiguous rows are read where they are.
            dtype: float64, with the bits of single calls; or float32, which takes half the memory and time: every
                operation is rounded to 6e-8, so that results lose what the program's cancellations lose.
            out: for every output group a contiguous array (states, *shape) of this type to write to.
            threads: how many work at the same time; all cores that the process may use by default.

        Returns:
            For every output group an array (states, *shape): new ones, or those of `out`.

        Raises:
            InputError: a group is missing, has another shape, holds no real numbers, or the numbers of states differ;
                an array of `out` does not fit.
            CacheError: code for batches is compiled at the first call, and the cache cannot be used.
        """
        return self.blocks(dtype)(*groups, out=out, threads=threads)

    def blocks(self, dtype: DTypeLike = np.float64, outputs: Sequence[str] | None = None) -> BlockKernel:
        """The function over blocks of 8 states, compiled at the first call unless the library holds it.

        Args:
            dtype: float64 or float32.
            outputs: the groups that are wanted, in that order: what only others need is not evaluated; all by default.

        Raises:
            InputError: dtype is neither float64 nor float32.
            UnknownName: an output group does not exist.
            CacheError: the cache cannot be read, written or trusted.
        """
        kind = np.dtype(dtype)
        if kind not in _BITS:
            raise InputError(f"kernel {label(self.program)}: batches are float64 or float32, not {kind}")
        key = kind, None if outputs is None else tuple(outputs)
        with self._compiling:
            if key not in self._blocks:
                self._blocks[key] = self._compiled(*key)
            return self._blocks[key]

    def _compiled(self, kind: np.dtype[Any], outputs: tuple[str, ...] | None) -> BlockKernel:
        if outputs is None:
            return BlockKernel(self.program, self._wide(_BITS[kind]), kind)
        from nullbody.kernels.compile import compile_blocks

        program = part(self.program, outputs)
        return BlockKernel(program, compile_blocks(program, _BITS[kind]), kind)

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
