"""What is given: a matrix of any kind, read into rows of one kind of scalar.

numbers      int, Fraction, SymPy Rational                  exact results
expressions  Expr of a Graph, SymPy, Exact (Q(sqrt 2, ..))  results of the same kind
array        float, complex, NumPy arrays and stacks        rounded results
sparse       SciPy sparse matrices                          rounded results
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Literal

from nullbody.errors import InputError
from nullbody.expr import Exact, Expr, Graph
from nullbody.nullspace.scalar import is_zero
from nullbody.nullspace.steps import Sparse, dense_rows, sparse_rows

if TYPE_CHECKING:
    from nullbody.expr.bridge import SymPyBridge

__all__ = ["Given", "Kind", "checked_columns", "read", "sympy_matrix"]

Kind = Literal["numbers", "expressions", "array", "sparse"]


def _same(value: Any) -> Any:
    return value


_WHAT = "A must be a list of rows of scalars, a NumPy array, a SciPy sparse matrix or a SymPy matrix"


@dataclass(frozen=True)
class Given:
    """A matrix that was read.

    Attributes:
        kind: which road it takes.
        matrix: rows of Fractions or of expressions of one graph, without their zeros; otherwise the array itself.
        columns: how many there are.
        inward: takes one more scalar of the caller's, such as an entry of c, to the kind of `matrix`.
        outward: takes a scalar of the result to the caller's kind.
        frame: takes rows of such scalars to the caller's kind of matrix.
        bridge: what reads and writes SymPy, where A came from there.
    """

    kind: Kind
    matrix: Any
    columns: int
    inward: Callable[[Any], Any] = _same
    outward: Callable[[Any], Any] = _same
    frame: Callable[[Any], Any] = tuple
    bridge: SymPyBridge | None = None

    @property
    def dense(self) -> tuple[tuple[Any, ...], ...]:
        """The rows of numbers or expressions with their zeros."""
        zero = next((entry - entry for row in self.matrix for entry in row.values()), 0)
        return dense_rows(self.matrix, self.columns, zero)


def read(A: Any) -> Given:
    """Read a matrix.

    Raises:
        InputError: ragged rows, no columns, entries that are no finite numbers or of no known kind.
    """
    if hasattr(A, "tocsr") and hasattr(A, "nnz"):
        return Given("sparse", A, A.shape[1])
    if hasattr(A, "dtype") and hasattr(A, "ndim") and A.dtype != object:
        return Given("array", A, A.shape[-1] if A.ndim else 0)
    if hasattr(A, "tolist") and hasattr(A, "shape"):  # a SymPy matrix, or an array of objects
        shape, rows = tuple(A.shape), A.tolist()
        frame = sympy_matrix if hasattr(A, "free_symbols") else tuple
        return _scalars(rows, shape[-1] if shape else 0, frame)
    try:
        rows = [list(row) for row in A]
    except TypeError:
        raise InputError(_WHAT) from None
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        raise InputError("A must be a non-empty list of rows of equal length; write no rows as numpy.zeros((0, n))")
    return _scalars(rows, len(rows[0]), tuple)


def checked_columns(columns: Sequence[int], n: int, kind: str) -> tuple[int, ...]:
    """Column numbers of a matrix with n columns.

    Raises:
        InputError: they are no list, or not distinct, or not in 0..n-1.
    """
    try:
        chosen = tuple(columns)
    except TypeError:
        raise InputError(f"{kind} columns must be a list of column numbers, not {columns!r}") from None
    whole = all(hasattr(j, "__index__") and not isinstance(j, bool) for j in chosen)
    if not whole or len(set(chosen)) != len(chosen) or any(j not in range(n) for j in chosen):
        raise InputError(f"{kind} columns must be distinct and in 0..{n - 1}, not {list(chosen)}")
    return tuple(int(j) for j in chosen)


def _scalars(rows: list[list[Any]], columns: int, frame: Callable[[Any], Any]) -> Given:
    if not columns:
        raise InputError("A must have columns: a matrix without unknowns is non-empty in no sense")
    if any(type(row) is not list or len(row) != columns for row in rows):
        raise InputError(_WHAT)
    read = [[_plain(entry, i, j) for j, entry in enumerate(row)] for i, row in enumerate(rows)]
    kinds = {type(entry) for row in read for entry in row}
    if Expr in kinds:
        return _graph(read, columns, frame)
    if any(hasattr(kind, "free_symbols") for kind in kinds):
        return _sympy(read, columns, frame)
    if Exact in kinds:
        return _surds(read, columns, frame)
    if kinds & {float, complex}:
        import numpy as np

        return Given("array", np.array(read, dtype=complex if complex in kinds else float), columns)
    return Given("numbers", sparse_rows(read), columns, _fraction, _same, frame)


def _plain(entry: Any, i: int, j: int) -> Any:
    """An entry as a Fraction, float, complex, Exact, Expr or SymPy expression."""
    if isinstance(entry, Expr | Fraction):
        return entry
    if hasattr(entry, "dtype") and hasattr(entry, "item"):
        entry = entry.item()
    if isinstance(entry, Exact):
        return entry
    if isinstance(entry, bool | str | bytes):
        raise InputError(f"A[{i}, {j}] must be a number or an expression, not {entry!r}")
    if isinstance(entry, int):
        return Fraction(entry)
    if isinstance(entry, float | complex):
        if not abs(entry) < float("inf"):
            raise InputError(f"A[{i}, {j}] must be finite, not {entry}")
        return entry
    if hasattr(entry, "_sympy_"):
        entry = entry._sympy_()
    if not hasattr(entry, "free_symbols"):
        raise InputError(f"A[{i}, {j}] must be a number or an expression, not {entry!r}")
    if entry.is_number and entry.is_finite is False:
        raise InputError(f"A[{i}, {j}] must be finite, not {entry}")
    return entry


def _graph(rows: list[list[Any]], columns: int, frame: Callable[[Any], Any]) -> Given:
    graph = next(entry.graph for row in rows for entry in row if isinstance(entry, Expr))
    read = [_in_graph(row, graph, i) for i, row in enumerate(rows)]
    return Given("expressions", read, columns, lambda scalar: _of_graph(scalar, graph, "a scalar"), _same, frame)


def _in_graph(row: list[Any], graph: Graph, i: int) -> Sparse:
    return {j: _of_graph(entry, graph, f"A[{i}, {j}]") for j, entry in enumerate(row) if not is_zero(entry)}


def _of_graph(entry: Any, graph: Graph, place: str) -> Expr:
    if isinstance(entry, Expr):
        if entry.graph is not graph:
            raise InputError(f"{place} belongs to another graph: write all entries in one")
        return entry
    if isinstance(entry, int | float | Fraction | Exact) and not isinstance(entry, bool):
        return graph.constant(entry)
    raise InputError(f"{place} = {entry!r} cannot stand beside expressions of a graph")


def _fraction(scalar: Any) -> Fraction:
    """An exact number; a float means its shortest decimal."""
    number = Exact.of(scalar).fraction
    if number is None:
        raise InputError(f"{scalar} is irrational, A is not: give A in the same kind of numbers (`Exact`, SymPy)")
    return number


def _surds(rows: list[list[Any]], columns: int, frame: Callable[[Any], Any]) -> Given:
    graph = Graph()
    read = [_in_graph(row, graph, i) for i, row in enumerate(rows)]
    return Given("expressions", read, columns, lambda scalar: _of_graph(scalar, graph, "a scalar"), _constant, frame)


def _constant(scalar: Any) -> Exact:
    number = scalar.constant if isinstance(scalar, Expr) else Exact.of(scalar)
    if number is None:
        raise InputError(f"{scalar} is no sum of rational multiples of square roots: take the form 'orthogonal'")
    return number


def _sympy(rows: list[list[Any]], columns: int, frame: Callable[[Any], Any]) -> Given:
    if all(_rational(entry) for row in rows for entry in row):
        read = [
            [Fraction(int(entry.p), int(entry.q)) if hasattr(entry, "p") else entry for entry in row] for row in rows
        ]
        return Given("numbers", sparse_rows(read), columns, _fraction, _sympy_number, frame)
    from nullbody.expr.bridge import SymPyBridge

    bridge = SymPyBridge(Graph())
    written = sparse_rows([bridge.read(entry) for entry in row] for row in rows)

    def outward(scalar: Any) -> Any:
        return bridge.write(scalar) if isinstance(scalar, Expr) else _sympy_number(scalar)

    return Given("expressions", written, columns, bridge.read, outward, frame, bridge)


def _rational(entry: Any) -> bool:
    return isinstance(entry, Fraction) or bool(getattr(entry, "is_Rational", False))


def _sympy_number(scalar: Any) -> Any:
    from sympy import Add, Rational, sqrt

    terms = Exact.of(scalar).terms
    return Add(*(Rational(part.numerator, part.denominator) * sqrt(k) for k, part in terms))


def sympy_matrix(rows: Sequence[Sequence[Any]]) -> Any:
    """Rows of SymPy scalars as an immutable matrix."""
    from sympy import ImmutableMatrix

    return ImmutableMatrix(len(rows), len(rows[0]) if rows else 0, [entry for row in rows for entry in row])
