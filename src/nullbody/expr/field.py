"""Random points of a prime field: the zero test by value (theory: "zero test by value").

Every node of a graph is given its value at a random point of F_p. Symbols are random numbers, the pair
(cos, sin) of an angle is a random point of the circle c^2 + s^2 = 1, and square roots of small primes are
square roots in F_p. Two expressions that are equal as functions then have equal values, and two that differ
have different values but for a chance of about degree / p, with p near 2^61 (Schwartz-Zippel).
"""

from __future__ import annotations

from fractions import Fraction
from hashlib import blake2b

from nullbody.expr.exact import Exact, prime_factors

__all__ = ["PRIMES", "Field"]

#: Primes p = 7 mod 8 below 2^61 in which 2, 3, 5, ..., 31 are squares. The second one checks the first.
PRIMES = (2305843009213682039, 2305843009213561919)


class Field:
    """The field F_p with a deterministic random point.

    Args:
        prime: one of `PRIMES`.
        seed: another seed is another random point.
    """

    def __init__(self, prime: int = PRIMES[0], seed: int = 0) -> None:
        self.prime = prime
        self.seed = seed
        self._roots: dict[int, int] = {}

    def random(self, tag: str) -> int:
        """A number in 1..p-1 that depends on the tag, the prime and the seed only."""
        digest = blake2b(f"{self.prime}|{self.seed}|{tag}".encode(), digest_size=16).digest()
        return int.from_bytes(digest, "big") % (self.prime - 1) + 1

    def circle(self, tag: str) -> tuple[int, int]:
        """A point (c, s) of c^2 + s^2 = 1 from t: c = (1 - t^2)/(1 + t^2), s = 2 t/(1 + t^2)."""
        p = self.prime
        t = self.random("circle " + tag)
        scale = pow(1 + t * t, -1, p)  # never 0: -1 is no square modulo p = 3 mod 4
        return (1 - t * t) * scale % p, 2 * t * scale % p

    def square_root(self, radicand: int) -> int:
        """sqrt(radicand), multiplicative in the radicand: sqrt(2) sqrt(3) = sqrt(6)."""
        p = self.prime
        if radicand not in self._roots:
            root = 1
            for factor in prime_factors(radicand):
                if all(pow(factor, (prime - 1) // 2, prime) == 1 for prime in PRIMES):
                    power = pow(factor, (p + 1) // 4, p)
                else:  # no square at every prime, and all must merge alike: an independent number stands in
                    power = self.random(f"sqrt {factor}")
                root = root * power % p
            self._roots[radicand] = root
        return self._roots[radicand]

    def constant(self, number: Exact) -> int:
        """The residue of an exact constant."""
        return sum(self._residue(part) * self.square_root(k) for k, part in number.terms) % self.prime

    def _residue(self, number: Fraction) -> int:
        return number.numerator * pow(number.denominator, -1, self.prime) % self.prime
