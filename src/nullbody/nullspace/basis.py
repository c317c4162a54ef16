"""The determinant-based null space of a constraint Jacobian (theory 1): A N = 0.

With the columns of A split into dependent ones B (m x m) and independent ones C (m x d),

    N = [-B^-1 C; I]            N_ij = -|B(i <- C_j)| / |B|                     [11]
    N~ = |B| N = [-adj(B) C; |B| I]                no division at all           [12, 13]

in the order of A's columns. Source: bracketed numbers are equations of the 2020 paper on the 3-PRS robot.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from nullbody.errors import InputError, SingularityError
from nullbody.expr import Expr, Operations, operations
from nullbody.expr.matrix import Matrix
from nullbody.nullspace.elimination import Elimination, eliminate
from nullbody.nullspace.rank import Echelon, echelon, float_echelon
from nullbody.nullspace.rows import RowStep, simplified_rows
from nullbody.nullspace.scalar import is_zero, tidy

__all__ = ["NullSpace", "null_space"]


@dataclass(frozen=True)
class NullSpace:
    """A basis of the null space of A, with what is needed to use it.

    Attributes:
        delta: |B|, the pivot of the chosen columns, with A's rows `rows`.
        independent: columns of A that are free; the basis is the identity there (delta times it when scaled).
        dependent: the other columns, in increasing order.
        rows: independent rows of A that were used.
        redundant: rows of A that repeat others.
        simplified: the rows that were used after constant row operations; the same null space, fewer operations.
    """

    delta: Any
    independent: tuple[int, ...]
    dependent: tuple[int, ...]
    rows: tuple[int, ...]
    redundant: tuple[int, ...]
    simplified: tuple[tuple[Any, ...], ...]
    _factors: Elimination
    _simplifications: int

    @classmethod
    def without_constraints(cls, independent: tuple[int, ...]) -> NullSpace:
        """The whole space: N = I, nothing depends on anything."""
        return cls(1, independent, (), (), (), (), eliminate([]), 0)

    @cached_property
    def basis(self) -> tuple[tuple[Any, ...], ...]:
        """N, n x d: q' = N v."""
        return self._assembled([self._factors.solve(*column) for column in self._free], 1)

    @cached_property
    def scaled(self) -> tuple[tuple[Any, ...], ...]:
        """N~ = |B| N, n x d, free of divisions."""
        return self._assembled([self._factors.solve_scaled(*column) for column in self._free], self.delta)

    @property
    def _free(self) -> list[tuple[list[Any], int]]:
        return [([row[j] for row in self.simplified], self._simplifications) for j in self.independent]

    def offset(self, c: Sequence[Any], *, of_simplified: bool = False) -> tuple[Any, ...]:
        """gamma with A gamma + c = 0 and zeros in the independent places: gamma = [-B^-1 c; 0].

        Args:
            c: one entry for each row of A, or of `simplified`.
            of_simplified: whether c belongs to the rows of `simplified`, where it is often cheaper.
        """
        return self._offset(self._factors.solve(*self._right(c, of_simplified)))

    def offset_scaled(self, c: Sequence[Any], *, of_simplified: bool = False) -> tuple[Any, ...]:
        """gamma~ = |B| gamma = [-adj(B) c; 0], free of divisions."""
        return self._offset(self._factors.solve_scaled(*self._right(c, of_simplified)))

    def _right(self, c: Sequence[Any], of_simplified: bool) -> tuple[list[Any], int]:
        return (list(c), self._simplifications) if of_simplified else ([c[i] for i in self.rows], 0)

    def multipliers(self, force: Sequence[Any]) -> tuple[Any, ...]:
        """lambda with A^T lambda = force in the dependent places: lambda = B^-T force_B; 0 for redundant rows."""
        found = self._factors.solve_transposed([force[j] for j in self.dependent])
        values = dict(zip(self.rows, found, strict=True))
        return tuple(values.get(i, 0) for i in range(len(self.rows) + len(self.redundant)))

    @property
    def doubt(self) -> Any:
        """How near delta is to rounding, see `Elimination.doubt`; 0 without irreducible blocks."""
        return self._factors.doubt

    @property
    def operations(self) -> Operations:
        """Operation counts of the basis, for expressions of a graph."""
        return operations([entry for row in self.basis for entry in row if isinstance(entry, Expr)])

    def _assembled(self, columns: list[list[Any]], unit: Any) -> tuple[tuple[Any, ...], ...]:
        n = len(self.dependent) + len(self.independent)
        rows: list[tuple[Any, ...]] = [()] * n
        for i, place in enumerate(self.dependent):
            rows[place] = tuple(-column[i] for column in columns)
        for k, place in enumerate(self.independent):
            rows[place] = tuple(unit if k == j else 0 for j in range(len(self.independent)))
        return tuple(rows)

    def _offset(self, solution: list[Any]) -> tuple[Any, ...]:
        values = dict(zip(self.dependent, solution, strict=True))
        return tuple(-values[j] if j in values else 0 for j in range(len(self.dependent) + len(self.independent)))

    def __repr__(self) -> str:
        n, d = len(self.dependent) + len(self.independent), len(self.independent)
        count = f", {self.operations} operations" if isinstance(self.delta, Expr) else f", delta = {self.delta}"
        return f"<NullSpace {n} x {d}, rank {len(self.rows)}, independent columns {list(self.independent)}{count}>"


def null_space(A: Matrix, independent: Sequence[int] | None = None) -> NullSpace:
    """The null space of A, by determinants, for any scalars: Fraction, float, SymPy or graph expressions.

    Args:
        A: m x n, rows of scalars. Rows that repeat others are found and left out where the scalars are
            exact or expressions of a graph; in floats they are an error, SymPy expressions need independent rows.
        independent: the d = n - rank columns that stay free; by default the last ones that make |B| non-zero, for
            floats those that complete pivoting leaves.

    Raises:
        InputError: ragged or empty A, entries that are no finite numbers, wrong columns.
        SingularityError: the chosen columns leave |B| = 0; the message names columns that would do.
    """
    try:
        rows = [list(row) for row in A]
    except TypeError:
        raise InputError("A must be a list of rows of scalars") from None
    if not rows or not rows[0] or any(len(row) != len(rows[0]) for row in rows):
        raise InputError("A must be a non-empty list of rows of equal length")
    rows = [[tidy(entry) for entry in row] for row in rows]
    n = len(rows[0])
    floats = all(isinstance(entry, float) for row in rows for entry in row)
    found = float_echelon(rows) if floats else echelon(rows)
    if floats and found is not None and found.redundant:
        raise InputError(
            f"rows {list(found.redundant)} of A repeat others to rounding: leave them out, or give exact numbers"
        )
    rank = found.rank if found else len(rows)
    chosen = _chosen(independent, n, rank, found, rows)
    dependent = tuple(j for j in range(n) if j not in chosen)
    kept = found.rows if found else tuple(range(len(rows)))
    used = [rows[i] for i in kept]
    steps: list[RowStep] = []
    if all(isinstance(entry, Expr) for row in used for entry in row):
        used, steps = simplified_rows(used)
    factors = eliminate([[row[j] for j in dependent] for row in used], steps)
    if is_zero(factors.delta):
        raise SingularityError(_singular_message(rows, chosen, n))
    simplified = tuple(tuple(row) for row in used)
    redundant = found.redundant if found else ()
    return NullSpace(factors.delta, chosen, dependent, kept, redundant, simplified, factors, len(steps))


def _chosen(
    independent: Sequence[int] | None, n: int, rank: int, found: Echelon | None, rows: Matrix
) -> tuple[int, ...]:
    if independent is None:
        if found is None:
            return tuple(range(rank, n))
        return tuple(j for j in range(n) if j not in found.columns)
    chosen = tuple(independent)
    if len(set(chosen)) != len(chosen) or any(j not in range(n) for j in chosen):
        raise InputError(f"independent columns must be distinct and in 0..{n - 1}, not {list(chosen)}")
    if len(chosen) != n - rank:
        raise InputError(f"A has {n} columns and rank {rank}: choose {n - rank} independent columns, not {len(chosen)}")
    return chosen


def _singular_message(rows: Matrix, chosen: Sequence[int], n: int) -> str:
    found = echelon(rows, [j for j in range(n) if j not in chosen] + list(chosen))
    text = f"columns {list(chosen)} cannot be the independent ones: the determinant of the others is"
    if found is None:
        return text + " zero; choose other columns, or leave out rows that repeat others"
    return text + f" identically zero; columns {[j for j in range(n) if j not in found.columns]} would do"
