"""The matrices of the benchmark, with symbols and with numbers.

3-PRS                   9 x 12; generic: every entry that is no constant is a symbol of its own (32); trigonometric: as
                        functions of the coordinates and lengths, [26]
chain, relative         N four-bars in a row, each driven by the one before: 2N x (2N + 1), one degree of freedom
chain, absolute         the same with three coordinates for each link, each four-bar standing on the coupler of the one
                        before: 8N x 9N, N degrees of freedom, block lower triangular
random                  dense, sparse, banded

Entries of the chains are +-1 or symbols of their own, so that a count of operations depends on the structure only.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from nullbody.bench.robot import INPUTS, random_states
from nullbody.expr import Expr, Graph, Tape
from nullbody.kernels.reference import FUNCTIONS
from nullbody.typing import FloatArray

__all__ = [
    "Matrix",
    "absolute_chain",
    "random_banded",
    "random_dense",
    "random_sparse",
    "relative_chain",
    "three_prs_generic",
    "three_prs_trigonometric",
]


_Pattern = np.ndarray[Any, np.dtype[np.bool_]]


@dataclass(frozen=True)
class Matrix:
    """A, m x n of full row rank, in a graph of its own.

    Attributes:
        name: for tables.
        rows: the entries.
        independent: columns that stay free.
        inputs: names of the symbols, in the order of the values that `numbers` takes.
        sample: (generator, count) -> values of the symbols, count x inputs.
    """

    name: str
    rows: tuple[tuple[Expr, ...], ...]
    independent: tuple[int, ...]
    inputs: tuple[str, ...]
    sample: Callable[[np.random.Generator, int], FloatArray]

    @property
    def shape(self) -> tuple[int, int]:
        """(m, n)"""
        return len(self.rows), len(self.rows[0])

    @property
    def entries(self) -> int:
        """How many entries are not 0."""
        return sum(entry != 0 for row in self.rows for entry in row)

    @property
    def order(self) -> tuple[int, ...]:
        """All columns, the independent ones last."""
        return (*(j for j in range(self.shape[1]) if j not in self.independent), *self.independent)

    def numbers(self, values: FloatArray) -> FloatArray:
        """A for many values of the symbols: (count x inputs) -> count x m x n."""
        tape = Tape.of([entry for row in self.rows for entry in row], self.inputs)
        found = tape.run(list(np.asarray(values, dtype=np.float64).T), FUNCTIONS)
        columns = [np.broadcast_to(np.asarray(entry, dtype=np.float64), len(values)) for entry in found]
        return np.ascontiguousarray(np.stack(columns, axis=1).reshape(len(values), *self.shape))

    def values(self, numbers: FloatArray) -> FloatArray:
        """The values of the symbols, for a matrix whose symbols are entries: count x m x n -> count x inputs."""
        place = {entry.name: (i, j) for i, row in enumerate(self.rows) for j, entry in enumerate(row) if entry.name}
        return np.stack([numbers[:, *place[name]] for name in self.inputs], axis=1)

    def samples(self, count: int, seed: int = 0) -> FloatArray:
        """Numbers for A at random values of its symbols, count x m x n."""
        return self.numbers(self.sample(np.random.default_rng(seed), count))

    def __repr__(self) -> str:
        m, n = self.shape
        return f"<Matrix {self.name}: {m} x {n}, {self.entries} entries, {len(self.inputs)} symbols>"


def three_prs_trigonometric() -> Matrix:
    """A of the 3-PRS as functions of (q, a, b, l): sines, cosines and sqrt(3); sampled on the robot's own states."""
    from nullbody.catalog import three_prs
    from nullbody.equations.closure import closures
    from nullbody.equations.motion import MotionExpressions

    mechanism = three_prs()
    graph = Graph()
    A = closures(mechanism, MotionExpressions.of(mechanism, graph)).A

    def sample(random: np.random.Generator, count: int) -> FloatArray:
        return random_states(random, count, made.numbers)

    made = Matrix("3-PRS trigonometric", _tuples(A, graph), (9, 10, 11), INPUTS, sample)
    return made


def three_prs_generic() -> Matrix:
    """A of the 3-PRS with a symbol for every entry that is no constant; sampled on the robot's own states.

    There the leading 6 x 6 minor of B vanishes, which symbols of their own do not show.
    """
    source = three_prs_trigonometric()
    graph = Graph()
    places = [(i, j) for i, j in np.ndindex(source.shape) if source.rows[i][j].constant is None]
    rows = [[_constant(graph, entry) for entry in row] for row in source.rows]
    for i, j in places:
        rows[i][j] = graph.symbol(f"A_{i}_{j}")

    def sample(random: np.random.Generator, count: int) -> FloatArray:
        numbers = source.numbers(source.sample(random, count))
        return np.stack([numbers[:, i, j] for i, j in places], axis=1)

    return Matrix("3-PRS generic", _tuples(rows, graph), source.independent, tuple(graph.symbols), sample)


def relative_chain(count: int) -> Matrix:
    """Closures of four-bars in relative angles: two rows each with crank, coupler and output; outputs drive on.

    Columns: (coupler, output) of each four-bar, then the crank of the first, which is independent.
    """
    chain = _Chain(2 * count + 1)
    for k in range(count):
        crank = 2 * count if k == 0 else 2 * k - 1
        chain.row_pair({}, {crank: ("crank", k), 2 * k: ("coupler", k), 2 * k + 1: ("rocker", k)})
    return chain.matrix(f"chain of {count}, relative", (2 * count,))


def absolute_chain(count: int) -> Matrix:
    """Closures of four-bars in (x, y, angle) of crank, coupler and rocker; four-bar k stands on coupler k - 1.

    Crank and rocker are measured at their joints with the base, the coupler at its joint with the crank. Rows, two
    each: crank and base, crank and coupler, coupler and rocker, rocker and base. The cranks' angles are independent.
    """
    chain = _Chain(9 * count)
    for k in range(count):
        crank, coupler, rocker, base = 9 * k, 9 * k + 3, 9 * k + 6, 9 * k - 6
        ground, left, right = (
            ({}, {}, {}) if k == 0 else ({base: -1}, {base + 2: ("left", k)}, {base + 2: ("right", k)})
        )
        chain.row_pair({crank: 1} | ground, left)
        chain.row_pair({crank: 1, coupler: -1}, {crank + 2: ("crank", k)})
        chain.row_pair({coupler: 1, rocker: -1}, {coupler + 2: ("coupler", k), rocker + 2: ("rocker", k)})
        chain.row_pair({rocker: 1} | ground, right)
    return chain.matrix(f"chain of {count}, absolute", tuple(9 * k + 2 for k in range(count)))


class _Chain:
    """The closures of four-bars, written down pair by pair.

    Args:
        columns: of A.
    """

    def __init__(self, columns: int) -> None:
        self._graph = Graph()
        self._columns = columns
        self._rows: list[list[Any]] = []
        self._arms: list[tuple[str, int, int]] = []  # of each symbol: role, four-bar, axis

    def row_pair(self, positions: Mapping[int, int], arms: Mapping[int, tuple[str, int]]) -> None:
        """Rows along x and y: +-1 in the columns of x (and y, the next one), arms in those of angles."""
        for axis in (0, 1):
            row: list[Any] = [0] * self._columns
            for column, sign in positions.items():
                row[column + axis] = sign
            for column, (role, k) in arms.items():
                row[column] = self._graph.symbol(f"{role}{k + 1}_{'xy'[axis]}")
                self._arms.append((role, k, axis))
            self._rows.append(row)

    def matrix(self, name: str, independent: tuple[int, ...]) -> Matrix:
        """The matrix; its samples are arms of nearly parallel cranks and rockers, so that motions do not grow."""
        arms = tuple(self._arms)
        links = 1 + max(k for _, k, _ in arms)

        def sample(random: np.random.Generator, count: int) -> FloatArray:
            crank = random.uniform(0.3, 0.7, (count, links)) * np.pi
            angles = {"crank": crank, "rocker": crank + np.pi + random.uniform(-0.1, 0.1, (count, links))}
            angles["coupler"] = random.uniform(-0.2, 0.2, (count, links))
            angles |= {side: random.uniform(-np.pi, np.pi, (count, links)) for side in ("left", "right")}
            turned = [(angles[role][:, k], axis) for role, k, axis in arms]
            return np.stack([np.cos(angle) if axis else -np.sin(angle) for angle, axis in turned], axis=1)

        return Matrix(name, _tuples(self._rows, self._graph), independent, tuple(self._graph.symbols), sample)


def random_dense(rows: int, columns: int) -> Matrix:
    """A symbol in every place; the last columns independent."""
    return _pattern(f"random dense {rows} x {columns}", np.ones((rows, columns), dtype=bool), range(rows, columns))


def random_sparse(rows: int, columns: int, entries: int = 3, seed: int = 0) -> Matrix:
    """`entries` symbols in each row: one on the diagonal, the others anywhere; the last columns independent."""
    random = np.random.default_rng(seed)
    filled = np.eye(rows, columns, dtype=bool)
    for row in filled:
        row[random.choice(columns, entries - 1, replace=False)] = True
    return _pattern(f"random sparse {rows} x {columns}", filled, range(rows, columns))


def random_banded(rows: int, columns: int, width: int = 4) -> Matrix:
    """`width` symbols side by side in each row, along the diagonal; independent is what a matching leaves over."""
    filled = np.zeros((rows, columns), dtype=bool)
    for i in range(rows):
        start = round(i * (columns - width) / max(1, rows - 1))
        filled[i, start : start + width] = True
    return _pattern(f"random banded {rows} x {columns}", filled, _unmatched(filled))


def _pattern(name: str, filled: _Pattern, independent: Sequence[int]) -> Matrix:
    """A symbol in every filled place, sampled between 1/2 and 3/2 with random signs."""
    graph = Graph()
    rows = [[graph.symbol(f"r_{i}_{j}") if full else 0 for j, full in enumerate(row)] for i, row in enumerate(filled)]
    inputs = tuple(graph.symbols)

    def sample(random: np.random.Generator, states: int) -> FloatArray:
        shape = states, len(inputs)
        found: FloatArray = random.uniform(0.5, 1.5, shape) * random.choice((-1.0, 1.0), shape)
        return found

    return Matrix(name, _tuples(rows, graph), tuple(independent), inputs, sample)


def _unmatched(filled: _Pattern) -> tuple[int, ...]:
    """The columns that a maximum matching leaves over."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_bipartite_matching

    matched = set(maximum_bipartite_matching(csr_array(filled), perm_type="column").tolist())
    return tuple(j for j in range(filled.shape[1]) if j not in matched)


def _tuples(rows: Sequence[Sequence[Any]], graph: Graph) -> tuple[tuple[Expr, ...], ...]:
    zero = graph.constant(0)
    return tuple(tuple(zero + entry for entry in row) for row in rows)


def _constant(graph: Graph, entry: Expr) -> Any:
    return 0 if entry.constant is None else graph.constant(entry.constant)
