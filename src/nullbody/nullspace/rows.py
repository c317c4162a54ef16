"""Constant row operations that make a constraint Jacobian of expressions cheaper, found by value.

Rows of loop closures are components in some frame; a combination of them in Q or Q(sqrt 3) is often much
simpler (for the 3-PRS: the components across each leg's plane, and the sums over the legs). A row operation
A_i - f A_s is tried for every constant f that cancels an entry, and taken where the row becomes cheaper. An entry
of the new row whose value is a small multiple of an existing expression becomes that multiple.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from typing import NamedTuple

from nullbody.expr import Exact, Expr, Graph
from nullbody.expr.matrix import Matrix

__all__ = ["RowStep", "simplified_rows"]

#: Row i becomes row i minus factor times row s: (i, s, factor).
RowStep = tuple[int, int, Expr]

_ENTRY = 1.0  # what a non-zero entry costs in what follows; each operation in it adds _OPERATION
_OPERATION = 0.1
_CONSTANT = 0.2
_LARGEST_SIZE = 30
_MOST_STEPS = 4  # for each row
_ROUNDING = 1e-9


def simplified_rows(matrix: Matrix) -> tuple[list[list[Expr]], list[RowStep]]:
    """The rows after constant row operations of determinant 1, and the operations in order."""
    if not matrix or not matrix[0]:
        return [list(row) for row in matrix], []
    search = _Search(matrix[0][0].graph)
    rows = [search.row(row) for row in matrix]
    steps: list[RowStep] = []
    pairs = [(i, k) for i in range(len(rows)) for k in range(len(rows)) if i != k]
    best = {pair: search.improvement(rows[pair[0]], rows[pair[1]]) for pair in pairs}
    while len(steps) < _MOST_STEPS * len(rows):
        pair = max(pairs, key=lambda pair: best[pair].gain, default=None)
        if pair is None or best[pair].gain <= 0:
            break
        i, k = pair
        rows[i] = search.row(search.difference(rows[i], best[pair], rows[k]))
        steps.append((i, k, search.graph.constant(best[pair].factor)))
        for one, two in pairs:
            if i in (one, two):
                best[one, two] = search.improvement(rows[one], rows[two])
    return [row.entries for row in rows], steps


class _Row(NamedTuple):
    """A row with the values of its entries, their inverses in the field, and what each costs."""

    entries: list[Expr]
    values: list[int]
    inverses: list[int]
    costs: list[float]


class _Improvement(NamedTuple):
    """The best operation of one row on another: its factor, the factor's value, and what the new row costs less."""

    factor: Exact
    residue: int
    gain: float


_NOTHING = _Improvement(Exact.of(0), 0, 0.0)


class _Search:
    """Row operations on expressions of one graph, judged by their values; nothing is built before it is chosen."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.prime = graph.prime
        self.sizes: dict[int, int] = {}
        self.factors = {graph.residue(number): number for number in _constants(wide=True)}
        self.multiples = [(pow(graph.residue(number), -1, self.prime), number) for number in _constants(wide=False)]

    def row(self, entries: Sequence[Expr]) -> _Row:
        """A row with everything that the search asks of it."""
        values = [self.graph.value(entry.ref) for entry in entries]
        inverses = [pow(value, -1, self.prime) if value else 0 for value in values]
        return _Row(list(entries), values, inverses, [self._cost(entry.ref) for entry in entries])

    def improvement(self, one: _Row, two: _Row) -> _Improvement:
        """The best factor f for which one - f two is cheaper than one; no gain where there is none."""
        best, before, zeros = _NOTHING, sum(one.costs), one.values.count(0)
        tried: set[int] = set()
        for a, inverse in zip(one.values, two.inverses, strict=True):
            residue = a * inverse % self.prime
            if not residue or residue in tried or residue not in self.factors:
                continue
            tried.add(residue)
            values = [(x - residue * y) % self.prime for x, y in zip(one.values, two.values, strict=True)]
            if values.count(0) < zeros - 1:
                continue
            gain = before - sum(self._new_cost(one, two, j, value) for j, value in enumerate(values))
            if gain > max(best.gain, _ROUNDING):
                best = _Improvement(self.factors[residue], residue, gain)
        return best

    def difference(self, one: _Row, step: _Improvement, two: _Row) -> list[Expr]:
        """one - f two, each entry as a multiple of an existing expression where its value is one."""
        entries = []
        for a, b, x, y in zip(one.entries, two.entries, one.values, two.values, strict=True):
            value = (x - step.residue * y) % self.prime
            known = self._multiple(value, a, b) if y and value else None
            if known is not None:  # made first, so that the difference merges with it, and `verify` repeats that
                self.graph.multiply(known[0], self.graph.constant_ref(known[1]))
            entries.append(a - b * step.factor if y else a)
        return entries

    def _multiple(self, value: int, a: Expr, b: Expr) -> tuple[int, Exact] | None:
        """(reference, n) of an existing expression with n times its value the wanted one, in the symbols of a and b."""
        needs = self.graph.depends[a.ref >> 1] | self.graph.depends[b.ref >> 1]
        for inverse, number in self.multiples:
            ref = self.graph.find(value * inverse % self.prime, needs)
            if ref is not None:
                return ref, number
        return None

    def _new_cost(self, one: _Row, two: _Row, j: int, value: int) -> float:
        """What entry j of a difference with this value costs."""
        if not value or not two.values[j]:
            return one.costs[j] if value else 0.0
        a, b = one.entries[j], two.entries[j]
        if a.constant is not None and b.constant is not None:
            return _CONSTANT
        known = self._multiple(value, a, b)
        if known is not None:
            return self._cost(known[0]) + (0.0 if known[1] == _UNIT else _OPERATION)
        return _ENTRY + _OPERATION * min(self._size(a.ref) + self._size(b.ref) + 2, _LARGEST_SIZE)

    def _cost(self, ref: int) -> float:
        """What an entry costs."""
        if ref == 0:
            return 0.0
        if self.graph.constant_of(ref) is not None:
            return _CONSTANT
        return _ENTRY + _OPERATION * min(self._size(ref), _LARGEST_SIZE)

    def _size(self, ref: int) -> int:
        """Number of arithmetic operations in an expression."""
        node = ref >> 1
        if node not in self.sizes:
            arithmetic = ("add", "sub", "mul", "inv", "sqrt")
            self.sizes[node] = sum(self.graph.code[n][0] in arithmetic for n in self.graph.reachable([ref]))
        return self.sizes[node]


_UNIT = Exact.of(1)


@cache
def _constants(*, wide: bool) -> list[Exact]:
    """Small numbers n/d sqrt(k), the simplest first; of both signs where `wide`."""
    top = 4 if wide else 3
    ratios = {Fraction(n, d) for n in range(1, top + 1) for d in range(1, top + 1)}
    roots = (1, 2, 3, 6) if wide else (1, 3)
    found = []
    for ratio in sorted(ratios, key=lambda r: (r.denominator + r.numerator, r)):
        for k in roots:
            number = Exact.square_root(k) * Exact.of(ratio)
            found += [number, -number] if wide else [number]
    return found
