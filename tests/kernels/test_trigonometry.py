from __future__ import annotations

import math
import random
from collections.abc import Iterator
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from nullbody.expr import Graph, cos, sin
from nullbody.expr.tape import Tape
from nullbody.kernels import Kernel, Program, compile_programs
from nullbody.kernels.trigonometry import RANGE, _parts_of_half_pi


@pytest.fixture
def kernel() -> Kernel:
    x = Graph().symbol("x")
    program = Program("f", (("x", 1),), (("s", ()), ("c", ())), Tape.of([sin(x), cos(x)], ["x"]))
    return compile_programs([program]).kernels["f"]


def _uniform(width: float) -> Iterator[float]:
    rng = random.Random(0)
    return (rng.uniform(-width, width) for _ in range(2000))


def _near_multiples(of: mpmath.mpf) -> Iterator[float]:
    rng = random.Random(1)
    last = int(RANGE / of)
    for n in [*range(1, 200), *(rng.randrange(200, last) for _ in range(1500)), last]:
        x = float(n * of)
        yield from (x, -math.nextafter(x, 0), math.nextafter(x, math.inf) if n < last else -x)


def _tiny() -> Iterator[float]:
    return (math.ldexp(1.3, e) for e in range(-1074, 1))


def _ulps(value: float, exact: mpmath.mpf) -> float:
    return float(abs(mpmath.mpf(value) - exact) / math.ulp(float(exact)))


@pytest.mark.parametrize(
    "kind", ["one quadrant", "ten", "whole range", "multiples of pi/2", "multiples of pi/4", "tiny"]
)
def test_the_error_is_below_one_ulp(kind: str, kernel: Kernel) -> None:
    with mpmath.workprec(250):
        numbers = {
            "one quadrant": _uniform(math.pi / 4),
            "ten": _uniform(10),
            "whole range": _uniform(RANGE),
            "multiples of pi/2": _near_multiples(mpmath.pi / 2),
            "multiples of pi/4": _near_multiples(mpmath.pi / 4),
            "tiny": _tiny(),
        }
        xs = list(numbers[kind])
        lanes = kernel.batch(np.array(xs)[:, None])
        for x, *vector in zip(xs, *lanes, strict=True):
            s, c = kernel([x])
            assert [s, c] == vector, x
            assert _ulps(float(s), mpmath.sin(x)) < 1, x
            assert _ulps(float(c), mpmath.cos(x)) < 1, x


@pytest.mark.parametrize("x", [math.inf, -math.inf, math.nan])
def test_what_is_not_finite_gives_nan(x: float, kernel: Kernel) -> None:
    assert all(np.isnan(value) for value in kernel([x]))


def test_zero_keeps_its_sign(kernel: Kernel) -> None:
    assert [math.copysign(1, float(kernel([x])[0])) for x in (0.0, -0.0)] == [1, -1]
    assert kernel([-0.0])[1] == 1


@pytest.mark.parametrize("x", [math.nextafter(RANGE, math.inf), -1e22, 1e300])
def test_beyond_the_range_libm_answers(x: float, kernel: Kernel) -> None:
    s, c = kernel([x])
    assert (float(s), float(c)) == (pytest.approx(math.sin(x), rel=1e-15), pytest.approx(math.cos(x), rel=1e-15))


def test_a_lane_beyond_the_range_leaves_the_others_alone(kernel: Kernel) -> None:
    near = list(_uniform(10))[:40]
    for far in (math.inf, math.nan, 1e22):
        mixed = np.array([far if k % 5 == 0 else x for k, x in enumerate(near)])[:, None]
        singles = np.array([kernel(row) for row in mixed])
        assert np.array_equal(np.array(kernel.batch(mixed)).T, singles, equal_nan=True)


def test_zero_keeps_its_sign_in_every_lane(kernel: Kernel) -> None:
    zeros = np.array([0.0, -0.0, -0.0, 0.0, -0.0])[:, None]
    assert np.array_equal(np.signbit(kernel.batch(zeros)[0]), np.signbit(zeros[:, 0]))


def test_sine_is_odd_and_cosine_even(kernel: Kernel) -> None:
    for x in _uniform(100):
        (s, c), (t, d) = kernel([x]), kernel([-x])
        assert (s, c) == (-t, d)


def test_the_parts_of_half_pi_have_exact_products() -> None:
    parts = _parts_of_half_pi()
    for part in parts[:3]:
        assert Fraction(part) * (2**20 - 1) == Fraction(part * (2**20 - 1))
    assert [part * 2**bits % 1 for part, bits in zip(parts[:3], (32, 64, 96), strict=True)] == [0, 0, 0]
    with mpmath.workprec(300):
        assert abs(mpmath.pi / 2 - sum(mpmath.mpf(part) for part in parts)) < mpmath.mpf(2) ** -150
