"""Sine and cosine as LLVM IR: one internal function that returns both, without libm in the working range.

For |x| <= 2^20 pi/2 (1.6e6) the code is free of branches:

    n = round(2 x / pi),  r = x - n pi/2 = y0 - y1,
    sin x = +-(sin r or cos r),  cos x = +-(cos r or sin r) by the last two bits of n.

pi/2 = P1 + P2 + P3 + P4, cut 32, 64 and 96 bits behind the point: the products n P1, n P2, n P3 are exact for
|n| <= 2^20, and so is x - n P1. The next two differences d = a - n P carry their rounding error (a - d) - n P along
(Dekker's fast two-sum): it is exact where |a| >= |n P|, and otherwise d has at most 53 bits and the error is 0.
What is neglected is below 2^-128. Fusing products into sums (`contract`) changes none of these exact products.
The polynomials are those of fdlibm (k_sin.c, k_cos.c, Sun Microsystems 1993) on |r| <= pi/4 with the tail y1,
summed in pairs (Estrin), which shortens the chain of dependent operations.

Error bound: below 1 ulp for both functions (0.76 ulp seen). sin(-0.0) is -0.0; beyond the range libm is called;
inf and nan give nan. A vector asks libm for all lanes where one is beyond, and takes from it that lane only: every
lane has the bits that the scalar function gives. Floats go by way of doubles: the result is rounded once.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from nullbody.kernels.number import Lines, Number

__all__ = ["RANGE", "WEIGHTS", "sincos_ir", "sincos_name"]

#: Largest |x| that needs no libm: 2^20 pi/2.
RANGE = float.fromhex("0x1.921fb54442d18p+20")

#: Metadata !0 of the module: the branch to libm is hardly ever taken.
WEIGHTS = '!0 = !{!"branch_weights", i32 1000000, i32 1}'

_HALF_PI = Fraction(
    "1.57079632679489661923132169163975144209858469968755291048747229615390820314310449931401741267105853399107404326"
)
_SHIFT = 1.5 * 2.0**52  # adding it rounds to an integer and leaves that integer in the last bits
_SIGN = -(2**63)

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


def sincos_name(number: Number) -> str:
    """Name of the internal LLVM function (x) -> { sin x, cos x }."""
    return f"@nbt.sincos.{number.suffix}"


def _parts_of_half_pi() -> tuple[float, float, float, float]:
    """P1, P2, P3 of at most 33 bits each and the rounded rest P4, with P1 + P2 + P3 + P4 = pi/2."""
    parts, rest = [], _HALF_PI
    for bits in (32, 64, 96):
        part = Fraction(int(rest * 2**bits), 2**bits)
        parts.append(float(part))
        rest -= part
    return parts[0], parts[1], parts[2], float(rest)


def _polynomial(ir: Lines, z: str, square: str, coefficients: Sequence[float]) -> str:
    """Lowest coefficient first, pairs (c0 + c1 z) + z^2 (c2 + c3 z) + ..."""
    pairs: list[str | float] = [
        ir.add(ir.mul(z, coefficients[k + 1]), coefficients[k]) if k + 1 < len(coefficients) else coefficients[k]
        for k in range(0, len(coefficients), 2)
    ]
    value = pairs.pop()
    while pairs:
        value = ir.add(ir.mul(square, value), pairs.pop())
    return str(value)


def _reduced(ir: Lines, x: str) -> tuple[str, str, str]:
    """(y0, y1, bits): the reduced argument, minus its tail, and an integer whose last two bits are the quadrant."""
    p1, p2, p3, p4 = _parts_of_half_pi()
    shifted = ir.add(ir.mul(x, float(1 / _HALF_PI)), _SHIFT)
    n = ir.sub(shifted, _SHIFT)
    rest, tail = ir.sub(x, ir.mul(n, p1)), ir.mul(n, p4)
    for part in (p2, p3):
        product = ir.mul(n, part)
        following = ir.sub(rest, product)
        tail = ir.sub(tail, ir.sub(ir.sub(rest, following), product))
        rest = following
    y0 = ir.sub(rest, tail)  # -0.0 - 0.0 is -0.0: the sign of zero survives
    y1 = ir.sub(tail, ir.sub(rest, y0))
    return y0, y1, ir.integers(shifted)


def _sine(ir: Lines, y0: str, y1: str, z: str, square: str) -> str:
    v = ir.mul(z, y0)
    r = _polynomial(ir, z, square, _SINE[1:])
    inner = ir.sub(y1, ir.mul(z, ir.add(ir.mul(y1, 0.5), ir.mul(v, r))))
    return ir.sub(y0, ir.sub(inner, ir.mul(v, _SINE[0])))


def _cosine(ir: Lines, y0: str, y1: str, z: str, square: str) -> str:
    r = ir.mul(z, _polynomial(ir, z, square, _COSINE))
    half = ir.mul(z, 0.5)
    w = ir.sub(1.0, half)
    return ir.add(w, ir.add(ir.sub(ir.sub(1.0, w), half), ir.add(ir.mul(z, r), ir.mul(y0, y1))))


def _quadrant(ir: Lines, sine: str, cosine: str, bits: str) -> tuple[str, str]:
    """(sin x, cos x) from those of r: exchanged where bit 0 is set; signs by bit 1 and by bit 0 + bit 1."""
    last = ir.bits("shl", bits, 63)
    exchanged = ir.bits("icmp slt", last, 0)
    sign = ir.bits("and", ir.bits("shl", bits, 62), _SIGN)
    s = ir.bits("xor", ir.integers(ir.choose(exchanged, cosine, sine)), sign)
    c = ir.bits("xor", ir.integers(ir.choose(exchanged, sine, cosine)), ir.bits("xor", sign, last))
    return ir.floats(s), ir.floats(c)


def _all_lanes(ir: Lines, condition: str) -> str:
    number = ir.number
    if not number.wide:
        return condition
    mask = ir.emit(f"bitcast {number.truth} {condition} to i{number.lanes}")
    return ir.emit(f"icmp eq i{number.lanes} {mask}, -1")


def sincos_ir(number: Number) -> str:
    """The function `sincos_name(number)` and what it declares, as LLVM IR; that of floats calls that of doubles."""
    head = f"define internal {number.pair} {sincos_name(number)}({number.text} %x) nounwind memory(none) {{"
    ir = Lines(number)
    if number.bits == 32:
        return f"{head}\n{_through_doubles(ir)}}}\n"
    y0, y1, bits = _reduced(ir, "%x")
    z = ir.mul(y0, y0)
    square = ir.mul(z, z)
    s, c = _quadrant(ir, _sine(ir, y0, y1, z, square), _cosine(ir, y0, y1, z, square), bits)
    near = ir.emit(f"fcmp ole {number.text} {ir.intrinsic('fabs', '%x')}, {number.constant(RANGE)}")
    ir.lines.append(f"  br i1 {_all_lanes(ir, near)}, label %within, label %beyond, !prof !0\nwithin:")
    ir.lines.append(f"  ret {number.pair} {ir.both(s, c)}\nbeyond:")
    far_s, far_c = (ir.choose(near, a, ir.intrinsic(f, "%x")) for f, a in (("sin", s), ("cos", c)))
    ir.lines.append(f"  ret {number.pair} {ir.both(far_s, far_c)}")
    declared = (f"declare {number.text} @llvm.{f}.{number.suffix}({number.text})" for f in ("fabs", "sin", "cos"))
    return "\n".join([*declared, head, str(ir), "}\n"])


def _through_doubles(ir: Lines) -> str:
    """The body for floats: widened, evaluated in double, rounded."""
    number, double = ir.number, ir.number.doubles
    x = ir.emit(f"fpext {number.text} %x to {double.text}")
    results = ir.emit(f"call {double.pair} {sincos_name(double)}({double.text} {x})")
    halves = [ir.emit(f"extractvalue {double.pair} {results}, {k}") for k in (0, 1)]
    s, c = (ir.emit(f"fptrunc {double.text} {half} to {number.text}") for half in halves)
    both = ir.both(s, c)
    return f"{ir}\n  ret {number.pair} {both}\n"
