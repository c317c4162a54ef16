"""The native code of one attempt of an explicit Runge-Kutta method, as LLVM IR.

It knows the method's coefficients and no program: what it needs to know of one stands in a `Job`. Vectors are worked on
as a whole, filled up with zeros; each evaluation of y' is a call of the program's own function.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from nullbody.kernels.evaluation import LANES, Call, fields
from nullbody.kernels.number import Number

__all__ = ["Guard", "Job", "Tableau", "attempt_text"]

_NUMBER = Number(LANES)
_VECTOR = _NUMBER.text
_BYTES = 8 * LANES


@dataclass(frozen=True)
class Tableau:
    """An explicit method whose last stage is the first one of the next step, with two error estimates.

    Attributes:
        A, C: coefficients of the stages, s x s and s; the first row is zero.
        B: of y1, s.
        E5, E3: of the error estimates, s + 1.
        A_more, C_more: of stages for dense output, m x (s + 1 + m) and m.
    """

    A: tuple[tuple[float, ...], ...]
    B: tuple[float, ...]
    C: tuple[float, ...]
    E5: tuple[float, ...]
    E3: tuple[float, ...]
    A_more: tuple[tuple[float, ...], ...]
    C_more: tuple[float, ...]

    @property
    def stages(self) -> int:
        """How many there are, with the one that the next step begins with."""
        return len(self.B) + 1


class Guard(ctypes.Structure):
    """`count` outputs of the program, from place `first`, that must lie strictly between two numbers."""

    _fields_ = (
        ("first", ctypes.c_int64),
        ("count", ctypes.c_int64),
        ("low", ctypes.c_double),
        ("high", ctypes.c_double),
    )


class Job(ctypes.Structure):
    """What the native code needs to know."""

    _fields_ = (
        ("call", Call),
        ("places", ctypes.c_void_p),  # of y' among the program's outputs
        ("size", ctypes.c_int64),  # of y
        ("vectors", ctypes.c_int64),  # that hold y
        ("guards", ctypes.c_void_p),
        ("guard_count", ctypes.c_int64),
        ("rtol", ctypes.c_double),
        ("atol", ctypes.c_double),
        ("y", ctypes.c_void_p),
        ("stages", ctypes.c_void_p),  # k_1, k_2, ... one after the other
        ("inner", ctypes.c_void_p),  # y within a step
        ("y1", ctypes.c_void_p),
        ("error", ctypes.c_double),
    )


@cache
def attempt_text(tableau: Tableau) -> str:
    """All functions of a method: nb_rate, nb_attempt, nb_more."""
    sums = [_sum(f"inner{s}", row) for s, row in enumerate(tableau.A) if s]
    sums += [_sum("last", tableau.B)]
    sums += [_sum(f"inner{tableau.stages + k}", row) for k, row in enumerate(tableau.A_more)]
    return "\n".join([_RATE, *sums, _error(tableau), _attempt(tableau), _more(tableau), _FIRST])


#: i64 rate(Job* job, double t, double* y, double* f): 0, the number of the guard that does not hold, or -1
_RATE = f"""
define internal i64 @finite(ptr %y, i64 %vectors) nounwind {{
start:
  br label %next
next:
  %k = phi i64 [0, %start], [%k1, %next]
  %seen = phi {_VECTOR} [zeroinitializer, %start], [%sum, %next]
  %offset = mul i64 %k, {_BYTES}
  %at = getelementptr i8, ptr %y, i64 %offset
  %value = load {_VECTOR}, ptr %at, align 8
  %none = fmul {_VECTOR} %value, zeroinitializer
  %sum = fadd {_VECTOR} %seen, %none
  %k1 = add i64 %k, 1
  %more = icmp slt i64 %k1, %vectors
  br i1 %more, label %next, label %end
end:
  %zero = call double @llvm.vector.reduce.fadd.v{LANES}f64(double 0.0, {_VECTOR} %sum)
  %good = fcmp oeq double %zero, 0.0
  %result = select i1 %good, i64 0, i64 -1
  ret i64 %result
}}
define internal i64 @rate(ptr %job, double %t, ptr %y, ptr %f) nounwind {{
start:
{fields(Job, "job", places="ptr", size="i64", vectors="i64", guards="ptr", guard_count="i64")}
{fields(Call, "job", target="ptr")}
  %bad = call i64 @finite(ptr %y, i64 %vectors)
  %no = icmp ne i64 %bad, 0
  br i1 %no, label %refused, label %run
refused:
  ret i64 %bad
run:
  call void @evaluate(ptr %job, double %t, ptr %y)
  br label %guard
guard:
  %g = phi i64 [0, %run], [%g1, %within]
  %left = icmp slt i64 %g, %guard_count
  br i1 %left, label %check, label %scatter
check:
  %guard.at = getelementptr [4 x i64], ptr %guards, i64 %g
  %first = load i64, ptr %guard.at
  %count.at = getelementptr i64, ptr %guard.at, i64 1
  %count = load i64, ptr %count.at
  %low.at = getelementptr double, ptr %guard.at, i64 2
  %low = load double, ptr %low.at
  %high.at = getelementptr double, ptr %guard.at, i64 3
  %high = load double, ptr %high.at
  %g1 = add i64 %g, 1
  %end = add i64 %first, %count
  br label %output
output:
  %o = phi i64 [%first, %check], [%o1, %inside]
  %some = icmp slt i64 %o, %end
  br i1 %some, label %compare, label %within
compare:
  %out.at = getelementptr double, ptr %target, i64 %o
  %out = load double, ptr %out.at
  %above = fcmp ogt double %out, %low
  %below = fcmp olt double %out, %high
  %both = and i1 %above, %below
  %o1 = add i64 %o, 1
  br i1 %both, label %inside, label %outside
inside:
  br label %output
outside:
  ret i64 %g1
within:
  br label %guard
scatter:
  %k = phi i64 [0, %guard], [%k1, %scatter]
  %place.at = getelementptr i64, ptr %places, i64 %k
  %place = load i64, ptr %place.at
  %rate.at = getelementptr double, ptr %target, i64 %place
  %value = load double, ptr %rate.at
  %f.at = getelementptr double, ptr %f, i64 %k
  store double %value, ptr %f.at
  %k1 = add i64 %k, 1
  %more = icmp slt i64 %k1, %size
  br i1 %more, label %scatter, label %done
done:
  ret i64 0
}}
"""

_FIRST = f"""
define i64 @nb_rate(ptr %job, double %t, double %h) nounwind {{
{fields(Job, "job", y="ptr", stages="ptr")}
  %status = call i64 @rate(ptr %job, double %t, ptr %y, ptr %stages)
  ret i64 %status
}}
"""


def _combined(name: str, coefficients: Sequence[float]) -> list[str]:
    """Lines that add up c_j k_j of one vector; %name is the sum."""
    used = [(j, c) for j, c in enumerate(coefficients) if c != 0]
    lines, before = [], ""
    for j, c in used:
        this = f"%{name}.{j}" if (j, c) != used[-1] else f"%{name}"
        lines += [
            f"  %{name}.place{j} = mul i64 %stride, {j}",
            f"  %{name}.at{j} = getelementptr i8, ptr %column, i64 %{name}.place{j}",
            f"  %{name}.k{j} = load {_VECTOR}, ptr %{name}.at{j}, align {_BYTES}",
        ]
        product = f"{this}.part" if before else this
        lines.append(f"  {product} = fmul contract {_VECTOR} %{name}.k{j}, {_NUMBER.constant(c)}")
        if before:
            lines.append(f"  {this} = fadd contract {_VECTOR} {before}, {product}")
        before = this
    return lines


def _sum(name: str, coefficients: Sequence[float]) -> str:
    """void name(y, stages, vectors, h, result): y + h sum_j c_j k_j."""
    lines = "\n".join(_combined("sum", coefficients))
    return f"""
define internal void @{name}(ptr %y, ptr %stages, i64 %vectors, double %h, ptr %result) nounwind {{
start:
  %stride = mul i64 %vectors, {_BYTES}
{_spread("h")}
  br label %next
next:
  %k = phi i64 [0, %start], [%k1, %next]
  %offset = mul i64 %k, {_BYTES}
  %column = getelementptr i8, ptr %stages, i64 %offset
{lines}
  %y.at = getelementptr i8, ptr %y, i64 %offset
  %from = load {_VECTOR}, ptr %y.at, align {_BYTES}
  %step = fmul contract {_VECTOR} %sum, %h.all
  %to = fadd contract {_VECTOR} %from, %step
  %result.at = getelementptr i8, ptr %result, i64 %offset
  store {_VECTOR} %to, ptr %result.at, align {_BYTES}
  %k1 = add i64 %k, 1
  %more = icmp slt i64 %k1, %vectors
  br i1 %more, label %next, label %end
end:
  ret void
}}"""


def _error(tableau: Tableau) -> str:
    """double error(Job* job, double h)."""
    lines = "\n".join([*_combined("five", tableau.E5), *_combined("three", tableau.E3)])
    names = {"size": "i64", "vectors": "i64", "rtol": "double", "atol": "double"}
    names |= dict.fromkeys(("y", "stages", "y1"), "ptr")
    return f"""
define internal double @error(ptr %job, double %h) nounwind {{
start:
{fields(Job, "job", **names)}
  %stride = mul i64 %vectors, {_BYTES}
{_spread("rtol")}
{_spread("atol")}
  br label %next
next:
  %k = phi i64 [0, %start], [%k1, %next]
  %fives = phi {_VECTOR} [zeroinitializer, %start], [%fives1, %next]
  %threes = phi {_VECTOR} [zeroinitializer, %start], [%threes1, %next]
  %offset = mul i64 %k, {_BYTES}
  %column = getelementptr i8, ptr %stages, i64 %offset
{lines}
  %from.at = getelementptr i8, ptr %y, i64 %offset
  %from = load {_VECTOR}, ptr %from.at, align {_BYTES}
  %to.at = getelementptr i8, ptr %y1, i64 %offset
  %to = load {_VECTOR}, ptr %to.at, align {_BYTES}
  %begin = call {_VECTOR} @llvm.fabs.v{LANES}f64({_VECTOR} %from)
  %end = call {_VECTOR} @llvm.fabs.v{LANES}f64({_VECTOR} %to)
  %larger = call {_VECTOR} @llvm.maxnum.v{LANES}f64({_VECTOR} %begin, {_VECTOR} %end)
  %part = fmul contract {_VECTOR} %larger, %rtol.all
  %scale = fadd contract {_VECTOR} %part, %atol.all
  %five.scaled = fdiv {_VECTOR} %five, %scale
  %three.scaled = fdiv {_VECTOR} %three, %scale
  %five.square = fmul contract {_VECTOR} %five.scaled, %five.scaled
  %three.square = fmul contract {_VECTOR} %three.scaled, %three.scaled
  %fives1 = fadd contract {_VECTOR} %fives, %five.square
  %threes1 = fadd contract {_VECTOR} %threes, %three.square
  %k1 = add i64 %k, 1
  %more = icmp slt i64 %k1, %vectors
  br i1 %more, label %next, label %norm
norm:
  %e5 = call double @llvm.vector.reduce.fadd.v{LANES}f64(double 0.0, {_VECTOR} %fives1)
  %e3 = call double @llvm.vector.reduce.fadd.v{LANES}f64(double 0.0, {_VECTOR} %threes1)
  %e3.part = fmul contract double %e3, {Number().constant(0.01)}
  %both = fadd contract double %e5, %e3.part
  %n = sitofp i64 %size to double
  %square = fmul double %both, %n
  %root = call double @llvm.sqrt.f64(double %square)
  %length = call double @llvm.fabs.f64(double %h)
  %numerator = fmul double %length, %e5
  %ratio = fdiv double %numerator, %root
  %none = fcmp oeq double %both, 0.0
  %result = select i1 %none, double 0.0, double %ratio
  ret double %result
}}"""


def _spread(name: str) -> str:
    """Lines that fill a vector with a number."""
    return f"""  %{name}.one = insertelement {_VECTOR} poison, double %{name}, i64 0
  %{name}.all = shufflevector {_VECTOR} %{name}.one, {_VECTOR} poison, <{LANES} x i32> zeroinitializer"""


def _stage(s: int, c: float, where: str, function: str = "") -> str:
    """Lines that make stage s (from 0) at t + c h; they leave where it cannot be made."""
    return f"""  call void @{function or f"inner{s}"}(ptr %y, ptr %stages, i64 %vectors, double %h, ptr %{where})
  %later{s} = fmul double %h, {Number().constant(c)}
  %t{s} = fadd double %t, %later{s}
  %offset{s} = mul i64 %stride, {s}
  %stage{s} = getelementptr i8, ptr %stages, i64 %offset{s}
  %status{s} = call i64 @rate(ptr %job, double %t{s}, ptr %{where}, ptr %stage{s})
  %bad{s} = icmp ne i64 %status{s}, 0
  br i1 %bad{s}, label %refused{s}, label %made{s}
refused{s}:
  ret i64 %status{s}
made{s}:"""


def _attempt(tableau: Tableau) -> str:
    """i64 nb_attempt(Job* job, double t, double h)."""
    last = tableau.stages - 1
    stages = [_stage(s, tableau.C[s], "inner") for s in range(1, last)] + [_stage(last, 1.0, "y1", "last")]
    lines = "\n".join(stages)
    return f"""
define i64 @nb_attempt(ptr %job, double %t, double %h) nounwind {{
{_BUFFERS}
{lines}
  %f1 = getelementptr i8, ptr %stages, i64 %offset{last}
  %bad = call i64 @finite(ptr %f1, i64 %vectors)
  %error = call double @error(ptr %job, double %h)
  %error.at = getelementptr i8, ptr %job, i64 {Job.error.offset}
  store double %error, ptr %error.at
  ret i64 %bad
}}"""


def _more(tableau: Tableau) -> str:
    """i64 nb_more(Job* job, double t, double h)."""
    stages = [_stage(tableau.stages + k, c, "inner") for k, c in enumerate(tableau.C_more)]
    lines = "\n".join(stages)
    return f"""
define i64 @nb_more(ptr %job, double %t, double %h) nounwind {{
{_BUFFERS}
{lines}
  ret i64 0
}}"""


_BUFFERS = f"""
{fields(Job, "job", vectors="i64", y="ptr", stages="ptr", inner="ptr", y1="ptr")}
  %stride = mul i64 %vectors, {_BYTES}"""
