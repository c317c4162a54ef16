"""B x = r for a square matrix of expressions: constant pivots, block-triangular form, minors inside the blocks.

Only constants are ever divided by, and in the end each block's determinant, once. The scaled solution
|B| x = adj(B) r divides by no expression at all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.expr.matrix import Matrix, dot, total
from nullbody.nullspace.minors import adjugate, parity
from nullbody.nullspace.rows import RowStep
from nullbody.nullspace.scalar import is_constant, is_zero, reciprocal
from nullbody.nullspace.structure import block_triangular

__all__ = ["Elimination", "eliminate"]


@dataclass(frozen=True)
class _Pivot:
    """A constant pivot: row and column of B, and 1 / pivot."""

    row: int
    column: int
    inverse: Any


@dataclass(frozen=True)
class _Block:
    """An irreducible diagonal block with its adjugate and determinant."""

    rows: tuple[int, ...]
    columns: tuple[int, ...]
    adjugate: tuple[tuple[Any, ...], ...]
    delta: Any


@dataclass(frozen=True)
class Elimination:
    """The factors of a square matrix B.

    Attributes:
        delta: |B|; 0 where B is singular as a matrix of expressions.
        pivots: constant pivots, in order.
        blocks: irreducible blocks, each depending on later ones only.
    """

    delta: Any
    pivots: tuple[_Pivot, ...]
    blocks: tuple[_Block, ...]
    _matrix: tuple[tuple[Any, ...], ...]
    _steps: tuple[tuple[int, int, Any], ...]

    def solve(self, right: Sequence[Any], skip: int = 0) -> list[Any]:
        """x = B^-1 r, with one reciprocal for each block; shared by all right-hand sides of a graph.

        Args:
            right: r, after the first `skip` row operations.
            skip: how many of the steps given to `eliminate` it has gone through.
        """
        work = self._forward(right, skip)
        x: list[Any] = [0] * len(work)
        for block in reversed(self.blocks):
            y = self._block_right(block, work, x)
            inverse = reciprocal(block.delta)
            for i, column in enumerate(block.columns):
                numerator = dot(block.adjugate[i], y)
                x[column] = 0 if is_zero(numerator) else numerator * inverse
        for pivot in self.pivots:
            x[pivot.column] = total((work[pivot.row], self._beyond(pivot, x))) * pivot.inverse
        return x

    def solve_scaled(self, right: Sequence[Any], skip: int = 0) -> list[Any]:
        """|B| x = adj(B) r, without any division by an expression; arguments as `solve`."""
        work = self._forward(right, skip)
        x: list[Any] = [0] * len(work)
        factor: Any = self._constant
        for block in reversed(self.blocks):
            y = self._block_right(block, [0 if is_zero(w) else w * factor for w in work], x)
            x = [0 if is_zero(value) else value * block.delta for value in x]
            for i, column in enumerate(block.columns):
                x[column] = dot(block.adjugate[i], y)
            factor = factor * block.delta
        for pivot in self.pivots:
            own = work[pivot.row]
            own = 0 if is_zero(own) else own * factor
            x[pivot.column] = total((own, self._beyond(pivot, x))) * pivot.inverse
        return x

    def solve_transposed(self, right: Sequence[Any]) -> list[Any]:
        """y = B^-T r, with one reciprocal for each block."""
        work = list(right)
        y: list[Any] = [0] * len(work)
        for pivot in self.pivots:
            y[pivot.row] = work[pivot.column] * pivot.inverse
            for column in self._core:
                work[column] = _less(work[column], self._matrix[pivot.row][column], y[pivot.row])
        for block in self.blocks:
            inverse = reciprocal(block.delta)
            part = [work[column] for column in block.columns]
            for k, row in enumerate(block.rows):
                numerator = dot([adj_row[k] for adj_row in block.adjugate], part)
                y[row] = 0 if is_zero(numerator) else numerator * inverse
            for column in self._core:
                if column not in block.columns:
                    for row in block.rows:
                        work[column] = _less(work[column], self._matrix[row][column], y[row])
        for row, source, factor in reversed(self._steps):
            y[source] = _less(y[source], factor, y[row])
        return y

    @property
    def doubt(self) -> Any:
        """Sum over the blocks of (product of column lengths)^2 / delta^2 (Hadamard): 1 at best, 1e30 where 0/0.

        A block whose determinant is at rounding level gives an arbitrary solution, however small that looks.
        """
        terms = []
        for block in self.blocks:
            product: Any = 1
            for column in block.columns:
                entries = [self._matrix[row][column] for row in block.rows]
                product = dot(entries, entries) * product
            inverse = reciprocal(block.delta)
            terms.append(product * (inverse * inverse))
        return total(terms)

    @property
    def _core(self) -> list[int]:
        return [column for block in self.blocks for column in block.columns]

    @property
    def _constant(self) -> Any:
        """|B| = constant * product of the blocks' determinants: the signed product of the pivots."""
        rows = [p.row for p in self.pivots] + [r for block in self.blocks for r in block.rows]
        columns = [p.column for p in self.pivots] + [c for block in self.blocks for c in block.columns]
        result: Any = parity(rows) * parity(columns)
        for pivot in self.pivots:
            result = reciprocal(pivot.inverse) * result
        return result

    def _forward(self, right: Sequence[Any], skip: int) -> list[Any]:
        work = list(right)
        for row, source, factor in self._steps[skip:]:
            work[row] = _less(work[row], factor, work[source])
        return work

    def _block_right(self, block: _Block, work: Sequence[Any], x: Sequence[Any]) -> list[Any]:
        return [
            total((work[row], -dot([self._matrix[row][c] for c in self._core], [x[c] for c in self._core])))
            for row in block.rows
        ]

    def _beyond(self, pivot: _Pivot, x: Sequence[Any]) -> Any:
        """Minus the part of the pivot's row that lies in the core columns, times x."""
        core = self._core
        return -dot([self._matrix[pivot.row][c] for c in core], [x[c] for c in core])


def eliminate(matrix: Matrix, steps: Sequence[RowStep] = ()) -> Elimination:
    """Factor a square matrix; `delta` is 0 where it is structurally singular or found to be singular.

    Args:
        matrix: the matrix B, after `steps`.
        steps: constant row operations that right-hand sides have still to go through.
    """
    n = len(matrix)
    work = [list(row) for row in matrix]
    pivots, own = _constant_pivots(work)
    steps = (*steps, *own)
    rows = [i for i in range(n) if all(i != p.row for p in pivots)]
    columns = [j for j in range(n) if all(j != p.column for p in pivots)]
    pattern = [[k for k, j in enumerate(columns) if not is_zero(work[i][j])] for i in rows]
    found = block_triangular(pattern)
    frozen = tuple(tuple(row) for row in work)
    if found is None:
        return Elimination(0, tuple(pivots), (), frozen, steps)
    blocks = []
    for block_rows, block_columns in found:
        r, c = [rows[k] for k in block_rows], [columns[k] for k in block_columns]
        adj, delta = adjugate([[work[i][j] for j in c] for i in r])
        blocks.append(_Block(tuple(r), tuple(c), tuple(tuple(row) for row in adj), delta))
    result = Elimination(0, tuple(pivots), tuple(blocks), frozen, steps)
    delta = result._constant
    for block in blocks:
        delta = 0 if is_zero(block.delta) else block.delta * delta
    return Elimination(delta, tuple(pivots), tuple(blocks), frozen, steps)


def _constant_pivots(work: list[list[Any]]) -> tuple[list[_Pivot], list[tuple[int, int, Any]]]:
    """Gauss-Jordan on constant entries, the one with the least fill first (Markowitz); `work` is changed.

    Only columns whose other entries are constant too are taken, so that the row operations are constant.
    """
    n = len(work)
    pivots: list[_Pivot] = []
    steps: list[tuple[int, int, Any]] = []
    while True:
        free_rows = [i for i in range(n) if all(i != p.row for p in pivots)]
        free_columns = [j for j in range(n) if all(j != p.column for p in pivots)]
        candidates = []
        for j in free_columns:
            entries = [(i, work[i][j]) for i in range(n) if not is_zero(work[i][j])]
            if not all(is_constant(entry) for _, entry in entries):
                continue
            for i, _ in entries:
                if i in free_rows:
                    length = sum(not is_zero(work[i][k]) for k in free_columns)
                    candidates.append(((length - 1) * (len(entries) - 1), j, i))
        if not candidates:
            return pivots, steps
        _, column, row = min(candidates)
        inverse = reciprocal(work[row][column])
        for i in range(n):
            if i != row and not is_zero(work[i][column]):
                factor = work[i][column] * inverse
                work[i] = [_less(a, factor, b) for a, b in zip(work[i], work[row], strict=True)]
                work[i][column] = 0
                steps.append((i, row, factor))
        pivots.append(_Pivot(row, column, inverse))


def _less(a: Any, factor: Any, b: Any) -> Any:
    """a - factor b"""
    return a if is_zero(b) or is_zero(factor) else total((a, -(factor * b)))
