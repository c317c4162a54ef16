"""The null space of exact numbers and expressions: determinants, no rounding, one division at the very end.

    N = [-B^-1 C; I]            N_ij = -|B(i <- C_j)| / |B|                     [11]
    N~ = |B| N = [-adj(B) C; |B| I]                no division at all           [12, 13]

in the order of A's columns. Source: bracketed numbers are equations of the 2020 paper on the 3-PRS robot.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, final

from nullbody.errors import InputError, UnknownName
from nullbody.expr import Expr, Graph, LinearForm, Operations, operations
from nullbody.expr.matrix import total
from nullbody.nullspace.elimination import Elimination
from nullbody.nullspace.given import Given
from nullbody.nullspace.result import FORMS, Form, NullSpace
from nullbody.nullspace.scalar import is_constant, is_zero
from nullbody.nullspace.steps import Scale, Sparse, dense_rows
from nullbody.tolerances import EPS

if TYPE_CHECKING:
    from nullbody.nullspace.function import NullSpaceFunction

__all__ = ["Rows", "SymbolicNullSpace"]

Rows = tuple[tuple[Any, ...], ...]


@final
@dataclass(frozen=True, eq=False, repr=False)
class SymbolicNullSpace(NullSpace):
    """A null space with its factors; every form of the basis is made when it is asked for.

    The basis in its own form may be there already, in fewer operations than the factors make it (`search`).
    """

    _factors: Elimination
    _repeating: tuple[Sparse, ...]
    _given: Given
    _basis: Rows | None = None

    @property
    def delta(self) -> Any:
        """|B|"""
        return self._given.outward(self._factors.delta)

    def in_form(self, form: Form) -> Any:
        """The basis in one of `FORMS`, n x d, in the scalars that A had.

        Raises:
            UnknownName: there is no such form.
        """
        self._require(form)
        if form not in self._shown:
            rows = tuple(tuple(self._given.outward(entry) for entry in row) for row in self.inward(form))
            self._shown[form] = self._given.frame(rows)
        return self._shown[form]

    def inward(self, form: Form) -> Rows:
        """The basis in the scalars in which it was made, whatever A was made of; errors as `in_form`."""
        self._require(form)
        if form not in self._made:
            self._made[form] = self._of_form(form)
        return self._made[form]

    def _require(self, form: Form) -> None:
        if form not in tuple(FORMS):
            raise UnknownName("form", form, FORMS)

    def _of_form(self, form: Form) -> Rows:
        if form == "reduced":
            return self._assembled([self._factors.solve_column(j) for j in self.independent], 1)
        if form == "scaled":
            columns = [self._factors.solve_column_scaled(j) for j in self.independent]
            return self._assembled(columns, self._factors.delta)
        from nullbody.nullspace.gram import orthogonal, orthonormal

        return (orthogonal if form == "orthogonal" else orthonormal)(self.inward("reduced"))

    @cached_property
    def _made(self) -> dict[str, Rows]:
        return {} if self._basis is None else {self.form: self._basis}

    @cached_property
    def _shown(self) -> dict[str, Any]:
        return {}

    @property
    def simplified(self) -> Rows:
        """The rows that were used after constant row operations: the same null space, fewer operations."""
        return dense_rows(self._factors.simplified, self.shape[0])

    def simplify(self, forms: Sequence[LinearForm]) -> list[LinearForm]:
        """Right-hand sides of A taken to those of `simplified`, by the same constant row operations."""
        found = [forms[i] for i in self.rows]
        for step in self._factors.steps[: self._factors.simplifications]:
            factor = step.factor.constant
            if isinstance(step, Scale):
                found[step.row] = found[step.row].scaled(factor)
            else:
                found[step.row] = found[step.row].minus(factor, found[step.source])
        return found

    def offset(self, c: Sequence[Any], *, of_simplified: bool = False) -> tuple[Any, ...]:
        """gamma with A gamma + c = 0 and zeros in the independent places: gamma = [-B^-1 c; 0].

        Args:
            c: one entry for each row of A, or of `simplified`.
            of_simplified: whether c belongs to the rows of `simplified`, where it is often cheaper.

        Raises:
            InputError: another number of entries, no scalars of A's kind, or a redundant row that c does not repeat.
                Where what is missing is an expression, not a number, nothing is raised: it may be zero where it
                matters, as in c = A' q' with A q' = 0.
        """
        found = self._factors.solve(self._right(c, of_simplified), of_simplified=of_simplified)
        return tuple(self._given.outward(entry) for entry in self._placed(found))

    def offset_scaled(self, c: Sequence[Any], *, of_simplified: bool = False) -> tuple[Any, ...]:
        """gamma~ = |B| gamma = [-adj(B) c; 0], free of divisions."""
        return self._placed(self._factors.solve_scaled(self._right(c, of_simplified), of_simplified=of_simplified))

    def _right(self, c: Sequence[Any], of_simplified: bool) -> list[Any]:
        if of_simplified:
            return list(c)
        given = self._inward(c, len(self.rows) + len(self.redundant), "c", "rows")
        for i in self.redundant:
            expected = total(factor * given[k] for k, factor in self._combinations[i].items())
            difference = total((given[i], -expected))
            if is_constant(difference) and not is_zero(difference):
                raise InputError(
                    f"row {i} of A repeats others, its entry of c does not: {given[i]} is not {expected}; "
                    "A gamma + c = 0 has no solution"
                )
        return [given[i] for i in self.rows]

    def _inward(self, vector: Any, count: int, name: str, lines: str) -> list[Any]:
        """A vector of the caller's scalars, one for each of A's rows or columns, in the scalars of the factors."""
        try:
            entries = None if isinstance(vector, Mapping | Set | str) else list(vector)
        except TypeError:
            entries = None
        if entries is None:
            raise InputError(f"{name} must be a list of {count} scalars, one for each of A's {lines}")
        if len(entries) != count:
            raise InputError(f"{name} has {len(entries)} entries, A has {count} {lines}: give one for each")
        return [self._given.inward(entry) for entry in entries]

    def multipliers(self, force: Sequence[Any]) -> tuple[Any, ...]:
        """lambda with A^T lambda = force in the dependent places: lambda = B^-T force_B; 0 for redundant rows."""
        given = self._inward(force, self.shape[0], "the force", "columns")
        found = self._factors.solve_transposed([given[j] for j in self.dependent])
        values = dict(zip(self.rows, found, strict=True))
        return tuple(values.get(i, 0) for i in range(len(self.rows) + len(self.redundant)))

    @property
    def repeats(self) -> Mapping[int, Mapping[int, Any]]:
        """How redundant rows repeat others: A[i] = sum_k repeats[i][k] A[k]."""
        return {
            i: {k: self._given.outward(factor) for k, factor in factors.items()}
            for i, factors in self._combinations.items()
        }

    @cached_property
    def _combinations(self) -> dict[int, dict[int, Any]]:
        found = {}
        for i, row in zip(self.redundant, self._repeating, strict=True):
            factors = self._factors.solve_transposed([row.get(j, 0) for j in self.dependent])
            found[i] = {k: factor for k, factor in zip(self.rows, factors, strict=True) if not is_zero(factor)}
        return found

    @property
    def doubt(self) -> Any:
        """How near delta is to rounding, see `Elimination.doubt`; 0 without irreducible blocks."""
        return self._factors.doubt

    @property
    def operations(self) -> Operations | None:
        """Operation counts of the basis; None for numbers, which are evaluated already."""
        return self.operations_of(self.form) if isinstance(self._factors.delta, Expr) else None

    def operations_of(self, form: Form) -> Operations:
        """Operation counts of the basis in another form."""
        return operations([entry for row in self.inward(form) for entry in row if isinstance(entry, Expr)])

    @cached_property
    def condition(self) -> float:
        """The largest singular value of N; of expressions at one generic point, `condition_at` takes yours."""
        return self.condition_at({})

    def condition_at(self, values: Mapping[str, float]) -> float:
        """The largest singular value of N at a point.

        Args:
            values: numbers for the symbols of the graph; those that are left out get generic ones in 0.5..1.5.

        Raises:
            UnknownName: A has no such symbol.
        """
        from nullbody.nullspace.sample import largest_singular_value

        return largest_singular_value(self.inward("reduced"), values)

    @property
    def subspace_error(self) -> float:
        """About eps * condition where the basis is evaluated in doubles; 0 for exact numbers."""
        return EPS * self.condition if isinstance(self._factors.delta, Expr) else 0.0

    def to_sympy(self) -> Any:
        """The basis as an immutable SymPy matrix."""
        from nullbody.expr.bridge import SymPyBridge
        from nullbody.nullspace.given import sympy_matrix

        rows = self.inward(self.form)
        if self._given.bridge is None:
            graph = next((entry.graph for row in rows for entry in row if isinstance(entry, Expr)), Graph())
            bridge = SymPyBridge(graph)
        else:
            bridge = self._given.bridge
        return sympy_matrix([[bridge.write(entry) for entry in row] for row in rows])

    def latex(self) -> str:
        """The basis in LaTeX; sub-expressions that are used more than once are named and listed below it."""
        from nullbody.expr.display import latex_equation

        names = None if self._given.bridge is None else self._given.bridge.latex_names()
        return latex_equation("", self.inward(self.form), names, below=True)

    def to_function(self) -> NullSpaceFunction:
        """The basis as native code: a function of the symbols, for one point or a batch of them."""
        from nullbody.nullspace.function import function_of

        return function_of(self)

    def __deepcopy__(self, memo: dict[int, Any]) -> SymbolicNullSpace:
        """The same: it does not change, and its expressions stay in the graph of those of A."""
        return self

    def _assembled(self, columns: list[list[Any]], unit: Any) -> Rows:
        n = len(self.dependent) + len(self.independent)
        rows: list[tuple[Any, ...]] = [()] * n
        for i, place in enumerate(self.dependent):
            rows[place] = tuple(-column[i] for column in columns)
        for k, place in enumerate(self.independent):
            rows[place] = tuple(unit if k == j else 0 for j in range(len(self.independent)))
        return tuple(rows)

    def _placed(self, solution: list[Any]) -> tuple[Any, ...]:
        values = dict(zip(self.dependent, solution, strict=True))
        return tuple(-values[j] if j in values else 0 for j in range(len(self.dependent) + len(self.independent)))

    @property
    def _figure(self) -> str:
        count = self.operations
        return f"{count} operations" if count is not None else f"delta = {_short(self.delta)}"


def _short(scalar: Any) -> str:
    text = str(scalar)
    return text if len(text) <= 24 else f"{text[:10]}... ({len(text)} digits)"
