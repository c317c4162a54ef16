"""A kernel over many states at once: native code on blocks of 8 states, and arrays in and out of such blocks.

In block b, input k of lane j is source[b, k, j], output k is target[b, k, j] (an array of structures of arrays:
a plain structure of arrays runs 2-3 times slower where its strides are powers of two). Arrays with a row for each state
are turned into blocks and back by native code, one block at a time (`rows`).
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Sequence
from itertools import chain
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nullbody.errors import InputError
from nullbody.kernels.number import BLOCK, Number
from nullbody.kernels.program import Program
from nullbody.kernels.rows import ROOM
from nullbody.kernels.threads import shared_out, thread_count

__all__ = ["BlockKernel", "Code", "aligned", "label", "real_numbers"]

_BLOCKS = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64)  # gives the GIL away
_ROWS = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 4, *[ctypes.c_int64] * 2)
_FLOAT = np.dtype(np.float64)
_GRAIN = 256  # blocks that a thread takes at a time: some tenths of a millisecond
_LINE = 64


class Code(NamedTuple):
    """A native function: its address, and whatever keeps it in memory."""

    address: int
    owner: Any


def label(program: Program) -> str:
    """A program with its inputs, for messages: f(x[5], y[2])."""
    return f"{program.name}({', '.join(f'{name}[{size}]' for name, size in program.inputs)})"


def real_numbers(program: Program, index: int, group: ArrayLike) -> NDArray[Any]:
    """An input group as an array of any shape, or an InputError that names it."""
    name = program.inputs[index][0]
    try:
        array = np.asarray(group)
    except (TypeError, ValueError) as error:
        raise InputError(f"kernel {label(program)}: input {name!r} is no array of numbers: {error}") from None
    if array.size and array.dtype.kind not in "iuf":
        raise InputError(f"kernel {label(program)}: input {name!r} holds {array.dtype}, not real numbers")
    return array


def aligned(shape: tuple[int, ...], dtype: np.dtype[Any]) -> NDArray[Any]:
    """Zeros that begin at a line of the cache."""
    size = prod(shape) * dtype.itemsize
    memory = np.zeros(size + _LINE, np.uint8)
    start = -memory.ctypes.data % _LINE
    return memory[start : start + size].view(dtype).reshape(shape)


class _Memory(threading.local):
    """One block of inputs and one of outputs; every thread sees its own (the constructor runs once in each)."""

    def __init__(self, inputs: int, outputs: int, dtype: np.dtype[Any]) -> None:
        self.arrays = [aligned((size + ROOM, BLOCK), dtype) for size in (inputs, outputs)]
        self.places = tuple(array.ctypes.data for array in self.arrays)


class BlockKernel:
    """The native function of a program over blocks of 8 states; threads may call it at the same time.

    Args:
        program: what it evaluates.
        code: the function void(in, out, int64 blocks).
        dtype: float64 or float32, of all inputs, operations (sines and cosines are rounded from double) and outputs.
    """

    def __init__(self, program: Program, code: Code, dtype: np.dtype[Any] = _FLOAT) -> None:
        from nullbody.kernels.compile import compile_text
        from nullbody.kernels.rows import rows_ir, rows_name

        self.program = program
        self.address = code.address
        self.dtype = dtype
        number = Number(BLOCK, 8 * dtype.itemsize)
        rows = compile_text(rows_name(number), rows_ir(number))
        self._owners = code.owner, rows.owner
        self._function, self._rows = _BLOCKS(code.address), _ROWS(rows.address)
        self._sizes = [prod(shape) for _, shape in program.outputs]
        self._memory = _Memory(len(program.tape.inputs), len(program.tape.outputs), dtype)

    def __call__(
        self, *groups: ArrayLike, out: Sequence[NDArray[Any]] | None = None, threads: int | None = None
    ) -> tuple[NDArray[Any], ...]:
        """Evaluate the program for many states.

        Args:
            groups: for every input group an array (states, size), or (size,) where all states share it; at least
                one of the former. Arrays of this type whose rows are contiguous are read where they are.
            out: for every output group a contiguous array (states, *shape) of this type to write to; new ones by
                default.
            threads: how many work at the same time; all cores that the process may use by default.

        Returns:
            For every output group an array (states, *shape): `out` where it is given.

        Raises:
            InputError: a group is missing, has another shape, holds no real numbers, or the numbers of states differ;
                an array of `out` has another shape or type, is not contiguous or shares memory with an input.
        """
        arrays = self._arrays(groups)
        states = self._states(arrays)
        workers = thread_count(threads)
        results = self._results(states) if out is None else self._given(out, states)
        groups_in = [(array.ctypes.data, _stride(array), array.shape[-1]) for array in arrays]
        groups_out = [(r.ctypes.data, size * r.itemsize, size) for r, size in zip(results, self._sizes, strict=True)]
        if out is not None:
            self._apart(states, groups_in, groups_out)
        job = np.array([states, len(arrays), len(results), *chain(*groups_in, *groups_out)], dtype=np.int64)
        code, place = self.address, job.ctypes.data

        def work(begin: int, end: int) -> None:
            self._rows(code, place, *self._memory.places, begin, end)

        shared_out(work, -(-states // BLOCK), workers, _GRAIN)
        return tuple(results)

    def run(self, source: NDArray[Any], target: NDArray[Any]) -> None:
        """Evaluate the program on blocks, without copies.

        Args:
            source: (blocks, inputs, 8), all input groups one after the other; fastest where aligned to 64 bytes.
            target: (blocks, outputs, 8), is overwritten.

        Raises:
            InputError: an array has another shape or type, is not contiguous, or they share memory.
        """
        tape = self.program.tape
        blocks = source.shape[0] if source.ndim else 0
        for name, array, size in (("source", source, len(tape.inputs)), ("target", target, len(tape.outputs))):
            usable = array.flags.c_contiguous and array.flags.aligned and (name == "source" or array.flags.writeable)
            if array.shape != (blocks, size, BLOCK) or array.dtype != self.dtype or not usable:
                raise InputError(
                    f"kernel {label(self.program)}: {name} is a {array.dtype} array {array.shape}; it must be a "
                    f"contiguous {self.dtype} array ({blocks} blocks, {size}, {BLOCK}), the target a writeable one"
                )
        if np.may_share_memory(source, target):
            raise InputError(f"kernel {label(self.program)}: source and target share memory; use two arrays")
        self._function(source.ctypes.data, target.ctypes.data, blocks)

    def _arrays(self, groups: Sequence[ArrayLike]) -> list[NDArray[Any]]:
        """The groups as arrays of this type, (size,) or (states, size), each row contiguous."""
        program, arrays = self.program, []
        if len(groups) != len(program.inputs):
            raise InputError(f"kernel {label(program)} takes {len(program.inputs)} input groups, not {len(groups)}")
        for k, (name, size) in enumerate(program.inputs):
            array = real_numbers(program, k, groups[k])
            if array.ndim not in (1, 2) or array.shape[-1] != size:
                raise InputError(
                    f"kernel {label(program)}: input {name!r} has shape {array.shape}, "
                    f"not (states, {size}) or ({size},)"
                )
            array = array.astype(self.dtype, copy=False)
            direct = array.flags.aligned and (size < 2 or array.strides[-1] == array.itemsize)
            arrays.append(array if direct else np.ascontiguousarray(array))
        return arrays

    def _states(self, arrays: Sequence[NDArray[Any]]) -> int:
        """How many states there are."""
        inputs = zip(self.program.inputs, arrays, strict=True)
        counts = {name: len(array) for (name, _), array in inputs if array.ndim == 2}
        if not counts:
            raise InputError(
                f"kernel {label(self.program)}: no input has the shape (states, size), so their number is unknown; "
                "call the kernel itself for one state"
            )
        if len(set(counts.values())) > 1:
            listed = ", ".join(f"{name!r} {count}" for name, count in counts.items())
            raise InputError(f"kernel {label(self.program)}: the inputs have different numbers of states: {listed}")
        return next(iter(counts.values()))

    def _results(self, states: int) -> list[NDArray[Any]]:
        """New arrays to write to."""
        return [np.empty((states, *shape), self.dtype) for _, shape in self.program.outputs]

    def _given(self, out: Sequence[NDArray[Any]], states: int) -> list[NDArray[Any]]:
        """The arrays to write to, checked."""
        results = list(out)
        if len(results) != len(self._sizes):
            raise InputError(f"kernel {label(self.program)}: out has {len(results)} arrays, not {len(self._sizes)}")
        for (name, shape), result in zip(self.program.outputs, results, strict=True):
            whole = (states, *shape)
            if type(result) is not np.ndarray or result.shape != whole or result.dtype != self.dtype:
                raise InputError(f"kernel {label(self.program)}: out for {name!r} must be a {self.dtype} array {whole}")
            if not (result.flags.c_contiguous and result.flags.aligned and result.flags.writeable):
                raise InputError(f"kernel {label(self.program)}: out for {name!r} must be contiguous and writeable")
        return results

    def _apart(self, states: int, groups_in: Sequence[_Place], groups_out: Sequence[_Place]) -> None:
        """Raise where an array to write to shares memory with another one."""
        spans = [_span(place, states, self.dtype.itemsize) for place in (*groups_in, *groups_out)]
        for k, (name, _) in enumerate(self.program.outputs, len(groups_in)):
            low, high = spans[k]
            if any(low < end and begin < high for begin, end in spans[:k]):
                raise InputError(f"kernel {label(self.program)}: out for {name!r} shares memory with another array")


#: Where a group is: its address, the bytes from row to row (0: one row for all states), its size.
_Place = tuple[int, int, int]


def _stride(array: NDArray[Any]) -> int:
    return array.strides[0] if array.ndim == 2 else 0


def _span(place: _Place, states: int, itemsize: int) -> tuple[int, int]:
    """The first and last byte of a group, the last one not included."""
    address, stride, size = place
    if not size or not states:
        return address, address
    reach = (states - 1) * stride
    return address + min(0, reach), address + max(0, reach) + size * itemsize
