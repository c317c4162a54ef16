"""Programs evaluated by native code: y and t are put into a program's inputs, and its function is called.

Native code that calls programs is written once for all of them: what it needs to know of a program (where its function
and its memory are, where y and t belong) stands in structures that Python fills in.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from itertools import accumulate
from math import prod
from typing import Any

import numpy as np

from nullbody.kernels.block import Code
from nullbody.kernels.bound import group_views
from nullbody.kernels.compile import compile_text
from nullbody.kernels.kernel import Kernel
from nullbody.typing import FloatArray

__all__ = ["LANES", "Call", "Evaluation", "address", "fields", "module", "padded"]

LANES = 8  #: vectors of y, y' and so on are filled up with zeros to a multiple of this
_LINE = 64
_SIGNATURE = ctypes.PYFUNCTYPE(None, ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p)

_ROWS = ctypes.PYFUNCTYPE(
    None,
    *(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64),
    *(ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p),
)


class Call(ctypes.Structure):
    """How native code calls a program: places[k] is where y[k] belongs among the inputs, time where t (or -1)."""

    _fields_ = (
        ("function", ctypes.c_void_p),
        ("source", ctypes.c_void_p),
        ("target", ctypes.c_void_p),
        ("places", ctypes.c_void_p),
        ("count", ctypes.c_int64),
        ("time", ctypes.c_int64),
    )


class Evaluation:
    """A program with memory of its own, whose inputs are entries of y, the time, and values that stay.

    Args:
        kernel: the native function of the program.
        y: where it is evaluated when called; the caller fills it in.
        vectors: the input groups that are entries of y, one after the other from y[0].
        fixed: values of input groups that stay; what is neither is the time, one number.

    Attributes:
        source, target: all inputs and all outputs.
        inputs, outputs: a view of every group, by name.
        starts: where every output group begins in `target`.
        call: what native code needs.
    """

    def __init__(self, kernel: Kernel, y: FloatArray, vectors: Sequence[str], fixed: Mapping[str, FloatArray]) -> None:
        program = kernel.program
        sizes = dict(program.inputs)
        starts = dict(zip(sizes, accumulate(sizes.values(), initial=0), strict=False))
        self.source = np.zeros(max(1, sum(sizes.values())))
        self.inputs = group_views(self.source, program.inputs)
        for group, values in fixed.items():
            self.inputs[group][:] = values
        places = [starts[group] + k for group in vectors for k in range(sizes[group])]
        clock = [starts[group] for group in sizes if group not in vectors and group not in fixed]
        shapes = dict(program.outputs)
        ends = list(accumulate(prod(shape) for shape in shapes.values()))
        self.starts = dict(zip(shapes, [0, *ends], strict=False))
        self.target = np.zeros(max(1, sum(prod(shape) for shape in shapes.values())))
        self.outputs = group_views(self.target, program.outputs)
        self._places = np.array(places, dtype=np.int64)
        self._kernel = kernel
        self.call = Call(
            function=kernel.address,
            source=address(self.source),
            target=address(self.target),
            places=address(self._places),
            count=len(places),
            time=clock[0] if clock else -1,
        )
        self._function, self._rows, _ = _functions()
        self._kept = y
        self._arguments = ctypes.addressof(self.call), address(y)

    def __call__(self, t: float) -> None:
        """Evaluate the program at (t, y): afterwards `outputs` hold the results."""
        call, y = self._arguments
        self._function(call, t, y)

    def rows(self, t: FloatArray, y: FloatArray, output: str) -> FloatArray:
        """One output group at many times.

        Args:
            t: the times.
            y: a row for each of them.
            output: which output group.

        Returns:
            An array with the group's values at each time, times x its shape.
        """
        times, vectors = (np.ascontiguousarray(array, dtype=np.float64) for array in (t, y))
        view = self.outputs[output]
        results = np.empty((len(times), *view.shape))
        call, _ = self._arguments
        self._rows(
            call, address(times), address(vectors), vectors.shape[1], len(times), address(view), view.size,
            address(results),
        )  # fmt: skip
        return results


@cache
def _functions() -> tuple[Callable[[int, float, int], None], Callable[..., None], Code]:
    """The native functions, and what keeps them in memory."""
    code = compile_text("nb_evaluate", module(_EXPORTED))
    return _SIGNATURE(code.address), _ROWS(code.owner.get_function_address("nb_rows")), code


def address(array: Any) -> int:
    """Where an array's numbers are; whoever keeps the address keeps the array."""
    return int(array.__array_interface__["data"][0])


def padded(*shape: int) -> FloatArray:
    """Zeros whose rows are filled up to whole vectors, beginning at a line of the cache."""
    full = (*shape[:-1], -(-shape[-1] // LANES) * LANES)
    memory = np.zeros(prod(full) + LANES)
    start = -address(memory) % _LINE // memory.itemsize
    return memory[start : start + prod(full)].reshape(full)


def fields(structure: type[ctypes.Structure], base: str, **types: str) -> str:
    """Lines that load some fields of a structure, each as %name."""
    lines = []
    for name, kind in types.items():
        offset = getattr(structure, name).offset
        lines.append(f"  %{name}.at = getelementptr i8, ptr %{base}, i64 {offset}")
        lines.append(f"  %{name} = load {kind}, ptr %{name}.at")
    return "\n".join(lines)


def module(*functions: str) -> str:
    """A module with functions that evaluate programs."""
    return "\n".join([_DECLARED, _EVALUATE, *functions])


_VECTOR = f"<{LANES} x double>"
_DECLARED = f"""
declare {_VECTOR} @llvm.fabs.v{LANES}f64({_VECTOR})
declare {_VECTOR} @llvm.maxnum.v{LANES}f64({_VECTOR}, {_VECTOR})
declare double @llvm.vector.reduce.fadd.v{LANES}f64(double, {_VECTOR})
declare double @llvm.sqrt.f64(double)
declare double @llvm.fabs.f64(double)
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)
"""

#: void evaluate(Call* call, double t, double* y)
_EVALUATE = f"""
define internal void @evaluate(ptr %call, double %t, ptr %y) nounwind {{
start:
{fields(Call, "call", function="ptr", source="ptr", target="ptr", places="ptr", count="i64", time="i64")}
  %timed = icmp sge i64 %time, 0
  br i1 %timed, label %clock, label %gather
clock:
  %clock.at = getelementptr double, ptr %source, i64 %time
  store double %t, ptr %clock.at
  br label %gather
gather:
  %some = icmp sgt i64 %count, 0
  br i1 %some, label %entry, label %run
entry:
  %k = phi i64 [0, %gather], [%next, %entry]
  %from = getelementptr double, ptr %y, i64 %k
  %value = load double, ptr %from
  %place.at = getelementptr i64, ptr %places, i64 %k
  %place = load i64, ptr %place.at
  %to = getelementptr double, ptr %source, i64 %place
  store double %value, ptr %to
  %next = add i64 %k, 1
  %more = icmp slt i64 %next, %count
  br i1 %more, label %entry, label %run
run:
  call void %function(ptr %source, ptr %target)
  ret void
}}
"""

#: the same for rows of y, whose outputs from `first` are copied into rows of `width`
_EXPORTED = """
define void @nb_evaluate(ptr %call, double %t, ptr %y) nounwind {
  call void @evaluate(ptr %call, double %t, ptr %y)
  ret void
}
define void @nb_rows(ptr %call, ptr %t, ptr %y, i64 %size, i64 %rows, ptr %outputs, i64 %width, ptr %results) nounwind {
start:
  %some = icmp sgt i64 %rows, 0
  br i1 %some, label %row, label %end
row:
  %r = phi i64 [0, %start], [%r1, %copied]
  %t.at = getelementptr double, ptr %t, i64 %r
  %time = load double, ptr %t.at
  %y.offset = mul i64 %r, %size
  %y.at = getelementptr double, ptr %y, i64 %y.offset
  call void @evaluate(ptr %call, double %time, ptr %y.at)
  %offset = mul i64 %r, %width
  %result = getelementptr double, ptr %results, i64 %offset
  br label %copy
copy:
  %k = phi i64 [0, %row], [%k1, %copying]
  %left = icmp slt i64 %k, %width
  br i1 %left, label %copying, label %copied
copying:
  %from = getelementptr double, ptr %outputs, i64 %k
  %value = load double, ptr %from
  %to = getelementptr double, ptr %result, i64 %k
  store double %value, ptr %to
  %k1 = add i64 %k, 1
  br label %copy
copied:
  %r1 = add i64 %r, 1
  %more = icmp slt i64 %r1, %rows
  br i1 %more, label %row, label %end
end:
  ret void
}
"""
