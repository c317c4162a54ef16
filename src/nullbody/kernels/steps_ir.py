"""The native code of many steps at once, as LLVM IR, and the module in which it stands with what it calls."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

from nullbody.kernels.attempt_ir import Job, Tableau, attempt_text
from nullbody.kernels.block import Code
from nullbody.kernels.closing import CLOSING_TEXT, ClosingJob
from nullbody.kernels.compile import compile_text
from nullbody.kernels.evaluation import Call, fields, module

__all__ = ["NUMBERS", "WATCHED", "Functions", "Run", "functions"]

WATCHED = 3  #: outputs that are reported
NUMBERS = 8 + WATCHED  #: reported for each step
_SIGNATURE = ctypes.PYFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_double, ctypes.c_double)


class Run(ctypes.Structure):
    """What the native code needs to know."""

    _fields_ = (
        ("attempt", ctypes.c_void_p),
        ("closing", ctypes.c_void_p),
        ("watched", ctypes.c_int64 * WATCHED),
        ("used", ctypes.c_int64),  # the stages to keep begin there, in bytes
        ("kept", ctypes.c_int64),  # and take as many
        ("last", ctypes.c_int64),  # y' at the end of a step, in bytes from the first stage
        ("row", ctypes.c_int64),  # bytes of y
        ("end", ctypes.c_double),
        ("longest", ctypes.c_double),
        ("capacity", ctypes.c_int64),
        ("numbers", ctypes.c_void_p),
        ("raw", ctypes.c_void_p),
        ("y", ctypes.c_void_p),
        ("f", ctypes.c_void_p),
        ("stages", ctypes.c_void_p),
    )


class Functions(NamedTuple):
    """The native functions of a method (structure, t, h) -> status, and what keeps them in memory."""

    rate: Callable[[int, float, float], int]
    attempt: Callable[[int, float, float], int]
    more: Callable[[int, float, float], int]
    steps: Callable[[int, float, float], int]
    code: Code


@cache
def functions(tableau: Tableau) -> Functions:
    """The native functions of a method, compiled once for all programs."""
    code = compile_text("nb_steps", module(attempt_text(tableau), CLOSING_TEXT, _TEXT))
    find = code.owner.get_function_address
    rate, attempt, more, steps = (_SIGNATURE(find(f"nb_{name}")) for name in ("rate", "attempt", "more", "steps"))
    return Functions(rate, attempt, more, steps, code)


def _watched() -> str:
    """Lines that note the watched outputs."""
    return "\n".join(
        f"""  %place{k}.at = getelementptr i8, ptr %run, i64 {Run.watched.offset + 8 * k}
  %place{k} = load i64, ptr %place{k}.at
  %watched{k}.at = getelementptr double, ptr %target, i64 %place{k}
  %watched{k} = load double, ptr %watched{k}.at
  call void @note(ptr %number, i64 {NUMBERS - WATCHED + k}, double %watched{k})"""
        for k in range(WATCHED)
    )


#: i64 nb_steps(Run* run, double t, double h): how many steps were made
_TEXT = f"""
define internal double @least(double %t) nounwind {{
  %bits = bitcast double %t to i64
  %positive = fcmp oge double %t, 0.0
  %magnitude = and i64 %bits, 9223372036854775807
  %up = add i64 %magnitude, 1
  %down = sub i64 %bits, 1
  %next.bits = select i1 %positive, i64 %up, i64 %down
  %next = bitcast i64 %next.bits to double
  %spacing = fsub double %next, %t
  %least = fmul double %spacing, 10.0
  ret double %least
}}
define internal double @factor(double %error) nounwind {{
  %two = call double @llvm.sqrt.f64(double %error)
  %four = call double @llvm.sqrt.f64(double %two)
  %eight = call double @llvm.sqrt.f64(double %four)
  %factor = fdiv double 0x3FECCCCCCCCCCCCD, %eight
  ret double %factor
}}
define internal void @note(ptr %row, i64 %k, double %value) nounwind {{
  %at = getelementptr double, ptr %row, i64 %k
  store double %value, ptr %at
  ret void
}}
define i64 @nb_steps(ptr %run, double %t.begin, double %h.begin) nounwind {{
start:
{fields(Run, "run", attempt="ptr", closing="ptr", used="i64", kept="i64", last="i64", row="i64")}
{fields(Run, "run", end="double", longest="double", capacity="i64")}
{fields(Run, "run", numbers="ptr", raw="ptr", y="ptr", f="ptr", stages="ptr")}
  %from.at = getelementptr i8, ptr %attempt, i64 {Job.y.offset}
  %from = load ptr, ptr %from.at
  %made.at = getelementptr i8, ptr %attempt, i64 {Job.y1.offset}
  %made = load ptr, ptr %made.at
  %K.at = getelementptr i8, ptr %attempt, i64 {Job.stages.offset}
  %K = load ptr, ptr %K.at
  %size.at = getelementptr i8, ptr %attempt, i64 {Job.size.offset}
  %size = load i64, ptr %size.at
  %bytes = mul i64 %size, 8
  %error.at = getelementptr i8, ptr %attempt, i64 {Job.error.offset}
  %K.last = getelementptr i8, ptr %K, i64 %last
  %K.used = getelementptr i8, ptr %K, i64 %used
  %here.at = getelementptr i8, ptr %closing, i64 {ClosingJob.y.offset}
  %here = load ptr, ptr %here.at
  %watch.at = getelementptr i8, ptr %closing, i64 {ClosingJob.matrix.offset}
  %target.at = getelementptr i8, ptr %watch.at, i64 {Call.target.offset}
  %target = load ptr, ptr %target.at
  %open.at = getelementptr i8, ptr %closing, i64 {ClosingJob.open.offset}
  %open = load double, ptr %open.at
  %before.at = getelementptr i8, ptr %closing, i64 {ClosingJob.before.offset}
  %after.at = getelementptr i8, ptr %closing, i64 {ClosingJob.after.offset}
  %sum.at = getelementptr i8, ptr %closing, i64 {ClosingJob.sum.offset}
  br label %step
step:
  %k = phi i64 [0, %start], [%k1, %on]
  %t = phi double [%t.begin, %start], [%t1, %on]
  %wanted = phi double [%h.begin, %start], [%h.next, %on]
  %full = icmp sge i64 %k, %capacity
  %late = fcmp oge double %t, %end
  %stop = or i1 %full, %late
  br i1 %stop, label %leave, label %length
leave:
  ret i64 %k
length:
  %shortest = call double @least(double %t)
  %short = fcmp olt double %wanted, %shortest
  %at.least = select i1 %short, double %shortest, double %wanted
  %long = fcmp ogt double %wanted, %longest
  %h.first = select i1 %long, double %longest, double %at.least
  br label %try
try:
  %tries = phi double [1.0, %length], [%tries1, %again]
  %limit = phi double [10.0, %length], [1.0, %again]
  %h.try = phi double [%h.first, %length], [%h.again, %again]
  %vanishing = fcmp olt double %h.try, %shortest
  br i1 %vanishing, label %leave, label %attempting
attempting:
  %t.far = fadd double %t, %h.try
  %beyond = fcmp ogt double %t.far, %end
  %t1 = select i1 %beyond, double %end, double %t.far
  %h = fsub double %t1, %t
  %status = call i64 @nb_attempt(ptr %attempt, double %t, double %h)
  %refused = icmp ne i64 %status, 0
  br i1 %refused, label %leave, label %judge
judge:
  %error = load double, ptr %error.at
  %tries1 = fadd double %tries, 1.0
  %factor = call double @factor(double %error)
  %good = fcmp olt double %error, 1.0
  br i1 %good, label %accepted, label %again
again:
  %large = fcmp ogt double %factor, 0x3FC999999999999A
  %shrink = select i1 %large, double %factor, double 0x3FC999999999999A
  %h.again = fmul double %h, %shrink
  br label %try
accepted:
  %modest = fcmp olt double %factor, %limit
  %grow = select i1 %modest, double %factor, double %limit
  %h.next = fmul double %h, %grow
  %offset = mul i64 %k, %row
  %raw.k = getelementptr i8, ptr %raw, i64 %offset
  %y.k = getelementptr i8, ptr %y, i64 %offset
  %f.k = getelementptr i8, ptr %f, i64 %offset
  call void @llvm.memcpy.p0.p0.i64(ptr %raw.k, ptr %made, i64 %bytes, i1 false)
  call void @llvm.memcpy.p0.p0.i64(ptr %here, ptr %made, i64 %bytes, i1 false)
  %newton = call i64 @nb_close(ptr %closing, double %t1)
  call void @llvm.memcpy.p0.p0.i64(ptr %y.k, ptr %here, i64 %bytes, i1 false)
  call void @llvm.memcpy.p0.p0.i64(ptr %f.k, ptr %K.last, i64 %bytes, i1 false)
  %stages.offset = mul i64 %k, %kept
  %stages.k = getelementptr i8, ptr %stages, i64 %stages.offset
  call void @llvm.memcpy.p0.p0.i64(ptr %stages.k, ptr %K.used, i64 %kept, i1 false)
  %moved = icmp sgt i64 %newton, 0
  br i1 %moved, label %anew, label %record
anew:
  %rated = call i64 @rate(ptr %attempt, double %t1, ptr %y.k, ptr %f.k)
  %unrated = icmp ne i64 %rated, 0
  br i1 %unrated, label %leave, label %record
record:
  %numbers.offset = mul i64 %k, {NUMBERS}
  %number = getelementptr double, ptr %numbers, i64 %numbers.offset
  %before = load double, ptr %before.at
  %after = load double, ptr %after.at
  %sum = load double, ptr %sum.at
  %count = sitofp i64 %newton to double
  call void @note(ptr %number, i64 0, double %t1)
  call void @note(ptr %number, i64 1, double %h)
  call void @note(ptr %number, i64 2, double %h.next)
  call void @note(ptr %number, i64 3, double %tries)
  call void @note(ptr %number, i64 4, double %before)
  call void @note(ptr %number, i64 5, double %after)
  call void @note(ptr %number, i64 6, double %sum)
  call void @note(ptr %number, i64 7, double %count)
{_watched()}
  %k1 = add i64 %k, 1
  %closed = fcmp ole double %after, %open
  br i1 %closed, label %on, label %ends
ends:
  ret i64 %k1
on:
  call void @llvm.memcpy.p0.p0.i64(ptr %from, ptr %y.k, i64 %bytes, i1 false)
  call void @llvm.memcpy.p0.p0.i64(ptr %K, ptr %f.k, i64 %bytes, i1 false)
  br label %step
}}
"""
