"""What is given: a matrix of any kind, read into rows of one kind of scalar.

numbers      int, Fraction, SymPy Rational                  exact results
expressions  Expr of a Graph, SymPy, Exact (Q(sqrt 2, ..))  results of the same kind
array        float, complex, NumPy arrays and stacks        rounded results
sparse       SciPy sparse matrices                          rounded results
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass
from fractions import Fraction
from operator import index
from reprlib import Repr
from typing import TYPE_CHECKING, Any, Literal

from nullbody.errors import InputError
from nullbody.expr import Exact, Expr, Graph
from nullbody.nullspace.steps import Sparse, dense_rows, sparse_rows

if TYPE_CHECKING:
    from nullbody.expr.bridge import SymPyBridge

__all__ = ["Given", "Kind", "checked_columns", "checked_tolerance", "read", "scalar_rows", "sympy_matrix"]

Kind = Literal["numbers", "expressions", "array", "sparse"]


def _same(value: Any) -> Any:
    return value


_WHAT = "A must be a list of rows of scalars, a NumPy array, a SciPy sparse matrix or a SymPy matrix"
_STACK = "stack matrices by numpy.stack"

#: Text, and what has no order: no row, though Python lets one iterate over it.
_NO_ROW = (str, bytes, bytearray, Mapping, Set)

_LARGEST = Fraction(sys.float_info.max)

_SHORT = Repr()  # of lists in messages
_SHORT.maxlist = 12


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
    if isinstance(A, (type, *_NO_ROW)):
        raise InputError(f"{_WHAT}, not a {type(A).__name__}")
    if hasattr(A, "to_numpy"):  # a table of pandas
        A = A.to_numpy()
    if hasattr(A, "tocsr") and hasattr(A, "nnz"):
        if len(A.shape) != 2:
            raise InputError(f"A must be a matrix (m, n), not a sparse array of shape {A.shape}")
        return Given("sparse", A, A.shape[1])
    if hasattr(A, "dtype") and hasattr(A, "ndim") and A.dtype != object:
        return Given("array", A, A.shape[-1] if A.ndim else 0)
    if hasattr(A, "tolist") and hasattr(A, "shape"):  # a SymPy matrix, or an array of objects
        shape, rows = tuple(A.shape), A.tolist()
        frame = sympy_matrix if hasattr(A, "free_symbols") else tuple
        return _scalars(rows, shape[-1] if shape else 0, frame)
    rows = scalar_rows(A, f"{_WHAT}; for one row write [[1, 2, 3]]")
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        raise InputError("A must be a non-empty list of rows of equal length; write no rows as numpy.zeros((0, n))")
    return _scalars(rows, len(rows[0]), tuple)


def scalar_rows(matrix: Any, wanted: str) -> list[list[Any]]:
    """The rows of a dense matrix as lists, whatever is in them.

    Args:
        matrix: rows, an array (m, n) or a SymPy matrix.
        wanted: what the message says where it is nothing of that.

    Raises:
        InputError: it has no rows, or they are text, sets or mappings, or not in two dimensions.
    """
    if hasattr(matrix, "tolist"):
        matrix = matrix.tolist()
    try:
        rows = [None if isinstance(row, _NO_ROW) else list(row) for row in matrix]
    except (TypeError, ValueError):
        raise InputError(wanted) from None
    if isinstance(matrix, _NO_ROW) or any(row is None for row in rows):
        raise InputError(f"{wanted}; text, sets and mappings are no rows")
    return [row for row in rows if row is not None]


def checked_columns(columns: Sequence[int], n: int, kind: str) -> tuple[int, ...]:
    """Column numbers of a matrix with n columns.

    Raises:
        InputError: they are no list, or not distinct, or not in 0..n-1.
    """
    if isinstance(columns, Mapping):
        raise InputError(f"{kind} columns must be a list of column numbers, not a {type(columns).__name__}")
    try:
        given = tuple(columns)
    except TypeError:
        raise InputError(f"{kind} columns must be a list of column numbers, not {columns!r}") from None
    wrong = f"{kind} columns must be distinct and in 0..{n - 1}, not {_SHORT.repr(list(given))}"
    try:
        chosen = tuple(-1 if isinstance(j, bool) else index(j) for j in given)
    except TypeError:
        raise InputError(wrong) from None
    if len(set(chosen)) != len(chosen) or any(j not in range(n) for j in chosen):
        raise InputError(wrong)
    return chosen


def checked_tolerance(given: float | None) -> float | None:
    """A relative tolerance; None stays None.

    Raises:
        InputError: it is not in 0..1.
    """
    if given is None:
        return None
    try:
        value = math.nan if isinstance(given, bool | str) else float(given)
    except (TypeError, ValueError):
        value = math.nan
    if not 0 < value < 1:
        raise InputError(f"the tolerance is relative: a number above 0 and below 1, not {given!r}")
    return value


def _scalars(rows: list[list[Any]], columns: int, frame: Callable[[Any], Any]) -> Given:
    if not columns:
        raise InputError("A has no columns: without unknowns there is no null space; it must be non-empty")
    if any(type(row) is not list or len(row) != columns for row in rows):
        raise InputError(_WHAT)
    read, kinds = rows, _kinds(rows)
    if not kinds <= {Expr, Fraction}:
        read = [[_plain(entry, i, j) for j, entry in enumerate(row)] for i, row in enumerate(rows)]
        kinds = _kinds(read)
    if Expr in kinds:
        return _graph(read, columns, frame)
    if any(hasattr(kind, "free_symbols") for kind in kinds):
        return _sympy(read, columns, frame)
    if Exact in kinds:
        return _surds(read, columns, frame)
    if kinds & {float, complex}:
        return Given("array", _rounded(read, complex if complex in kinds else float), columns)
    return Given("numbers", sparse_rows(read), columns, _fraction, _same, frame)


def _kinds(rows: list[list[Any]]) -> set[type]:
    return set().union(*(map(type, row) for row in rows))


def _rounded(rows: list[list[Any]], kind: type) -> Any:
    """Rows of numbers as an array of doubles."""
    import numpy as np

    try:
        return np.array(rows, dtype=kind)
    except OverflowError:
        large = ((i, j) for i, row in enumerate(rows) for j, entry in enumerate(row) if abs(entry) > _LARGEST)
        i, j = next(large)
        raise InputError(
            f"A[{i}, {j}] is beyond the range of doubles, and other entries are floats: give all of them as exact "
            "numbers (int, Fraction), or scale the row"
        ) from None


def _plain(entry: Any, i: int, j: int) -> Any:
    """An entry as a Fraction, float, complex, Exact, Expr or SymPy expression."""
    if isinstance(entry, Expr | Fraction):
        return entry
    if hasattr(entry, "dtype") and hasattr(entry, "item"):  # a scalar of NumPy
        if getattr(entry, "ndim", 0):
            raise InputError(
                f"A[{i}, {j}] must be a number or an expression, not an array of shape {entry.shape}; {_STACK}"
            )
        entry = entry.item()
        if hasattr(entry, "dtype"):  # a long double stays one
            entry = complex(entry) if entry.dtype.kind == "c" else float(entry)
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
        hint = f"; {_STACK}" if isinstance(entry, list | tuple) else ""
        raise InputError(f"A[{i}, {j}] must be a number or an expression, not {entry!r}{hint}")
    if entry.is_number and entry.is_finite is False:
        raise InputError(f"A[{i}, {j}] must be finite, not {entry}")
    return entry


def _graph(rows: list[list[Any]], columns: int, frame: Callable[[Any], Any]) -> Given:
    graph = next(entry.graph for row in rows for entry in row if isinstance(entry, Expr))
    read = [_in_graph(row, graph, i) for i, row in enumerate(rows)]
    return Given("expressions", read, columns, lambda scalar: _of_graph(scalar, graph, "a scalar"), _same, frame)


def _in_graph(row: list[Any], graph: Graph, i: int) -> Sparse:
    read: Sparse = {}
    for j, entry in enumerate(row):
        known = type(entry) is Expr and entry.graph is graph
        own = entry if known else _of_graph(entry, graph, f"A[{i}, {j}]")
        if own.ref:
            read[j] = own
    return read


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
    irrational = hasattr(scalar, "free_symbols") and not (scalar.is_Rational or scalar.is_Float)
    number = None if irrational else Exact.of(scalar).fraction
    if number is None:
        raise InputError(f"{scalar} is not rational, A is: give A in the same kind of scalars (`Exact`, SymPy)")
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
    written = sparse_rows([_bridged(bridge, e, i, j) for j, e in enumerate(row)] for i, row in enumerate(rows))

    def outward(scalar: Any) -> Any:
        return bridge.write(scalar) if isinstance(scalar, Expr) else _sympy_number(scalar)

    return Given("expressions", written, columns, bridge.read, outward, frame, bridge)


def _bridged(bridge: SymPyBridge, entry: Any, i: int, j: int) -> Expr:
    try:
        return bridge.read(entry)
    except InputError as error:
        raise InputError(f"A[{i}, {j}]: {error}") from None


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
