"""What a call costs: of anything in Python, and of a kernel's native function, which a compiled loop calls."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from nullbody.kernels import Kernel
from nullbody.kernels.number import BLOCK
from nullbody.typing import FloatArray

__all__ = [
    "Timing",
    "Work",
    "block_seconds",
    "block_work",
    "native_function",
    "native_seconds",
    "native_work",
    "seconds_per_call",
]

_CACHE = 24_000  # bytes of input and output of a block loop: they stay in the first cache
_LOOPS = """
define void @repeat(ptr %f, ptr %in, ptr %out, i64 %stride, i64 %count, i64 %rounds) {
start:
  br label %round
round:
  %r = phi i64 [0, %start], [%r1, %done]
  br label %call
call:
  %k = phi i64 [0, %round], [%k1, %call]
  %offset = mul i64 %k, %stride
  %place = getelementptr double, ptr %in, i64 %offset
  call void %f(ptr %place, ptr %out)
  %k1 = add i64 %k, 1
  %more = icmp ult i64 %k1, %count
  br i1 %more, label %call, label %done
done:
  %r1 = add i64 %r, 1
  %again = icmp ult i64 %r1, %rounds
  br i1 %again, label %round, label %end
end:
  ret void
}

define void @repeat_blocks(ptr %f, ptr %in, ptr %out, i64 %blocks, i64 %rounds) {
start:
  br label %round
round:
  %r = phi i64 [0, %start], [%r1, %round]
  call void %f(ptr %in, ptr %out, i64 %blocks)
  %r1 = add i64 %r, 1
  %again = icmp ult i64 %r1, %rounds
  br i1 %again, label %round, label %end
end:
  ret void
}
"""


@dataclass(frozen=True)
class Timing:
    """Seconds for one call, or one state.

    Attributes:
        median: over the measurements [s].
        spread: the width of their middle half, as a part of the median.
        best: the least of them [s], for other work on the machine only ever adds; nothing where there was but one.
    """

    median: float
    spread: float
    best: float | None = None

    @classmethod
    def of(cls, seconds: Sequence[float]) -> Timing:
        """The timing that some measurements give."""
        low, middle, high = np.percentile(seconds, (25, 50, 75))
        best = float(min(seconds)) if len(seconds) > 1 else None
        return cls(float(middle), float((high - low) / middle) if middle else 0.0, best)


def seconds_per_call(run: Callable[[], object], calls: int = 1, repeats: int = 9, limit: float = 1.0) -> Timing:
    """Time a function that does something `calls` times; fewer repeats where they would exceed a limit [s].

    The first time is not counted where there are others: it pays for what is loaded and laid out on first use.
    """
    found: list[float] = []
    end = time.perf_counter() + limit
    while len(found) < repeats and (len(found) < 2 or time.perf_counter() < end):
        if found and found[0] * calls > limit:
            break
        begin = time.perf_counter()
        run()
        found.append((time.perf_counter() - begin) / calls)
    return Timing.of(found[1:] or found)


class Work(NamedTuple):
    """Something that can be done again and again.

    Attributes:
        run: does it a number of times.
        calls: how many calls, or states, are in it once.
        threads: whether other threads than the calling one work.
    """

    run: Callable[[int], object]
    calls: int = 1
    threads: bool = False


def native_work(kernel: Kernel, inputs: FloatArray) -> Work:
    """Calls of a kernel's native function by a native loop.

    Args:
        kernel: its inputs are one row of `inputs`, all groups one after the other.
        inputs: states x inputs; the loop goes over all of them, again and again.
    """
    rows = np.ascontiguousarray(inputs, dtype=np.float64)
    target = np.zeros(max(1, len(kernel.program.tape.outputs)))
    repeat = _compiled_loops().states

    def run(rounds: int) -> None:
        repeat(kernel.address, rows.ctypes.data, target.ctypes.data, rows.shape[1], len(rows), rounds)

    return Work(run, len(rows))


def block_work(kernel: Kernel, inputs: FloatArray) -> Work:
    """Calls of a kernel's native function over blocks of 8 states; arguments as `native_work`.

    The blocks are packed beforehand and few enough to stay in the cache; fewer than 8 states are repeated.
    """
    blocks, outputs = kernel.blocks(), len(kernel.program.tape.outputs)
    fitting = max(1, _CACHE // (8 * BLOCK * (inputs.shape[1] + outputs)))
    count = max(1, min(len(inputs) // BLOCK, fitting))
    packed = np.resize(inputs, (count, BLOCK, inputs.shape[1])).transpose(0, 2, 1)
    source, target = _aligned(packed.shape), _aligned((count, outputs, BLOCK))
    source[...] = packed
    repeat = _compiled_loops().blocks

    def run(rounds: int) -> None:
        repeat(blocks.address, source.ctypes.data, target.ctypes.data, count, rounds)

    return Work(run, count * BLOCK)


def native_function(address: int, first: int, second: int, owner: object) -> Callable[[int], None]:
    """A native function of two pointers, called a number of times by a native loop.

    Args:
        address: of the function.
        first, second: its arguments.
        owner: what must stay in memory as long as it is called.
    """
    repeat = _compiled_loops().states

    def run(rounds: int, owner: object = owner) -> None:
        repeat(address, first, second, 0, 1, rounds)

    return run


def native_seconds(kernel: Kernel, inputs: FloatArray, repeats: int = 9, seconds: float = 0.02) -> Timing:
    """Time of one call of a kernel's native function.

    Args:
        kernel, inputs: as `native_work`.
        repeats: measurements.
        seconds: length of each.
    """
    return _timed(native_work(kernel, inputs), repeats, seconds)


def block_seconds(kernel: Kernel, inputs: FloatArray, repeats: int = 9, seconds: float = 0.02) -> Timing:
    """Time for one state of a kernel's native function over blocks; arguments as `native_seconds`."""
    return _timed(block_work(kernel, inputs), repeats, seconds)


def _timed(work: Work, repeats: int, seconds: float) -> Timing:
    """Measurements of a length, after one that finds out how many rounds that takes."""

    def measured(rounds: int) -> float:
        begin = time.perf_counter()
        work.run(rounds)
        return (time.perf_counter() - begin) / (rounds * work.calls)

    measured(2)
    rounds = max(1, int(seconds / max(measured(3), 1e-10) / work.calls))
    return Timing.of([measured(rounds) for _ in range(repeats)])


def _aligned(shape: tuple[int, ...]) -> FloatArray:
    """Memory that begins at a line of the cache."""
    memory = np.zeros(8 * int(np.prod(shape)) + 64, np.uint8)
    start = -memory.ctypes.data % 64
    return memory[start : start + 8 * int(np.prod(shape))].view(np.float64).reshape(shape)


class _Loops(NamedTuple):
    """The loops: over (kernel, in, out, stride, states, rounds), and over (kernel, in, out, blocks, rounds)."""

    states: Any
    blocks: Any
    engine: Any  # keeps the code in memory


@cache
def _compiled_loops() -> _Loops:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine(opt=2)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(_LOOPS), machine)
    engine.finalize_object()
    pointer, number = ctypes.c_void_p, ctypes.c_int64
    states = ctypes.CFUNCTYPE(None, pointer, pointer, pointer, number, number, number)
    blocks = ctypes.CFUNCTYPE(None, pointer, pointer, pointer, number, number)
    return _Loops(
        states(engine.get_function_address("repeat")), blocks(engine.get_function_address("repeat_blocks")), engine
    )
