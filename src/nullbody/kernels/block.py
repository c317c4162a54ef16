"""A kernel over many states at once: native code on blocks of 8 states, and arrays in and out of such blocks.

In block b, input k of lane j is source[b, k, j], output k is target[b, k, j] (an array of structures of arrays:
a plain structure of arrays runs 2-3 times slower where its strides are powers of two).
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Sequence
from itertools import accumulate, pairwise
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nullbody.errors import InputError
from nullbody.kernels.number import BLOCK
from nullbody.kernels.program import Program

__all__ = ["BlockKernel", "Code", "label", "real_numbers"]

_SIGNATURE = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64)  # gives the GIL away
_CHUNK = 2**18  # bytes of input and output that are worked on at a time: they stay in the second cache
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


class _Memory(threading.local):
    """Blocks for one chunk of states; every thread sees its own (the constructor runs once in each)."""

    def __init__(self, inputs: int, outputs: int, dtype: np.dtype[Any]) -> None:
        self.blocks = max(1, _CHUNK // max(1, BLOCK * (inputs + outputs) * dtype.itemsize))
        self.source = _aligned((self.blocks, inputs, BLOCK), dtype)
        self.target = _aligned((self.blocks, outputs, BLOCK), dtype)
        self.places = self.source.ctypes.data, self.target.ctypes.data


class BlockKernel:
    """The native function of a program over blocks of 8 states; threads may call it at the same time.

    Args:
        program: what it evaluates.
        code: the function void(in, out, int64 blocks).
        dtype: float64 or float32, of all inputs, operations (sines and cosines are rounded from double) and outputs.
    """

    def __init__(self, program: Program, code: Code, dtype: np.dtype[Any]) -> None:
        self.program = program
        self.address = code.address
        self.dtype = dtype
        self._owner = code.owner
        self._function = _SIGNATURE(code.address)
        self._inputs = _spans([size for _, size in program.inputs])
        self._outputs = _spans([prod(shape) for _, shape in program.outputs])
        self._memory = _Memory(len(program.tape.inputs), len(program.tape.outputs), dtype)

    def __call__(self, *groups: ArrayLike) -> tuple[NDArray[Any], ...]:
        """Evaluate the program for many states.

        Args:
            groups: for every input group an array (states, size), or (size,) where all states share it; at least
                one of the former.

        Returns:
            For every output group a new array (states, *shape).

        Raises:
            InputError: a group is missing, has another shape, holds no real numbers, or the numbers of states differ.
        """
        arrays = self._arrays(groups)
        states = self._states(arrays)
        results = [np.empty((states, stop - start), self.dtype) for start, stop in self._outputs]
        memory = self._memory
        source, target, places, step = memory.source, memory.target, memory.places, BLOCK * memory.blocks
        used = _blocks(min(states, step))
        varying = []
        for array, (start, stop) in zip(arrays, self._inputs, strict=True):
            if array.ndim == 1:
                source[:used, start:stop] = array[:, None]
            else:
                varying.append((array, source[:, start:stop]))
        for begin in range(0, states, step):
            end = min(begin + step, states)
            for array, place in varying:
                _pack(array[begin:end], place)
            self._function(*places, _blocks(end - begin))
            for result, (start, stop) in zip(results, self._outputs, strict=True):
                _unpack(target[:, start:stop], result[begin:end])
        shapes = (shape for _, shape in self.program.outputs)
        return tuple([result.reshape(states, *shape) for result, shape in zip(results, shapes, strict=True)])

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
        """The groups as arrays of this type, (size,) or (states, size)."""
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
            arrays.append(array.astype(self.dtype, copy=False))
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


def _spans(sizes: Sequence[int]) -> list[tuple[int, int]]:
    return list(pairwise(accumulate(sizes, initial=0)))


def _blocks(states: int) -> int:
    return -(-states // BLOCK)


def _aligned(shape: tuple[int, ...], dtype: np.dtype[Any]) -> NDArray[Any]:
    """Zeros that begin at a line of the cache."""
    size = prod(shape) * dtype.itemsize
    memory = np.zeros(size + _LINE, np.uint8)
    start = -memory.ctypes.data % _LINE
    return memory[start : start + size].view(dtype).reshape(shape)


def _pack(rows: NDArray[Any], blocks: NDArray[Any]) -> None:
    """Rows (states, size) into blocks (_, size, 8); the last row fills what is left of the last block."""
    full, rest = divmod(len(rows), BLOCK)
    blocks[:full] = rows[: full * BLOCK].reshape(full, BLOCK, rows.shape[1]).transpose(0, 2, 1)
    if rest:
        blocks[full, :, :rest] = rows[full * BLOCK :].T
        blocks[full, :, rest:] = rows[-1][:, None]


def _unpack(blocks: NDArray[Any], rows: NDArray[Any]) -> None:
    """The first states of the blocks into rows."""
    full, rest = divmod(len(rows), BLOCK)
    rows[: full * BLOCK].reshape(full, BLOCK, rows.shape[1])[...] = blocks[:full].transpose(0, 2, 1)
    if rest:
        rows[full * BLOCK :] = blocks[full, :, :rest].T
