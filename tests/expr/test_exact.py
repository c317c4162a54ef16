from __future__ import annotations

from fractions import Fraction

import mpmath
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nullbody.errors import InputError
from nullbody.expr import Exact

ZERO, ONE = Exact.of(0), Exact.of(1)


def _combination(parts: list[tuple[int, Fraction]]) -> Exact:
    total = ZERO
    for radicand, part in parts:
        total = total + Exact.square_root(radicand) * Exact.of(part)
    return total


fractions = st.fractions(-5, 5, max_denominator=9)
exacts = st.lists(st.tuples(st.sampled_from((1, 2, 3, 6, 12, 35)), fractions), max_size=4).map(_combination)


def _high_precision(number: Exact) -> mpmath.mpf:
    return mpmath.fsum(mpmath.sqrt(k) * part.numerator / part.denominator for k, part in number.terms)


@given(exacts, exacts, exacts)
def test_ring_axioms(a: Exact, b: Exact, c: Exact) -> None:
    assert a + b == b + a
    assert a * b == b * a
    assert (a + b) + c == a + (b + c)
    assert (a * b) * c == a * (b * c)
    assert a * (b + c) == a * b + a * c
    assert a + -a == ZERO == a - a
    assert (a + ZERO, a * ONE, a * ZERO) == (a, a, ZERO)


@given(exacts.filter(lambda a: a != ZERO))
def test_a_number_times_its_inverse_is_1(a: Exact) -> None:
    assert a * a.inverse() == ONE
    assert a.inverse().inverse() == a


@given(exacts)
def test_float_is_the_nearest_double(a: Exact) -> None:
    with mpmath.workdps(80):
        assert float(a) == float(_high_precision(a))


@given(exacts)
def test_negative_is_the_sign_of_the_value(a: Exact) -> None:
    with mpmath.workdps(80):
        assert a.negative == (_high_precision(a) < 0)


@given(st.fractions(0, 30, max_denominator=30))
def test_square_root_squared(number: Fraction) -> None:
    root = Exact.square_root(number)
    assert root * root == Exact.of(number)
    assert not root.negative


@pytest.mark.parametrize(
    ("number", "shown"),
    [
        (ZERO, "0"),
        (Exact.of(0.1), "1/10"),
        (Exact.square_root(Fraction(3, 4)), "sqrt(3)/2"),
        (Exact.square_root(12), "2*sqrt(3)"),
        ((Exact.square_root(6) - Exact.square_root(2)) * Exact.of(Fraction(1, 4)), "-sqrt(2)/4 + sqrt(6)/4"),
        (ONE - Exact.square_root(Fraction(9, 7)), "1 - 3*sqrt(7)/7"),
    ],
)
def test_shown_as_on_paper(number: Exact, shown: str) -> None:
    assert str(number) == shown


def test_fraction_is_none_for_irrational_numbers() -> None:
    assert Exact.of(Fraction(2, 3)).fraction == Fraction(2, 3)
    assert ZERO.fraction == 0
    assert Exact.square_root(2).fraction is None
    assert (ONE + Exact.square_root(2)).fraction is None


@pytest.mark.parametrize("number", [float("nan"), float("inf"), "one", None])
def test_what_is_no_finite_number_is_refused(number: object) -> None:
    with pytest.raises(InputError, match=r"finite|not a number"):
        Exact.of(number)


@pytest.mark.parametrize("number", [-1, Fraction(-1, 4), 1_000_000_007, 1_000_000_007 * 1_000_000_009])
def test_root_of_a_negative_or_hard_number_is_refused_at_once(number: int | Fraction) -> None:
    with pytest.raises(InputError, match=r"not real|not kept exactly"):
        Exact.square_root(number)


def test_large_squares_are_seen_without_factoring() -> None:
    assert Exact.square_root(3 * 1_000_000_007**2) == Exact.of(1_000_000_007) * Exact.square_root(3)


def test_zero_has_no_inverse() -> None:
    with pytest.raises(ZeroDivisionError):
        ZERO.inverse()
