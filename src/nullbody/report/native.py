"""Native cost of a kernel: a compiled loop calls it over many states, so that Python's own cost does not count."""

from __future__ import annotations

import ctypes
import time
from functools import cache
from typing import Any

import numpy as np

from nullbody.kernels import Kernel
from nullbody.typing import FloatArray

__all__ = ["native_seconds"]

_LOOP = """
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
"""


def native_seconds(kernel: Kernel, inputs: FloatArray, repeats: int = 9, seconds: float = 0.02) -> float:
    """Median time of one call of a kernel's native function [s].

    Args:
        kernel: its inputs are one row of `inputs`, all groups one after the other.
        inputs: states x inputs; the loop goes over all of them, again and again.
        repeats: measurements, of which the median counts.
        seconds: length of each.
    """
    rows = np.ascontiguousarray(inputs, dtype=np.float64)
    sizes = [int(np.prod(shape)) for _, shape in kernel.program.outputs]
    target = np.zeros(max(1, sum(sizes)))
    function = ctypes.cast(kernel._function, ctypes.c_void_p)
    repeat = _repeat()

    def run(rounds: int) -> float:
        begin = time.perf_counter()
        repeat(function, rows.ctypes.data, target.ctypes.data, rows.shape[1], len(rows), rounds)
        return (time.perf_counter() - begin) / (rounds * len(rows))

    rounds = max(1, int(seconds / max(run(10), 1e-9) / len(rows)))
    return float(np.median([run(rounds) for _ in range(repeats)]))


@cache
def _repeat() -> Any:
    """The loop as a function of (kernel, in, out, stride, states, rounds)."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine(opt=2)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(_LOOP), machine)
    engine.finalize_object()
    kinds = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_int64]
    function = ctypes.CFUNCTYPE(None, *kinds)(engine.get_function_address("repeat"))
    function.engine = engine  # type: ignore[attr-defined]  # keeps the code in memory
    return function
