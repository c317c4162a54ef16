"""Newton's method as one native call, with steps d that a program gives: r(t, y) = 0 by y_k += d_k(t, y).

The steps end with the first one below a bound, after which quadratic convergence has reached rounding. They are made
where a matrix N(t, y) and a measure m(t, y) are small enough:  sum_k (w_k N_k)^2 < bound of the matrix,  m < its bound.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

from nullbody.kernels.block import Code
from nullbody.kernels.compile import compile_text
from nullbody.kernels.evaluation import Call, Evaluation, address, fields, module
from nullbody.typing import FloatArray

__all__ = ["CLOSING_TEXT", "Bounds", "Closing", "ClosingJob", "Part"]

_SIGNATURE = ctypes.PYFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_double)
_STEPS = 4  # at most; whoever needs more is not near the solution


class Bounds(NamedTuple):
    """Up to where Newton is tried, and when it is done.

    Attributes:
        matrix: of the weighted sum of squares.
        measure: of the measure.
        open: of |r|, below which nothing is done.
        short: of a step that is the last one.
    """

    matrix: float
    measure: float
    open: float
    short: float


class ClosingJob(ctypes.Structure):
    """What the native code needs to know."""

    _fields_ = (
        ("residual", Call),
        ("correction", Call),
        ("matrix", Call),
        ("first", ctypes.c_int64),  # r, d, N and m among the outputs of their programs
        ("count", ctypes.c_int64),
        ("step_first", ctypes.c_int64),
        ("step_count", ctypes.c_int64),
        ("matrix_first", ctypes.c_int64),
        ("matrix_count", ctypes.c_int64),
        ("measure_place", ctypes.c_int64),
        ("weights", ctypes.c_void_p),
        ("y", ctypes.c_void_p),
        ("matrix_bound", ctypes.c_double),
        ("measure_bound", ctypes.c_double),
        ("open", ctypes.c_double),
        ("short", ctypes.c_double),
        ("before", ctypes.c_double),  # results: the largest |r| before and after, and the sum
        ("after", ctypes.c_double),
        ("sum", ctypes.c_double),
    )


@dataclass(frozen=True)
class Part:
    """An output group of a program."""

    program: Evaluation
    output: str

    @property
    def first(self) -> int:
        """Where it begins among the outputs."""
        return self.program.starts[self.output]

    @property
    def count(self) -> int:
        """How many numbers it has."""
        return int(self.program.outputs[self.output].size)


class Closing:
    """Newton's method for some programs at y. Not for several threads at a time.

    Args:
        y: where to begin and where it ends; the caller fills it in.
        residual: what is to vanish.
        correction: the step, for y[0], y[1], ...
        matrix, weights: N and w.
        measure: m, an output of the matrix' program.
        bounds: up to where Newton is tried, and when it is done.
    """

    def __init__(
        self,
        y: FloatArray,
        residual: Part,
        correction: Part,
        matrix: Part,
        weights: FloatArray,
        measure: str,
        bounds: Bounds,
    ) -> None:
        self._function, _ = _functions()
        self._weights = np.ascontiguousarray(weights, dtype=np.float64)
        self._kept = residual, correction, matrix, y
        self.job = ClosingJob(
            residual=residual.program.call,
            correction=correction.program.call,
            matrix=matrix.program.call,
            first=residual.first,
            count=residual.count,
            step_first=correction.first,
            step_count=correction.count,
            matrix_first=matrix.first,
            matrix_count=matrix.count,
            measure_place=matrix.program.starts[measure],
            weights=address(self._weights),
            y=address(y),
            matrix_bound=bounds.matrix,
            measure_bound=bounds.measure,
            open=bounds.open,
            short=bounds.short,
        )
        self._address = ctypes.addressof(self.job)

    def __call__(self, t: float) -> int:
        """Make |r| small; returns how many steps that took. What is not finite is left as it is."""
        return int(self._function(self._address, t))

    @property
    def results(self) -> tuple[float, float, float]:
        """The largest |r| before and after, and the weighted sum of squares of the matrix before."""
        job = self.job
        return job.before, job.after, job.sum


@cache
def _functions() -> tuple[Callable[[int, float], int], Code]:
    """The native function, and what keeps it in memory."""
    code = compile_text("nb_close", module(CLOSING_TEXT))
    return _SIGNATURE(code.address), code


_LARGEST = """
define internal double @largest(ptr %values, i64 %count) nounwind {
start:
  %some = icmp sgt i64 %count, 0
  br i1 %some, label %next, label %none
none:
  ret double 0.0
next:
  %k = phi i64 [0, %start], [%k1, %next]
  %so.far = phi double [0.0, %start], [%larger, %next]
  %bad = phi double [0.0, %start], [%sum, %next]
  %at = getelementptr double, ptr %values, i64 %k
  %value = load double, ptr %at
  %size = call double @llvm.fabs.f64(double %value)
  %more = fcmp ogt double %size, %so.far
  %larger = select i1 %more, double %size, double %so.far
  %zero = fmul double %value, 0.0
  %sum = fadd double %bad, %zero
  %k1 = add i64 %k, 1
  %left = icmp slt i64 %k1, %count
  br i1 %left, label %next, label %end
end:
  %result = fadd double %larger, %sum
  ret double %result
}
"""

CLOSING_TEXT = f"""
{_LARGEST}
define internal double @residual(ptr %job, double %t) nounwind {{
{fields(ClosingJob, "job", first="i64", count="i64", y="ptr")}
{fields(Call, "job", target="ptr")}
  call void @evaluate(ptr %job, double %t, ptr %y)
  %r = getelementptr double, ptr %target, i64 %first
  %result = call double @largest(ptr %r, i64 %count)
  ret double %result
}}
define internal i1 @regular(ptr %job, double %t) nounwind {{
start:
{fields(ClosingJob, "job", matrix_first="i64", matrix_count="i64", measure_place="i64", weights="ptr", y="ptr")}
{fields(ClosingJob, "job", matrix_bound="double", measure_bound="double")}
  %matrix = getelementptr i8, ptr %job, i64 {ClosingJob.matrix.offset}
{fields(Call, "matrix", target="ptr")}
  call void @evaluate(ptr %matrix, double %t, ptr %y)
  %N = getelementptr double, ptr %target, i64 %matrix_first
  %some = icmp sgt i64 %matrix_count, 0
  br i1 %some, label %next, label %end
next:
  %k = phi i64 [0, %start], [%k1, %next]
  %before = phi double [0.0, %start], [%after, %next]
  %N.at = getelementptr double, ptr %N, i64 %k
  %value = load double, ptr %N.at
  %w.at = getelementptr double, ptr %weights, i64 %k
  %weight = load double, ptr %w.at
  %scaled = fmul double %value, %weight
  %square = fmul contract double %scaled, %scaled
  %after = fadd contract double %before, %square
  %k1 = add i64 %k, 1
  %left = icmp slt i64 %k1, %matrix_count
  br i1 %left, label %next, label %end
end:
  %sum = phi double [0.0, %start], [%after, %next]
  %sum.at = getelementptr i8, ptr %job, i64 {ClosingJob.sum.offset}
  store double %sum, ptr %sum.at
  %measure.at = getelementptr double, ptr %target, i64 %measure_place
  %measure = load double, ptr %measure.at
  %small = fcmp olt double %sum, %matrix_bound
  %certain = fcmp olt double %measure, %measure_bound
  %both = and i1 %small, %certain
  ret i1 %both
}}
define i64 @nb_close(ptr %job, double %t) nounwind {{
start:
{fields(ClosingJob, "job", step_first="i64", step_count="i64", y="ptr", short="double", open="double")}
  %correction = getelementptr i8, ptr %job, i64 {ClosingJob.correction.offset}
{fields(Call, "correction", target="ptr")}
  %d = getelementptr double, ptr %target, i64 %step_first
  %before.at = getelementptr i8, ptr %job, i64 {ClosingJob.before.offset}
  %after.at = getelementptr i8, ptr %job, i64 {ClosingJob.after.offset}
  %before = call double @residual(ptr %job, double %t)
  store double %before, ptr %before.at
  store double %before, ptr %after.at
  %regular = call i1 @regular(ptr %job, double %t)
  %gaps = fcmp ogt double %before, %open
  %worth = and i1 %regular, %gaps
  br i1 %worth, label %step, label %end
step:
  %s = phi i64 [0, %start], [%s1, %landed]
  %s1 = add i64 %s, 1
  call void @evaluate(ptr %correction, double %t, ptr %y)
  br label %move
move:
  %k = phi i64 [0, %step], [%k1, %move]
  %d.at = getelementptr double, ptr %d, i64 %k
  %change = load double, ptr %d.at
  %yk.at = getelementptr double, ptr %y, i64 %k
  %from = load double, ptr %yk.at
  %to = fadd double %from, %change
  store double %to, ptr %yk.at
  %k1 = add i64 %k, 1
  %left = icmp slt i64 %k1, %step_count
  br i1 %left, label %move, label %landed
landed:
  %length = call double @largest(ptr %d, i64 %step_count)
  %after = call double @residual(ptr %job, double %t)
  store double %after, ptr %after.at
  %long = fcmp ogt double %length, %short
  %few = icmp slt i64 %s1, {_STEPS}
  %again = and i1 %long, %few
  br i1 %again, label %step, label %end
end:
  %steps = phi i64 [0, %start], [%s1, %landed]
  ret i64 %steps
}}
"""
