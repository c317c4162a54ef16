"""Exact constants: rational combinations of square roots, such as 1/2, sqrt(3)/2 and (sqrt(6) - sqrt(2))/4."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import gcd, isfinite, isqrt
from numbers import Rational
from typing import Any

from nullbody.errors import InputError

__all__ = ["Exact", "prime_factors"]

_LARGEST_TRIAL = 10_000
_LARGEST_PRIME = 1000  # of a radicand: larger numbers are not factored
_BITS = 160  # binary digits kept of a square root when a constant is rounded to double


def prime_factors(number: int) -> list[int]:
    """The prime factors of a positive integer with multiplicity, by trial division up to `_LARGEST_TRIAL`.

    What is left beyond that stays one factor: sqrt(10^24 + 7) needs no factors to be exact.
    """
    factors, trial = [], 2
    while trial * trial <= number and trial <= _LARGEST_TRIAL:
        while number % trial == 0:
            factors.append(trial)
            number //= trial
        trial += 1
    return factors + [number] * (number > 1)


def _squarefree(number: int) -> tuple[int, int]:
    """Integers (r, k) with number = r^2 k, k free of squares and made of primes up to `_LARGEST_PRIME`.

    Raises:
        InputError: there is no such k.
    """
    root, rest, left = 1, 1, number
    for prime in range(2, _LARGEST_PRIME + 1):
        while left % (prime * prime) == 0:
            root, left = root * prime, left // (prime * prime)
        if left % prime == 0:
            rest, left = rest * prime, left // prime
    if isqrt(left) ** 2 != left:
        raise InputError(f"sqrt({number}) is not kept exactly: a prime factor is above {_LARGEST_PRIME}")
    return root * isqrt(left), rest


@dataclass(frozen=True)
class Exact:
    """A number sum_k c_k sqrt(k): k positive and square-free, c_k rational and not zero.

    `terms` holds the pairs (k, c_k) in increasing k; the empty tuple is zero.
    """

    terms: tuple[tuple[int, Fraction], ...]

    @classmethod
    def of(cls, number: int | float | Fraction | Exact) -> Exact:
        """The exact form of a number; a float means the shortest decimal that prints as it: 0.1 is 1/10.

        Raises:
            InputError: the number is not finite, or no number.
        """
        if isinstance(number, Exact):
            return number
        if isinstance(number, bool) or not isinstance(number, int | float | Fraction):
            number = _plain(number)
        if isinstance(number, float):
            if not isfinite(number):
                raise InputError(f"a constant must be finite, not {number}")
            number = Fraction(repr(float(number)))
        return cls(((1, Fraction(number)),) if number else ())

    @classmethod
    def square_root(cls, number: int | Fraction) -> Exact:
        """sqrt(number) for a number >= 0.

        Raises:
            InputError: the number is negative, or its square root has a prime above 1000 below the root.
        """
        ratio = Fraction(number)
        if ratio < 0:
            raise InputError(f"the square root of {ratio} is not real")
        root, rest = _squarefree(ratio.numerator * ratio.denominator) if ratio else (0, 1)
        return cls(((rest, Fraction(root, ratio.denominator)),) if root else ())

    def __add__(self, other: Exact) -> Exact:
        total = dict(self.terms)
        for k, part in other.terms:
            total[k] = total.get(k, Fraction(0)) + part
        return Exact(tuple(sorted((k, part) for k, part in total.items() if part)))

    def __neg__(self) -> Exact:
        return Exact(tuple((k, -part) for k, part in self.terms))

    def __sub__(self, other: Exact) -> Exact:
        return self + -other

    def __mul__(self, other: Exact) -> Exact:
        if len(self.terms) == len(other.terms) == 1:
            ((k, left),), ((n, right),) = self.terms, other.terms
            common = gcd(k, n)
            return Exact(((k * n // common**2, left * right * common if common > 1 else left * right),))
        total: dict[int, Fraction] = {}
        for k, left in self.terms:
            for n, right in other.terms:
                common = gcd(k, n)
                radicand = k * n // common**2
                total[radicand] = total.get(radicand, Fraction(0)) + left * right * common
        return Exact(tuple(sorted((k, part) for k, part in total.items() if part)))

    def inverse(self) -> Exact:
        """1 / self: multiply by conjugates sqrt(p) -> -sqrt(p), one prime p after the other.

        Raises:
            ZeroDivisionError: self is zero.
        """
        if not self.terms:
            raise ZeroDivisionError("the constant 0 has no inverse")
        numerator, denominator = Exact.of(1), self
        while irrational := [k for k, _ in denominator.terms if k > 1]:
            prime = prime_factors(irrational[-1])[-1]
            conjugate = Exact(tuple((k, -part if k % prime == 0 else part) for k, part in denominator.terms))
            numerator, denominator = numerator * conjugate, denominator * conjugate
        ((_, rational),) = denominator.terms
        return numerator * Exact(((1, 1 / rational),))

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        """Kept: a graph looks its constants up again and again."""
        return hash(self.terms)

    @cached_property
    def _approximation(self) -> Fraction:
        scale = 1 << _BITS
        return sum((part * Fraction(isqrt(k * scale * scale), scale) for k, part in self.terms), Fraction(0))

    def __float__(self) -> float:
        return float(self._approximation)

    @property
    def negative(self) -> bool:
        """Whether the number is below zero."""
        if len(self.terms) == 1:
            return self.terms[0][1] < 0
        return self._approximation < 0

    @property
    def fraction(self) -> Fraction | None:
        """The number as a Fraction, or None where it is irrational."""
        if not self.terms:
            return Fraction(0)
        return self.terms[0][1] if len(self.terms) == 1 and self.terms[0][0] == 1 else None

    def __str__(self) -> str:
        return " + ".join(_term(k, part) for k, part in self.terms).replace("+ -", "- ") or "0"


def _plain(number: Any) -> Fraction | float:
    """A number of another library: whole and rational ones exactly, any other as a float."""
    if isinstance(number, Rational):
        return Fraction(int(number.numerator), int(number.denominator))
    try:
        if not isinstance(number, str):
            return float(number)
    except (TypeError, ValueError):
        pass
    raise InputError(f"{number!r} is not a number; give an int, a Fraction or a float")


def _term(radicand: int, part: Fraction) -> str:
    if radicand == 1:
        return str(part)
    root = f"sqrt({radicand})"
    head = "" if abs(part.numerator) == 1 else f"{abs(part.numerator)}*"
    tail = "" if part.denominator == 1 else f"/{part.denominator}"
    return f"{'-' if part < 0 else ''}{head}{root}{tail}"
