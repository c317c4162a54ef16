"""Constant row operations that make a constraint Jacobian of expressions cheaper, found by value.

Rows of loop closures are components in some frame; a combination of them in Q or Q(sqrt 3) is often much
simpler (for the 3-PRS: the components across each leg's plane, and the sums over the legs). A row operation
A_i - f A_s is tried for every constant f that cancels an entry, and taken where the row becomes cheaper. An entry
of the new row whose value is a small multiple of an existing expression becomes that multiple.
"""

from __future__ import annotations

from collections.abc import Iterator
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
    rows = [list(row) for row in matrix]
    if not rows or not rows[0]:
        return rows, []
    search = _Search(rows[0][0].graph)
    steps: list[RowStep] = []
    pairs = [(i, k) for i in range(len(rows)) for k in range(len(rows)) if i != k]
    best = {pair: search.improvement(rows, *pair) for pair in pairs}
    while len(steps) < _MOST_STEPS * len(rows):
        pair = max(pairs, key=lambda pair: best[pair].gain, default=None)
        if pair is None or best[pair].gain <= 0:
            break
        rows[pair[0]] = best[pair].entries
        steps.append((*pair, search.graph.constant(best[pair].factor)))
        for other in pairs:
            if pair[0] in other:
                best[other] = search.improvement(rows, *other)
    return rows, steps


class _Improvement(NamedTuple):
    """The best operation of one row on another: its factor, the new entries, and what they cost less."""

    factor: Exact
    entries: list[Expr]
    gain: float


class _Search:
    """Row operations on expressions of one graph, judged by their values."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.prime = graph.prime
        self.sizes: dict[int, int] = {}
        self.factors = {graph.residue(number): number for number in _constants(wide=True)}
        self.multiples = [(pow(graph.residue(number), -1, self.prime), number) for number in _constants(wide=False)]

    def improvement(self, rows: list[list[Expr]], i: int, k: int) -> _Improvement:
        """The best factor f for which row i - f row k is cheaper than row i; no gain where there is none."""
        best = _Improvement(Exact.of(0), [], 0.0)
        one = [self.graph.value(entry.ref) for entry in rows[i]]
        two = [self.graph.value(entry.ref) for entry in rows[k]]
        before = self.cost(rows[i])
        for residue, factor in self._cancelling(one, two):
            zeros = sum((a - residue * b) % self.prime == 0 for a, b in zip(one, two, strict=True))
            if zeros < one.count(0) - 1:
                continue
            entries = [self._less(a, residue, factor, b) for a, b in zip(rows[i], rows[k], strict=True)]
            gain = before - self.cost(entries)
            if gain > max(best.gain, _ROUNDING):
                best = _Improvement(factor, entries, gain)
        return best

    def cost(self, row: list[Expr]) -> float:
        """What the entries of a row cost."""
        return sum(self._entry_cost(entry) for entry in row)

    def _entry_cost(self, entry: Expr) -> float:
        if entry.ref == 0:
            return 0.0
        if entry.constant is not None:
            return _CONSTANT
        node = entry.ref >> 1
        if node not in self.sizes:
            arithmetic = ("add", "sub", "mul", "inv", "sqrt")
            self.sizes[node] = sum(self.graph.code[n][0] in arithmetic for n in self.graph.reachable([entry.ref]))
        return _ENTRY + _OPERATION * min(self.sizes[node], _LARGEST_SIZE)

    def _cancelling(self, one: list[int], two: list[int]) -> Iterator[tuple[int, Exact]]:
        """The constants f, with their residues, for which some entry of one - f two vanishes."""
        seen: set[int] = set()
        for a, b in zip(one, two, strict=True):
            if a == 0 or b == 0:
                continue
            residue = a * pow(b, -1, self.prime) % self.prime
            if residue not in seen and residue in self.factors:
                seen.add(residue)
                yield residue, self.factors[residue]

    def _less(self, a: Expr, residue: int, factor: Exact, b: Expr) -> Expr:
        """a - factor b, as a multiple of an existing expression where its value is one."""
        if b.ref == 0:
            return a
        value = (self.graph.value(a.ref) - residue * self.graph.value(b.ref)) % self.prime
        if value == 0:
            return self.graph.constant(0)
        needs = self.graph.depends[a.ref >> 1] | self.graph.depends[b.ref >> 1]
        for inverse, number in self.multiples:
            ref = self.graph.find(value * inverse % self.prime, needs)
            if ref is not None:
                return Expr(self.graph, ref) * number
        return a - b * factor


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
