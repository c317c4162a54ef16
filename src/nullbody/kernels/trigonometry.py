"""Sine and cosine as LLVM IR: one internal function that returns both, without libm in the working range.

For |x| <= 2^20 pi/2 (1.6e6) the code is free of branches:

    n = round(2 x / pi),  r = x - n pi/2 = y0 + y1,
    sin x = +-(sin r or cos r),  cos x = +-(cos r or sin r) by the last two bits of n.

pi/2 = P1 + P2 + P3 + P4 with at most 33 bits in each of P1, P2, P3: the products n P1, n P2, n P3 are exact for
|n| <= 2^20, x - n P1 is exact, and the two differences after it carry their rounding error along (Knuth's two-sum).
What is neglected is below 2^-130. Fusing products into sums (`contract`) changes none of these exact products.
The polynomials are those of fdlibm (k_sin.c, k_cos.c, Sun Microsystems 1993) on |r| <= pi/4 with the tail y1.

Error bound: below 1 ulp for both functions (0.75 ulp seen). sin(-0.0) is -0.0; beyond the range libm is called;
inf and nan give nan.
"""

from __future__ import annotations

import struct
from fractions import Fraction

__all__ = ["RANGE", "SINCOS", "hexadecimal", "sincos_ir"]

#: Name of the internal LLVM function: { double, double } (double) returns (sin x, cos x).
SINCOS = "@nbt.sincos"

#: Largest |x| that needs no libm: 2^20 pi/2.
RANGE = float.fromhex("0x1.921fb54442d18p+20")

_HALF_PI = Fraction(
    "1.57079632679489661923132169163975144209858469968755291048747229615390820314310449931401741267105853399107404326"
)
_SHIFT = 1.5 * 2.0**52  # adding it rounds to an integer and leaves that integer in the last bits
_TINY = 2.0**-26  # sin x = x to 0.4 ulp below

_SINE = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
_COSINE = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)


def hexadecimal(number: float) -> str:
    """A double as LLVM IR writes it exactly: the 16 digits of its bits."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', number))[0]:016X}"


def _parts_of_half_pi() -> tuple[float, float, float, float]:
    """P1, P2, P3 of 33 bits each and the rounded rest P4, with P1 + P2 + P3 + P4 = pi/2."""
    parts, rest = [], _HALF_PI
    for bits in (32, 66, 99):
        part = Fraction(int(rest * 2**bits), 2**bits)
        parts.append(float(part))
        rest -= part
    return parts[0], parts[1], parts[2], float(rest)


class _Lines:
    """Lines of LLVM IR with fresh names; every operation is in double with the flag `contract`."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def emit(self, text: str) -> str:
        name = f"%t{len(self.lines)}"
        self.lines.append(f"  {name} = {text}")
        return name

    def op(self, operation: str, a: str | float, b: str | float) -> str:
        left, right = (x if isinstance(x, str) else hexadecimal(x) for x in (a, b))
        return self.emit(f"{operation} contract double {left}, {right}")

    def add(self, a: str | float, b: str | float) -> str:
        return self.op("fadd", a, b)

    def sub(self, a: str | float, b: str | float) -> str:
        return self.op("fsub", a, b)

    def mul(self, a: str | float, b: str | float) -> str:
        return self.op("fmul", a, b)

    def polynomial(self, z: str, coefficients: tuple[float, ...]) -> str:
        """Horner's rule, lowest coefficient first."""
        value: str | float = coefficients[-1]
        for c in reversed(coefficients[:-1]):
            value = self.add(self.mul(value, z), c)
        return str(value)

    def difference(self, a: str, b: str) -> tuple[str, str]:
        """(s, e) with s = fl(a - b) and s + e = a - b exactly."""
        s = self.sub(a, b)
        back = self.sub(s, a)
        return s, self.sub(self.sub(a, self.sub(s, back)), self.add(b, back))


def _reduced(ir: _Lines) -> tuple[str, str, str]:
    """(y0, y1, bits): the reduced argument, its tail, and an integer whose last two bits are the quadrant."""
    p1, p2, p3, p4 = _parts_of_half_pi()
    shifted = ir.add(ir.mul("%x", float(1 / _HALF_PI)), _SHIFT)
    n = ir.sub(shifted, _SHIFT)
    first = ir.sub("%x", ir.mul(n, p1))
    second, error2 = ir.difference(first, ir.mul(n, p2))
    third, error3 = ir.difference(second, ir.mul(n, p3))
    tail = ir.sub(ir.add(error2, error3), ir.mul(n, p4))
    y0 = ir.add(third, tail)
    y1 = ir.add(ir.sub(third, y0), tail)
    return y0, y1, ir.emit(f"bitcast double {shifted} to i64")


def _sine(ir: _Lines, y0: str, y1: str, z: str) -> str:
    v = ir.mul(z, y0)
    r = ir.polynomial(z, _SINE[1:])
    inner = ir.sub(ir.mul(z, ir.sub(ir.mul(y1, 0.5), ir.mul(v, r))), y1)
    return ir.sub(y0, ir.sub(inner, ir.mul(v, _SINE[0])))


def _cosine(ir: _Lines, y0: str, y1: str, z: str) -> str:
    r = ir.mul(z, ir.polynomial(z, _COSINE))
    half = ir.mul(z, 0.5)
    w = ir.sub(1.0, half)
    return ir.add(w, ir.add(ir.sub(ir.sub(1.0, w), half), ir.sub(ir.mul(z, r), ir.mul(y0, y1))))


def _signed(ir: _Lines, magnitude: str, bits: str) -> str:
    """The number with its sign flipped where bit 1 of `bits` is set."""
    sign = ir.emit(f"shl i64 {ir.emit(f'and i64 {bits}, 2')}, 62")
    raw = ir.emit(f"bitcast double {magnitude} to i64")
    return ir.emit(f"bitcast i64 {ir.emit(f'xor i64 {raw}, {sign}')} to double")


def _pair(ir: _Lines, sine: str, cosine: str) -> str:
    half = ir.emit(f"insertvalue {{ double, double }} poison, double {sine}, 0")
    return ir.emit(f"insertvalue {{ double, double }} {half}, double {cosine}, 1")


def sincos_ir() -> str:
    """The function `SINCOS` and the declarations that it needs, as LLVM IR."""
    ir = _Lines()
    y0, y1, bits = _reduced(ir)
    z = ir.mul(y0, y0)
    sine, cosine = _sine(ir, y0, y1, z), _cosine(ir, y0, y1, z)
    odd = ir.emit(f"trunc i64 {bits} to i1")
    s = _signed(ir, ir.emit(f"select i1 {odd}, double {cosine}, double {sine}"), bits)
    following = ir.emit(f"add i64 {bits}, 1")
    c = _signed(ir, ir.emit(f"select i1 {odd}, double {sine}, double {cosine}"), following)
    tiny = ir.emit(f"fcmp olt double %size, {hexadecimal(_TINY)}")
    result = _pair(ir, ir.emit(f"select i1 {tiny}, double %x, double {s}"), c)
    body = "\n".join(ir.lines)
    return f"""declare double @llvm.fabs.f64(double)
declare double @llvm.sin.f64(double)
declare double @llvm.cos.f64(double)

define internal {{ double, double }} {SINCOS}(double %x) nounwind memory(none) {{
  %size = call double @llvm.fabs.f64(double %x)
  %near = fcmp ole double %size, {hexadecimal(RANGE)}
  br i1 %near, label %within, label %beyond, !prof !0
within:
{body}
  ret {{ double, double }} {result}
beyond:
  %s = call double @llvm.sin.f64(double %x)
  %c = call double @llvm.cos.f64(double %x)
  %half = insertvalue {{ double, double }} poison, double %s, 0
  %both = insertvalue {{ double, double }} %half, double %c, 1
  ret {{ double, double }} %both
}}

!0 = !{{!"branch_weights", i32 1000000, i32 1}}
"""
