"""B x = r for a square matrix: constant pivots, block-triangular form, minors inside the blocks.

Only constants are ever divided by, and in the end each block's determinant, once. The scaled solution
|B| x = adj(B) r divides by no expression at all. Blocks that are too large for minors are eliminated by pivots that
are expressions, as is everything where the fewest operations are wanted (method "elimination").
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from nullbody.expr.matrix import dot, total
from nullbody.nullspace.minors import Minors, parity
from nullbody.nullspace.order import chosen_lines
from nullbody.nullspace.pivots import Pivot, eliminated
from nullbody.nullspace.plan import DEFAULT, Plan
from nullbody.nullspace.rows import RowSearch
from nullbody.nullspace.scalar import is_zero, reciprocal
from nullbody.nullspace.steps import Scale, Sparse, Step, combined, forward, transposed
from nullbody.nullspace.structure import block_triangular

__all__ = ["Block", "Elimination", "eliminate"]


@dataclass(frozen=True)
class Block:
    """An irreducible diagonal block: K x = y by x = adj(K) y / |K|.

    Attributes:
        rows, columns: where it stands.
        matrix: K.
        minors: its minors.
        many: whether there are more right-hand sides than rows.
    """

    rows: tuple[int, ...]
    columns: tuple[int, ...]
    matrix: tuple[tuple[Any, ...], ...]
    minors: Minors
    many: bool

    plain = False

    @cached_property
    def value(self) -> Any:
        """|K|"""
        return self.minors.determinant

    @cached_property
    def inverse(self) -> Any:
        """1 / |K|"""
        return reciprocal(self.value)

    def solved(self, y: Sparse) -> Sparse:
        """K^-1 y, by column: adj(K) y / |K|, or (adj(K) / |K|) y where many right-hand sides share that."""
        if self.many:
            return {j: value for j, value in self._sums(y, self._inverse_entry).items() if not is_zero(value)}
        return {j: value * self.inverse for j, value in self.scaled(y).items() if not is_zero(value)}

    def _inverse_entry(self, row: int, column: int) -> Any:
        key = row, column
        if key not in self._entries:
            cofactor = self.minors.cofactor(row, column)
            self._entries[key] = cofactor if is_zero(cofactor) else cofactor * self.inverse
        return self._entries[key]

    @cached_property
    def _entries(self) -> dict[tuple[int, int], Any]:
        return {}

    def _sums(self, y: Sparse, entry: Callable[[int, int], Any]) -> Sparse:
        return {
            column: combined(*((entry(r, k), y[row]) for r, row in enumerate(self.rows) if row in y))
            for k, column in enumerate(self.columns)
        }

    def scaled(self, y: Sparse) -> Sparse:
        """adj(K) y, by column."""
        return self._sums(y, self.minors.cofactor)

    def scaled_transposed(self, y: Sparse) -> Sparse:
        """adj(K)^T y, by row."""
        return {
            row: combined(*((self.minors.cofactor(r, k), y[c]) for k, c in enumerate(self.columns) if c in y))
            for r, row in enumerate(self.rows)
        }

    @property
    def doubt(self) -> Any:
        """(product of K's column lengths)^2 / |K|^2 (Hadamard): 1 at best, 1e30 where |K| is rounding."""
        product: Any = 1
        for column in zip(*self.matrix, strict=True):
            product = dot(column, column) * product
        return product * (self.inverse * self.inverse)


#: One step of the solution: unknowns that depend on each other.
Stage = Pivot | Block


@dataclass(frozen=True)
class Elimination:
    """The factors of a square matrix B.

    Attributes:
        delta: |B|; 0 where B is singular as a matrix of expressions.
        unknowns: the columns of B, in order.
        stages: pivots and blocks; each needs the solutions of those after it only.
        rows: the whole matrix after the steps, the rows by column.
        steps: the row operations, in order.
        simplified: the whole matrix after the first `simplifications` steps, which are constant.
    """

    delta: Any
    unknowns: tuple[int, ...]
    stages: tuple[Stage, ...]
    rows: tuple[Sparse, ...]
    steps: tuple[Step, ...]
    simplified: tuple[Sparse, ...]
    simplifications: int

    def solve(self, right: Sequence[Any], *, of_simplified: bool = False) -> list[Any]:
        """x = B^-1 r, with one reciprocal for each block; shared by all right-hand sides of a graph.

        Args:
            right: r, one entry for each row of the matrix, or of `simplified`.
            of_simplified: whether it belongs to `simplified`.
        """
        return self._solved(self._forward(right, of_simplified))

    def solve_scaled(self, right: Sequence[Any], *, of_simplified: bool = False) -> list[Any]:
        """|B| x = adj(B) r, without any division by an expression; arguments as `solve`."""
        return self._solved_scaled(self._forward(right, of_simplified))

    def solve_column(self, j: int) -> list[Any]:
        """B^-1 times column j of the matrix."""
        return self._solved({i: row[j] for i, row in enumerate(self.rows) if j in row})

    def solve_column_scaled(self, j: int) -> list[Any]:
        """adj(B) times column j of the matrix."""
        return self._solved_scaled({i: row[j] for i, row in enumerate(self.rows) if j in row})

    def _solved(self, work: Sparse) -> list[Any]:
        x: Sparse = {}
        for stage in reversed(self.stages):
            y = self._remaining(stage, work, x)
            if y:
                x |= stage.solved(y)
        return [x.get(j, 0) for j in self.unknowns]

    def _solved_scaled(self, work: Sparse) -> list[Any]:
        """Every unknown times the determinants of the stages that it depends on, in the end brought to |B|.

        x[j] is the true unknown times the determinants of the stages in scale[j]. Before a stage is solved, all that it
        needs is lifted to the union of these sets; its own unknowns then carry that union and its own determinant. The
        constant and the determinants that are missing come last.
        """
        x: Sparse = {}
        scale: dict[int, frozenset[int]] = {}
        for k in reversed(range(len(self.stages))):
            stage = self.stages[k]
            near = {j for i in stage.rows for j in self.rows[i] if j in x}
            common = frozenset().union(*(scale[j] for j in near))
            known = {j: self._product(common - scale[j], x[j]) for j in near}
            lifted = {i: self._product(common, work[i]) for i in stage.rows if i in work}
            y = self._remaining(stage, lifted, known)
            if not y:
                continue
            solved, own = stage.scaled(y), common | {k}
            if stage.plain:
                solved, own = {j: value * stage.inverse for j, value in solved.items()}, common
            for j, value in solved.items():
                if not is_zero(value):
                    x[j], scale[j] = value, own
        everything = frozenset(k for k, stage in enumerate(self.stages) if not stage.plain)
        return [self._constant * self._product(everything - scale[j], x[j]) if j in x else 0 for j in self.unknowns]

    def solve_transposed(self, right: Sequence[Any]) -> list[Any]:
        """y = B^-T r, with one reciprocal for each block."""
        work = {j: value for j, value in zip(self.unknowns, right, strict=True) if not is_zero(value)}
        y: Sparse = {}
        for stage in self.stages:
            for i, value in stage.scaled_transposed({j: work[j] for j in stage.columns if j in work}).items():
                if is_zero(value):
                    continue
                y[i] = value * stage.inverse
                for j, entry in self.rows[i].items():
                    if j not in stage.columns:
                        work[j] = total((work.get(j, 0), -(entry * y[i])))
        transposed(self.steps, y)
        return [y.get(i, 0) for i in range(len(self.rows))]

    @property
    def eliminated(self) -> bool:
        """Whether a pivot is an expression, which may vanish where |B| does not."""
        return any(isinstance(stage, Pivot) and not stage.plain for stage in self.stages)

    @property
    def doubt(self) -> Any:
        """Sum over the stages of how near each determinant is to rounding; 1e28 where nothing is left of it."""
        return total(stage.doubt for stage in self.stages)

    def _forward(self, right: Sequence[Any], of_simplified: bool) -> Sparse:
        work = {i: value for i, value in enumerate(right) if not is_zero(value)}
        forward(self.steps[self.simplifications if of_simplified else 0 :], work)
        return work

    def _remaining(self, stage: Stage, work: Sparse, x: Sparse) -> Sparse:
        """The right-hand side of a stage: what is left after the unknowns that are known."""
        found = {}
        for i in stage.rows:
            known: Any = None
            for j, entry in self.rows[i].items():
                if j in x:
                    term = entry * x[j]
                    known = term if known is None else known + term
            value = work.get(i)
            if known is not None:
                value = -known if value is None else value - known
            if value is not None and not is_zero(value):
                found[i] = value
        return found

    def _product(self, stages: frozenset[int], factor: Any) -> Any:
        """The factor times the determinants of some stages.

        A product that is known is extended at its end, else the first determinant is split off: so prefixes and
        suffixes are shared.
        """
        if not stages or is_zero(factor):
            return factor
        if stages not in self._products:
            first, rest = min(stages), stages - {min(stages)}
            tail, head = max(stages), stages - {max(stages)}
            if head in self._products or len(stages) == 1:
                self._products[stages] = self._product(head, self.stages[tail].value)
            else:
                self._products[stages] = self._product(rest, self.stages[first].value)
        return self._products[stages] * factor

    @cached_property
    def _products(self) -> dict[frozenset[int], Any]:
        return {}

    @property
    def determinant(self) -> Any:
        """|B|, from the stages."""
        result = self._constant
        for stage in self.stages:
            if not stage.plain:
                result = 0 if is_zero(stage.value) else stage.value * result
        return result

    @cached_property
    def _constant(self) -> Any:
        """|B| = constant * product of the determinants that are no constants."""
        order = [i for stage in self.stages for i in stage.rows]
        columns = [j for stage in self.stages for j in stage.columns]
        result: Any = parity(order) * parity(columns)
        for step in self.steps:
            if isinstance(step, Scale):
                result = reciprocal(step.factor) * result
        for stage in self.stages:
            if stage.plain:
                result = stage.value * result
        return result


def eliminate(matrix: Sequence[Sparse], dependent: Sequence[int] | None = None, plan: Plan = DEFAULT) -> Elimination:
    """Factor the columns B of a matrix [B | C]; `delta` is 0 where B is singular or structurally singular.

    Args:
        matrix: m x n, independent rows, without their zeros.
        dependent: the m columns of B, in order; all of them by default.
        plan: how, where there is a choice.
    """
    unknowns = tuple(range(len(matrix))) if dependent is None else tuple(dependent)
    search = RowSearch(plan)
    steps, simplified = search.simplified(matrix)
    rows = [dict(row) for row in simplified]
    work = _Work(rows, unknowns, search, list(steps))
    regular = work.factored()
    found = Elimination(0, unknowns, tuple(work.stages), tuple(rows), tuple(work.steps), tuple(simplified), len(steps))
    return replace(found, delta=found.determinant) if regular else found


class _Work:
    """A matrix on its way to block-triangular form: its rows are changed, stages and steps are written down."""

    def __init__(self, rows: list[Sparse], unknowns: Sequence[int], search: RowSearch, steps: list[Step]) -> None:
        self.rows = rows
        self.search = search
        self.plan = search.plan
        self.tie = search.plan.tie()
        self.stages: list[Stage] = []
        self.steps = steps
        self.left = list(range(len(rows)))
        self.open = list(unknowns)
        self.rights = len({j for row in rows for j in row}) - len(self.open)

    def factored(self) -> bool:
        """Constants, then blocks; False where B is singular."""
        self.pivot(self.left, self.open, constants=True)
        if self.stages and self.left and self.simplify():
            self.pivot(self.left, self.open, constants=True)
        place = {j: k for k, j in enumerate(self.open)}
        left, columns = self.left, self.open
        blocks = block_triangular([[place[j] for j in self.rows[i] if j in place] for i in left])
        if blocks is None:
            return False
        for block_rows, block_columns in blocks:
            r, c = [left[k] for k in block_rows], [columns[k] for k in block_columns]
            if len(r) <= self.plan.largest:
                self.stages.append(self.block(r, c))
            elif self.pivot(r, c, constants=False) < len(r):
                return False
        return True

    def pivot(self, rows: Sequence[int], columns: Sequence[int], *, constants: bool) -> int:
        """Take pivots as long as there are any; return how many."""
        sizes = None if constants else self.plan.sizes
        pivots, made = eliminated(self.rows, rows, columns, self.tie, constants=constants, sizes=sizes)
        self.stages += pivots
        self.steps += made
        used = {i for p in pivots for i in p.rows}, {j for p in pivots for j in p.columns}
        self.left = [i for i in self.left if i not in used[0]]
        self.open = [j for j in self.open if j not in used[1]]
        return len(pivots)

    def simplify(self) -> bool:
        """Constant row operations on the rows that are left; whether there were any."""
        steps, rows = self.search.simplified([self.rows[i] for i in self.left])
        for i, row in zip(self.left, rows, strict=True):
            self.rows[i] = row
        self.steps += [step.moved(self.left) for step in steps]
        return bool(steps)

    def block(self, r: Sequence[int], c: Sequence[int]) -> Block:
        """A block by minors; right-hand sides enter its rows with entries outside of it."""
        matrix = tuple(tuple(self.rows[i].get(j, 0) for j in c) for i in r)
        driven = {k for k, i in enumerate(r) if self.plan.offsets or not self.rows[i].keys() <= set(c)}
        lines = chosen_lines(matrix, driven, self.plan.seed)
        many = self.rights > len(r)
        return Block(tuple(r), tuple(c), matrix, Minors(matrix, lines.order, by_rows=lines.by_rows), many)
