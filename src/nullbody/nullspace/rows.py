"""Constant row operations that make a constraint Jacobian of expressions cheaper, found by value.

Rows of loop closures are components in some frame; a combination of them in Q or Q(sqrt 2, sqrt 3) is often much
simpler (for the 3-PRS: x' = b cos(theta) theta', 3 y' = l sum cos(alpha_i) alpha_i'). A row operation A_i - f A_s is
tried for every constant f that cancels an entry, and taken where the row becomes cheaper. An entry of the new row
whose value is a small multiple of an existing expression becomes that multiple. Nothing is built before it is chosen.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from typing import NamedTuple

from nullbody.expr import Exact, Expr, Graph
from nullbody.expr.field import Field
from nullbody.expr.graph import ONE
from nullbody.nullspace.plan import Plan, Weights
from nullbody.nullspace.steps import Scale, Shear, Sparse, Step

__all__ = ["RowSearch"]

_LARGEST_SIZE = 30  # more operations than this in an entry cost no more: they are shared anyway
_MOST_STEPS = 4  # for each row
_ROUNDING = 1e-9
_ARITHMETIC = frozenset(("add", "sub", "mul", "inv", "sqrt"))


class RowSearch:
    """Row operations on the rows of one matrix, pass after pass; what is known of its expressions is kept.

    Args:
        plan: weights, noise and seed of the search.
    """

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self._values: _Values | None = None

    def simplified(self, rows: Sequence[Sparse]) -> tuple[list[Step], list[Sparse]]:
        """The row operations in order, and the rows after them; numbers stay as they are."""
        graph = next((entry.graph for row in rows for entry in row.values() if isinstance(entry, Expr)), None)
        if not self.plan.simplify or graph is None:
            return [], list(rows)
        if self._values is None:
            self._values = _Values(graph, self.plan.weights)
        search = _Search(rows, self._values)
        steps: list[Step] = []
        tie = self.plan.tie()
        noise = {pair: 1.0 + self.plan.noise * tie() for pair in search.pairs()}
        gains = {pair: found for pair in noise if (found := search.improvement(*pair)).gain > _ROUNDING}
        while gains and len(steps) < _MOST_STEPS * len(rows):
            i, k = max(gains, key=lambda pair: gains[pair].gain * noise.get(pair, 1.0))
            chosen = gains[i, k]
            search.subtract(i, k, chosen)
            steps.append(Shear(i, k, graph.constant(chosen.factor)))
            gains = {pair: found for pair, found in gains.items() if i not in pair}
            for pair in search.pairs_with(i):
                found = search.improvement(*pair)
                if found.gain > _ROUNDING:
                    gains[pair] = found
        return [*steps, *search.scale()], search.entries()


class _Entry(NamedTuple):
    """A non-zero entry: its reference, its value in the field and the inverse of that, and what it costs."""

    ref: int
    value: int
    inverse: int
    cost: float
    constant: bool


class _Improvement(NamedTuple):
    """The best operation of one row on another: its factor, the factor's value, and what the new row costs less."""

    factor: Exact
    residue: int
    gain: float


_NOTHING = _Improvement(Exact.of(0), 0, 0.0)


class _Known(NamedTuple):
    """An expression that is there already, times a small number, and what that costs."""

    ref: int
    number: Exact
    cost: float


class _Values:
    """What is known of the expressions of a graph by value: sizes, costs, and small multiples of each."""

    def __init__(self, graph: Graph, weights: Weights) -> None:
        self.graph = graph
        self.prime = graph.prime
        self.weights = weights
        self.factors = _residues(graph.prime, wide=True)
        small = _residues(graph.prime, wide=False)
        self._residues, self._numbers = list(small), list(small.values())
        self._sizes: dict[int, int] = {}
        self._known: dict[int, tuple[int, int]] = {}  # value up to sign -> (node, which number)
        self._learnt: set[int] = set()

    def learn(self, node: int) -> None:
        """Remember the small multiples of an expression, but for values that are remembered already."""
        if node in self._learnt or self.graph.constant_of(2 * node) is not None:
            return
        self._learnt.add(node)
        prime, value, remember = self.prime, self.graph.value(2 * node), self._known.setdefault
        for k, residue in enumerate(self._residues):
            key = residue * value % prime
            remember(key if 2 * key < prime else prime - key, (node, k))

    def multiple(self, value: int, symbols: int) -> _Known | None:
        """A small multiple of an expression that has this value up to its sign, and no other symbols."""
        found = self._known.get(value if 2 * value < self.prime else self.prime - value)
        if found is None or self.graph.depends[found[0]] & ~symbols:
            return None
        node, k = found
        return _Known(2 * node, self._numbers[k], self.cost(2 * node) + (self.weights.operation if k else 0.0))

    def cost(self, ref: int) -> float:
        """What an entry costs."""
        if self.graph.constant_of(ref) is not None:
            return self.weights.constant
        return self.weights.entry(self.size(ref >> 1))

    def size(self, node: int) -> int:
        """Number of arithmetic operations in an expression, each counted as often as it is written."""
        sizes, stack = self._sizes, [node]
        while stack:
            top = stack[-1]
            if top in sizes:
                stack.pop()
                continue
            own = self.graph.code[top][0] in _ARITHMETIC
            operands = [ref >> 1 for ref in self.graph.operands(top)] if own else []
            waiting = [operand for operand in operands if operand not in sizes]
            if waiting:
                stack += waiting
            else:
                sizes[stack.pop()] = min(own + sum([sizes[operand] for operand in operands]), _LARGEST_SIZE)
        return sizes[node]


class _Search:
    """The rows on the way: what operations on them would gain, and the operations."""

    def __init__(self, rows: Sequence[Sparse], values: _Values) -> None:
        self.graph, self.prime, self.known = values.graph, values.prime, values
        refs = [
            {j: entry.ref if isinstance(entry, Expr) else self.graph.constant(entry).ref for j, entry in row.items()}
            for row in rows
        ]
        for node in self.graph.reachable(ref for row in refs for ref in row.values()):
            values.learn(node)
        self.rows = [{j: self._entry(ref) for j, ref in row.items()} for row in refs]
        self.places: dict[int, set[int]] = {}
        for i, row in enumerate(self.rows):
            for j in row:
                self.places.setdefault(j, set()).add(i)

    def pairs(self) -> list[tuple[int, int]]:
        """Pairs of rows that share a column."""
        return sorted({(i, k) for members in self.places.values() for i in members for k in members if i != k})

    def pairs_with(self, i: int) -> list[tuple[int, int]]:
        """The pairs that row i is part of."""
        others = sorted({k for j in self.rows[i] for k in self.places[j]} - {i})
        return [pair for k in others for pair in ((i, k), (k, i))]

    def entries(self) -> list[Sparse]:
        """The rows as expressions."""
        return [{j: Expr(self.graph, entry.ref) for j, entry in row.items()} for row in self.rows]

    def improvement(self, i: int, k: int) -> _Improvement:
        """The best factor f for which row i - f row k is cheaper than row i; no gain where there is none."""
        one, two, prime, factors = self.rows[i], self.rows[k], self.prime, self.known.factors
        shared = [(one[j], two[j]) for j in two if j in one]
        candidates = {residue for a, b in shared if (residue := a.value * b.inverse % prime) in factors}
        if not candidates:
            return _NOTHING
        fresh = [entry for j, entry in two.items() if j not in one]
        best, before = _NOTHING, sum([a.cost for a, _ in shared])
        for residue in sorted(candidates):
            values = [(a.value - residue * b.value) % prime for a, b in shared]
            if len(fresh) > 1 + values.count(0):
                continue
            gain = before - sum([self._new_cost(entry, residue) for entry in fresh])
            for (a, b), value in zip(shared, values, strict=True):
                if gain <= best.gain:
                    break
                gain -= self._shared_cost(a, b, value) if value else 0.0
            if gain > best.gain:
                best = _Improvement(factors[residue], residue, gain)
        return best

    def subtract(self, i: int, k: int, step: _Improvement) -> None:
        """Row i minus f times row k, each entry as a multiple of an existing expression where its value is one."""
        graph, row = self.graph, self.rows[i]
        factor = graph.constant_ref(step.factor)
        for j, two in self.rows[k].items():
            one = row.get(j)
            value = ((one.value if one else 0) - step.residue * two.value) % self.prime
            if value and (known := self._multiple(value, one, two)) is not None:
                # made first, so that the difference merges with it, and `verify` repeats that
                graph.multiply(known.ref, graph.constant_ref(known.number))
            difference = graph.negate(graph.multiply(factor, two.ref))
            ref = graph.add(one.ref, difference) if one else difference
            if ref:
                self.known.learn(ref >> 1)
                row[j] = self._entry(ref)
                self.places[j].add(i)
            else:
                del row[j]
                self.places[j].discard(i)

    def scale(self) -> list[Scale]:
        """Rid every row of the constant factor that most of its entries have."""
        steps = []
        for i, row in enumerate(self.rows):
            split = {j: self._split(entry.ref) for j, entry in row.items()}
            counts = Counter(-factor if factor.negative else factor for factor, _ in split.values())
            best = max(counts, key=lambda factor: (counts[factor], factor == _UNIT, str(factor)), default=_UNIT)
            if best != _UNIT:
                inverse = best.inverse()
                for j, (factor, ref) in split.items():
                    row[j] = self._entry(self.graph.multiply(self.graph.constant_ref(factor * inverse), ref))
                steps.append(Scale(i, self.graph.constant(inverse)))
        return steps

    def _split(self, ref: int) -> tuple[Exact, int]:
        """A product as a constant and the rest, wherever in the product the constants stand."""
        constant = self.graph.constant_of(ref)
        if constant is not None:
            return constant, ONE
        op, a, b = self.graph.code[ref >> 1]
        if op != "mul":
            return _UNIT, ref
        (one, left), (two, right) = self._split(a), self._split(b)
        product = one if two is _UNIT else two if one is _UNIT else one * two
        if product is _UNIT or product == _UNIT:
            return _UNIT, ref
        return (-product if ref & 1 else product), self.graph.multiply(left, right)

    def _shared_cost(self, one: _Entry, two: _Entry, value: int) -> float:
        """What an entry with this value, a difference of two entries, costs."""
        if one.constant and two.constant:
            return self.known.weights.constant
        known = self._multiple(value, one, two)
        if known is not None:
            return known.cost
        size = self.known.size(one.ref >> 1) + self.known.size(two.ref >> 1) + 2
        return self.known.weights.entry(min(size, _LARGEST_SIZE))

    def _new_cost(self, two: _Entry, residue: int) -> float:
        """What the multiple of an entry costs where there was none."""
        if two.constant:
            return self.known.weights.constant
        known = self._multiple(residue * two.value % self.prime, None, two)
        return known.cost if known else two.cost + self.known.weights.operation

    def _multiple(self, value: int, one: _Entry | None, two: _Entry) -> _Known | None:
        """A small multiple of an existing expression with this value, in the symbols of the two entries."""
        depends = self.graph.depends
        return self.known.multiple(value, depends[two.ref >> 1] | (depends[one.ref >> 1] if one else 0))

    def _entry(self, ref: int) -> _Entry:
        value = self.graph.value(ref)
        constant = self.graph.constant_of(ref) is not None
        return _Entry(ref, value, pow(value, -1, self.prime), self.known.cost(ref), constant)


_UNIT = Exact.of(1)


@cache
def _residues(prime: int, *, wide: bool) -> dict[int, Exact]:
    """Small numbers n/d sqrt(k) by their value in the field, the simplest first; of both signs where `wide`."""
    top = 4 if wide else 3
    ratios = {Fraction(n, d) for n in range(1, top + 1) for d in range(1, top + 1)}
    roots = (1, 2, 3, 6) if wide else (1, 3)
    found = []
    for ratio in sorted(ratios, key=lambda r: (r.denominator + r.numerator, r)):
        for k in roots:
            number = Exact.square_root(k) * Exact.of(ratio)
            found += [number, -number] if wide else [number]
    field = Field(prime)
    return {field.constant(number): number for number in found}
