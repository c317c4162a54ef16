"""Sums of products, and the divisors that are taken out of them to save operations.

    d = a b             a pair of factors of several products
    d = p + q, p - q    a pair of terms, up to a common factor: c p + c q becomes c d (x y + x z = x (y + z))

The divisor that saves most goes first, wherever it is found at once, until none saves any (Rajski and Vasudevamurthy
1992 for logic, Hosangadi, Fallah and Kastner 2006 for polynomials). Nothing is ever multiplied out.
"""

from __future__ import annotations

from collections.abc import Iterable
from heapq import heappop, heappush
from itertools import combinations
from typing import NamedTuple

__all__ = ["Factors", "SumsOfProducts", "Term"]

_WINDOW = 20  # a term is paired with so many of those that stand before it in its sum

Factors = tuple[int, ...]  # a product of atoms, in increasing order
_Product = tuple[int, int]  # a, b: a b
_Sum = tuple[int, Factors, Factors]  # sign, p, q: p + q for sign 0, p - q up to its sign for 1


class Term(NamedTuple):
    """A product in a sum, with its sign: 0 for +, 1 for -."""

    home: int
    sign: int
    factors: Factors


class SumsOfProducts:
    """Sums of products of atoms. An atom is a number: of a sum that stands here, or of anything else.

    Args:
        atoms: how many numbers are taken; divisors get the next ones.

    Attributes:
        sums: the terms of every sum, by their numbers.
        terms: what these are.
    """

    def __init__(self, atoms: int) -> None:
        self.sums: dict[int, list[int]] = {}
        self.terms: dict[int, Term] = {}
        self._atoms = atoms
        self._made = 0
        self._products: dict[_Product, dict[int, None]] = {}  # the terms that have both factors
        self._pairs: dict[_Sum, list[tuple[int, int]]] = {}  # pairs of terms, some of which may be gone
        self._touched: set[_Product | _Sum] = set()

    def add(self, home: int, sign: int, factors: Iterable[int]) -> None:
        """One more term of a sum; the divisors that it has are noted."""
        own = tuple(sorted(factors))
        term = self._made
        self._made += 1
        for product in combinations(own, 2):
            found = self._products.setdefault(product, {})
            found[term] = None
            if len(found) > 1:
                self._touched.add(product)
        members = self.sums.setdefault(home, [])
        for other in members[-_WINDOW:]:
            _, other_sign, other_factors = self.terms[other]
            common, p, q = _split(other_factors, own)
            if p != q:
                divisor = (sign ^ other_sign, p, q) if p < q else (sign ^ other_sign, q, p)
                pairs = self._pairs.setdefault(divisor, [])
                pairs.append((other, term))
                if common or len(pairs) > 1:
                    self._touched.add(divisor)
        members.append(term)
        self.terms[term] = Term(home, sign, own)

    def reduce(self) -> None:
        """Take out divisors, the one that saves most first, as long as one saves any."""
        heap: list[tuple[int, int, _Product | _Sum]] = []
        while True:
            for divisor in self._touched:
                if (saved := self._saved(divisor)) > 0:
                    heappush(heap, (-saved, -len(divisor), divisor))
            self._touched.clear()
            if not heap:
                return
            promised, kind, divisor = heappop(heap)
            saved = self._saved(divisor)  # may be less by now
            if saved == -promised:
                self._take(divisor)
            elif saved > 0:
                heappush(heap, (-saved, kind, divisor))

    def _saved(self, divisor: _Product | _Sum) -> int:
        """Operations that the divisor saves wherever it is found, less those that it takes itself."""
        if len(divisor) == 2:
            return len(self._products[divisor]) - 1
        _, p, q = divisor
        own, terms = len(p) + len(q), self.terms
        saved = 1 - max(len(p), 1) - max(len(q), 1)
        for one, two in self._matches(divisor):
            common = (len(terms[one].factors) + len(terms[two].factors) - own) // 2
            saved += common + own - 1
        return saved

    def _matches(self, divisor: _Sum) -> list[tuple[int, int]]:
        """The pairs of terms that make the divisor: those that are still there, each term once."""
        there = [pair for pair in self._pairs[divisor] if pair[0] in self.terms and pair[1] in self.terms]
        self._pairs[divisor] = there
        if len(there) < 2:
            return there
        found, used = [], set[int]()
        for pair in there:
            if used.isdisjoint(pair):
                found.append(pair)
                used.update(pair)
        return found

    def _take(self, divisor: _Product | _Sum) -> None:
        """Make the divisor an atom, and write the terms that have it with that."""
        atom = self._atoms
        self._atoms += 1
        if len(divisor) == 2:
            for term in list(self._products[divisor]):
                home, sign, factors = self._dropped(term)
                self.add(home, sign, _replaced(factors, *divisor, atom))
            self.add(atom, 0, divisor)
            return
        relative, p, q = divisor
        for one, two in self._matches(divisor):
            first, second = self._dropped(one), self._dropped(two)
            common, rest, _ = _split(first.factors, second.factors)
            self.add(first.home, first.sign if rest == p else second.sign, (*common, atom))
        self.add(atom, 0, p)
        self.add(atom, relative, q)

    def _dropped(self, term: int) -> Term:
        found = self.terms.pop(term)
        self.sums[found.home].remove(term)
        for product in combinations(found.factors, 2):
            self._products[product].pop(term, None)
        return found


def _split(one: Factors, two: Factors) -> tuple[Factors, Factors, Factors]:
    """The common factors of two products, and what each has beside them."""
    if set(one).isdisjoint(two):
        return (), one, two
    common, own, rest = [], [], list(two)
    for factor in one:
        if factor in rest:
            rest.remove(factor)
            common.append(factor)
        else:
            own.append(factor)
    return tuple(common), tuple(own), tuple(rest)


def _replaced(factors: Factors, a: int, b: int, atom: int) -> list[int]:
    """A product with a b written as one atom, as often as it is there."""
    rest = list(factors)
    times = rest.count(a) // 2 if a == b else min(rest.count(a), rest.count(b))
    for factor in (a, b) * times:
        rest.remove(factor)
    return rest + [atom] * times
