"""The bridge to SymPy: its expressions read into a graph, and expressions of a graph written as SymPy's.

Reading walks the structure, never the text. What the graph has no operation for (exp(x), f(t), a derivative, pi)
becomes a stand-in: a symbol of the graph that writing replaces by what it stood for. A stand-in is a variable of
its own: the graph's derivatives and substitutions do not look into it.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from numbers import Number
from typing import Any

from nullbody.errors import InputError
from nullbody.expr.exact import Exact
from nullbody.expr.expression import Expr
from nullbody.expr.graph import Graph
from nullbody.expr.sympy_reader import SymPyReader, shown
from nullbody.expr.sympy_writer import SymPyWriter

__all__ = ["SymPyBridge"]


class SymPyBridge:
    """Both directions between SymPy and one graph; use one bridge for a graph.

    A SymPy symbol is the graph's symbol of its name. A second one of that name, told apart in SymPy by its
    assumptions, is named apart: x, x__2. Equal stand-ins share one symbol.

    Args:
        graph: the graph that is read into and written from.

    Attributes:
        graph: that graph.
        table: name of a graph symbol -> the SymPy symbol or the sub-expression that it stands for, in order of
            creation.

    Raises:
        InputError: SymPy is not installed.
    """

    def __init__(self, graph: Graph) -> None:
        try:
            import sympy
        except ImportError:
            raise InputError("SymPy is not installed; run: python -m pip install 'nullbody[symbolic]'") from None
        self.graph = graph
        self.table: dict[str, Any] = {}
        self._sympy: Any = sympy
        self._refs: dict[Any, int] = {}  # of the entries of the table
        self._copies: dict[str, int] = {}
        self._reader = SymPyReader(graph, self._variable)
        self._writer = SymPyWriter(graph, self._entry)

    def __repr__(self) -> str:
        return f"<SymPyBridge of {self.graph!r}, {len(self.symbols)} symbols, {len(self.opaque)} stand-ins>"

    @property
    def symbols(self) -> tuple[Any, ...]:
        """The SymPy symbols that were met, in order of creation."""
        return tuple(entry for entry in self.table.values() if entry.is_Symbol)

    @property
    def opaque(self) -> dict[str, Any]:
        """The stand-ins: name of a graph symbol -> SymPy sub-expression, in order of creation."""
        return {name: entry for name, entry in self.table.items() if not entry.is_Symbol}

    def latex_names(self) -> dict[str, str]:
        """Every name of the table as SymPy's LaTeX, for `latex_equation`."""
        return {name: self._sympy.latex(entry) for name, entry in self.table.items()}

    def read(self, expression: Any) -> Expr:
        """A SymPy expression, a SymEngine one or a number as an expression of the graph.

        A Float means its decimal: 0.1 is 1/10. sqrt(2) sqrt(3) is sqrt(6), and sin(x)^2 + cos(x)^2 is 1.

        Raises:
            InputError: it is complex, not finite, not commutative, or no scalar expression.
        """
        if isinstance(expression, Expr):
            return Expr(self.graph, self._own(expression))
        if not isinstance(expression, self._sympy.Basic) and hasattr(expression, "_sympy_"):
            expression = expression._sympy_()
        if isinstance(expression, self._sympy.Basic):
            return Expr(self.graph, self._reader.reference(expression))
        if isinstance(expression, Number | Exact) and not isinstance(expression, bool | complex):
            return self.graph.constant(expression)  # type: ignore[arg-type]
        raise InputError(f"expected a SymPy expression or a number, not {type(expression).__name__}")

    def read_matrix(self, matrix: Any) -> list[list[Expr]]:
        """The rows of a SymPy or SymEngine matrix, or of nested sequences, read entry by entry.

        Raises:
            InputError: there are no rows of entries, or an entry cannot be read.
        """
        rows = matrix.tolist() if hasattr(matrix, "tolist") else matrix
        if isinstance(rows, str) or not all(isinstance(row, list | tuple) for row in rows):
            raise InputError("expected a matrix: rows of entries")
        return [[self.read(entry) for entry in row] for row in rows]

    def write(self, expression: Expr | int | float | Fraction | Exact) -> Any:
        """An expression of the graph, or a number, in SymPy; sub-expressions are shared by reference.

        SymPy's rules put the operations together, up to 100 levels of them; above, they are left as they are.
        A symbol that did not come from SymPy becomes `Symbol(name)`.

        Raises:
            InputError: the expression belongs to another graph.
        """
        if not isinstance(expression, Expr):
            expression = self.graph.constant(expression)
        return self._writer.expression(self._own(expression))

    def write_matrix(self, rows: Iterable[Iterable[Expr | int | float | Fraction | Exact]]) -> Any:
        """Rows of expressions as a SymPy `Matrix`."""
        return self._sympy.Matrix([[self.write(entry) for entry in row] for row in rows])

    # -- the table ------------------------------------------------------------------------------------------

    def _own(self, expression: Expr) -> int:
        if expression.graph is not self.graph:
            raise InputError("the expression belongs to another graph than the bridge")
        return expression.ref

    def _variable(self, leaf: Any) -> int:
        """The reference of a SymPy symbol, or of a stand-in."""
        if leaf not in self._refs:
            self._refuse_unreal(leaf)
            name = self._free_name(leaf)
            self.table[name] = leaf
            self._refs[leaf] = self.graph.symbol(name).ref
        return self._refs[leaf]

    def _entry(self, name: str) -> Any:
        """What the graph's symbol of this name stands for."""
        if name not in self.table:
            self.table[name] = self._sympy.Symbol(name)
            self._refs[self.table[name]] = self.graph.symbol(name).ref
        return self.table[name]

    def _refuse_unreal(self, whole: Any) -> None:
        """Raise where something in it is complex, NaN or not commutative, or it is an infinity."""
        S = self._sympy.S
        if whole in (S.Infinity, S.NegativeInfinity):  # inside they may be the limits of an integral
            raise InputError(f"an expression must be finite, not {whole}")
        stack, seen = [whole], {id(whole)}
        while stack:
            part = stack.pop()
            if part is S.NaN or part is S.ComplexInfinity:
                raise InputError(f"an expression must be finite, not {shown(whole)}")
            if (part.is_Symbol or part is whole) and part.is_commutative is False:
                raise InputError(f"an expression must be a commutative scalar, and {shown(part)} is not")
            if part is S.ImaginaryUnit or (part.is_Symbol and part.is_extended_real is False):
                raise InputError(f"an expression must be real; {part} in {shown(whole)} is complex")
            new = [argument for argument in part.args if id(argument) not in seen]
            seen.update(map(id, new))
            stack += new

    def _free_name(self, leaf: Any) -> str:
        """A symbol's own name, or a short one for a stand-in; with a number where something else has it."""
        name = leaf.name if leaf.is_Symbol else self._short_name(leaf)
        if name not in self.table and (leaf.is_Symbol or name not in self.graph.symbols):
            return str(name)
        taken = {*self.table, *self.graph.symbols}
        number = self._copies.get(name, 1) + 1
        while f"{name}__{number}" in taken:
            number += 1
        self._copies[name] = number
        return f"{name}__{number}"

    def _short_name(self, leaf: Any) -> str:
        """q for q(t), q_dot for its derivative by t, pi for pi, exp for exp(x)."""
        function = self._sympy.core.function
        if isinstance(leaf, function.AppliedUndef):
            return str(leaf.func.__name__)
        if isinstance(leaf, function.Derivative) and isinstance(leaf.expr, function.AppliedUndef):
            (variable, count), *others = leaf.variable_count
            if not others and str(variable) == "t" and count.is_Integer:
                return str(leaf.expr.func.__name__) + "_dot" * int(count)
        return str(leaf) if leaf.is_NumberSymbol else type(leaf).__name__.lower()
