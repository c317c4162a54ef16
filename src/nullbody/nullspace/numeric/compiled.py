"""Generated kernels A -> N for matrices that have zeros in the same places.

Every entry that is not always zero becomes a symbol; the symbolic method makes N of one chart, the kernels evaluate it
for 8 matrices at a time. A second kernel judges every result, for what a chart fixed beforehand may do to it:

    spread = |N|^2,   residual = sum_i |A_i N|^2 / |A_i|^2,   share = |B|^2 / prod_i |A_i|^2    (A_i: rows of A)

What does not pass - a chart near |B| = 0, or an inner pivot that happens to be small - is done once more by
elimination with complete pivoting.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, final

import numpy as np
from numpy.typing import ArrayLike

from nullbody.errors import InputError
from nullbody.expr import Expr, Graph, Operations, Tape
from nullbody.expr.matrix import dot, total
from nullbody.kernels import Kernel, Program, compile_programs
from nullbody.nullspace.numeric.chart import Chart, Request
from nullbody.nullspace.numeric.equilibrate import Array, Matrices, finite_numbers
from nullbody.nullspace.numeric.method import Found, complete
from nullbody.nullspace.numeric.orthonormal import orthonormalised, rows_at
from nullbody.nullspace.numeric.rank import others, relative_tolerance
from nullbody.typing import FloatArray, IndexArray

if TYPE_CHECKING:
    from nullbody.nullspace.numeric.stack import NullSpaceStack

__all__ = ["ArrayFunction", "compiled"]

#: Largest |A N| relative to |N|, rows of A of length 1; methods with pivoting stay below 4e-16.
_RESIDUAL = 1e-15
#: Largest |A N| where another chart may be taken: the subspace error is at most about 3 times that.
_ANGLE = 3e-14
#: |B| below this share of the product of its rows' lengths may be nothing but rounding.
_SHARE = 1e-10
#: Matrices of a stack that decide the chart.
_SAMPLE = 32


@dataclass(frozen=True)
class _Pattern:
    """What a kernel is made for.

    Attributes:
        shape: (m, n).
        places: (i, j) of the entries that are symbols.
        constants: (i, j, value) of entries that never change; all others are 0.
        rows: independent rows.
        independent: the chart.
    """

    shape: tuple[int, int]
    places: tuple[tuple[int, int], ...]
    constants: tuple[tuple[int, int, Fraction], ...]
    rows: tuple[int, ...]
    independent: tuple[int, ...]

    def matrix(self, graph: Graph) -> list[list[Any]]:
        """A in the symbols of a graph."""
        m, n = self.shape
        A: list[list[Any]] = [[graph.constant(0)] * n for _ in range(m)]
        for name, (i, j) in zip(self.names, self.places, strict=True):
            A[i][j] = graph.symbol(name)
        for i, j, value in self.constants:
            A[i][j] = graph.constant(value)
        return A

    @property
    def names(self) -> list[str]:
        """The names of the symbols."""
        return [f"a_{i}_{j}" for i, j in self.places]

    def values(self, stack: Array) -> FloatArray:
        """The entries that are symbols, (k, symbols)."""
        places = np.array(self.places, np.intp).reshape(-1, 2)
        return np.ascontiguousarray(stack[:, places[:, 0], places[:, 1]], dtype=np.float64)

    def require(self, stack: Array, values: FloatArray) -> None:
        """Raise where a stack has entries that are not zero outside the pattern, or other constants."""
        fixed = np.zeros(self.shape)
        for i, j, value in self.constants:
            fixed[i, j] = value
        expected = np.count_nonzero(values) + len(stack) * np.count_nonzero(fixed)
        places = np.array([(i, j) for i, j, _ in self.constants], np.intp).reshape(-1, 2)
        constant = stack[:, places[:, 0], places[:, 1]]
        if np.count_nonzero(stack) == expected and (constant == fixed[places[:, 0], places[:, 1]]).all():
            return
        changed = stack != fixed
        free = np.array(self.places, np.intp).reshape(-1, 2)
        changed[:, free[:, 0], free[:, 1]] = False
        s, i, j = np.argwhere(changed)[0]
        raise InputError(
            f"this function was made for matrices with A[{i}, {j}] = {fixed[i, j]:g}; matrix {s} has {stack[s, i, j]:g}"
        )


class _Kernels(NamedTuple):
    """Kernels of a pattern: (A) -> (N, delta) and (A, N, delta) -> (spread, residual, share)."""

    null_space: Kernel
    figures: Kernel


@lru_cache(maxsize=32)
def _kernels(pattern: _Pattern) -> _Kernels:
    graph = Graph()
    n, d = pattern.shape[1], len(pattern.independent)
    A = pattern.matrix(graph)
    N, delta = _symbolic([A[i] for i in pattern.rows], pattern.independent, graph)
    names = pattern.names
    tape = Tape.of([*(entry for row in N for entry in row), delta], names)
    first = Program("null_space", (("A", len(names)),), (("N", (n, d)), ("delta", ())), tape)
    known = [[entry if entry.constant is not None else None for entry in row] for row in N]
    labels = [f"n_{i}_{j}" for i in range(n) for j in range(d)]
    given = [[e if e is not None else graph.symbol(f"n_{i}_{j}") for j, e in enumerate(r)] for i, r in enumerate(known)]
    figures = _figures(A, given, graph.symbol("delta"), pattern.rows)
    second = Program(
        "figures",
        (("A", len(names)), ("N", n * d), ("delta", 1)),
        (("spread", ()), ("residual", ()), ("share", ())),
        Tape.of([graph.constant(0) + figure for figure in figures], [*names, *labels, "delta"]),
    )
    library = compile_programs([first, second])
    return _Kernels(library.kernels["null_space"], library.kernels["figures"])


def _symbolic(rows: list[list[Any]], independent: tuple[int, ...], graph: Graph) -> tuple[list[list[Expr]], Expr]:
    """N and |B| of the rows, as expressions."""
    from nullbody.nullspace.call import null_space

    if not rows:
        d = len(independent)
        return [[graph.constant(int(independent[j] == i)) for j in range(d)] for i in range(d)], graph.constant(1)
    space = null_space(rows, independent)
    N = [[entry if isinstance(entry, Expr) else graph.constant(entry) for entry in row] for row in space.basis]
    return N, space.delta if isinstance(space.delta, Expr) else graph.constant(space.delta)


def _figures(A: list[list[Any]], N: list[list[Any]], delta: Any, rows: tuple[int, ...]) -> list[Any]:
    """(spread, residual, share) of a null space."""
    columns = list(zip(*N, strict=True))
    lengths = [dot(row, row) for row in A]
    residual = total(
        total(product * product for product in (dot(row, column) for column in columns)) * (1 / length)
        for row, length in zip(A, lengths, strict=True)
        if length != 0
    )
    share = delta * delta
    for i in rows:
        share = share * (1 / lengths[i])
    return [total(dot(column, column) for column in columns), residual, share]


def _evaluated(pattern: _Pattern, values: FloatArray, *, fixed: bool) -> tuple[FloatArray, IndexArray]:
    """N (k, n, d), and which of them have to be done once more."""
    kernels, k = _kernels(pattern), len(values)
    if k == 1:
        N, delta = (array[None] for array in kernels.null_space(values[0]))
        figures = [np.atleast_1d(f) for f in kernels.figures(values[0], N.ravel(), delta)]
    else:
        N, delta = kernels.null_space.batch(values)
        figures = list(kernels.figures.batch(values, N.reshape(k, N.shape[1] * N.shape[2]), delta.reshape(k, 1)))
    spread, residual, share = figures
    allowed = _RESIDUAL**2 * spread if fixed else np.minimum(_RESIDUAL**2 * spread, _ANGLE**2)
    return N, np.flatnonzero(~((residual <= allowed) & (share >= _SHARE**2) & np.isfinite(spread)))


def compiled(matrices: Matrices, request: Request) -> Found:
    """The method "compiled": one chart for the stack, and another one for matrices that need it.

    Raises:
        InputError: complex matrices.
    """
    _require_real(matrices.scaled)
    n = matrices.shape[1]
    sample = matrices.at(np.unique(np.linspace(0, len(matrices) - 1, _SAMPLE).astype(np.intp)))
    found = complete(sample, request)
    independent = request.independent or _common_chart(found)
    used = np.argwhere((matrices.scaled != 0).any(axis=0))
    places = tuple((int(i), int(j)) for i, j in used)
    rows = tuple(map(int, found.chart.rows[0]))
    pattern = _Pattern(matrices.shape, places, (), rows, independent)
    N, bad = _evaluated(pattern, pattern.values(matrices.scaled), fixed=request.independent is not None)
    free = np.tile(np.array(independent, np.intp), (len(N), 1))
    chart = Chart(free, others(free, n), np.tile(np.array(rows, np.intp), (len(N), 1)))
    if len(bad):
        again = complete(matrices.at(bad), request)
        if again.reduced.shape[1:] != N.shape[1:]:
            raise InputError(
                f"the matrices of a stack must have one rank: {matrices.name(int(bad[0]))} has rank "
                f"{again.chart.rows.shape[1]}, others have rank {len(rows)}"
            )
        N[bad] = again.reduced
        chart.independent[bad], chart.dependent[bad] = again.chart.independent, again.chart.dependent
        chart.rows[bad] = again.chart.rows
    return Found(chart, N)


def _common_chart(found: Found) -> tuple[int, ...]:
    """Of the charts of some null spaces, the one whose worst condition over all of them is best."""
    Z, _ = orthonormalised(found.reduced)
    charts = np.unique(found.chart.independent, axis=0)
    corners = (rows_at(Z, np.broadcast_to(chart, found.chart.independent.shape)) for chart in charts)
    least = [np.linalg.svd(corner, compute_uv=False)[:, -1].min() for corner in corners]  # 1 / the worst condition
    return tuple(map(int, charts[int(np.argmax(least))]))


@final
@dataclass(frozen=True)
class ArrayFunction:
    """A compiled function A -> N = [-B^-1 C; I] for one zero pattern and one chart.

    Attributes:
        shape: (m, n) of A.
        independent: the columns that stay free.
        operations: of N and |B|.
    """

    shape: tuple[int, int]
    independent: tuple[int, ...]
    operations: Operations
    _pattern: _Pattern

    @classmethod
    def of(cls, space: NullSpaceStack, *, keep_constants: bool = False) -> ArrayFunction:
        """The function for the pattern, the rows and the columns of the only null space of a stack.

        Raises:
            InputError: complex matrices.
        """
        A = space.matrices
        _require_real(A)
        places, constants = [], []
        for i, j in np.argwhere(A[0] != 0).tolist():
            value = float(A[0, i, j])
            if keep_constants and value.is_integer():
                constants.append((i, j, Fraction(value)))
            else:
                places.append((i, j))
        rows, independent = (tuple(map(int, numbers[0])) for numbers in (space.rows, space.independent))
        pattern = _Pattern((A.shape[1], A.shape[2]), tuple(places), tuple(constants), rows, independent)
        return cls(pattern.shape, independent, _kernels(pattern).null_space.program.tape.operations, pattern)

    def __call__(self, A: ArrayLike) -> Array:
        """N (n, d) of a matrix (m, n), or (k, n, d) of a stack (k, m, n); float32 is worked on in double.

        Raises:
            InputError: another shape, complex or not finite numbers, entries outside the pattern, another rank.
            SingularityError: |B| = 0 to rounding; the message names columns that would do.
        """
        given = np.asarray(A)
        if given.dtype.kind not in "iuf" or given.ndim not in (2, 3) or given.shape[-2:] != self.shape:
            wanted = f"({self.shape[0]}, {self.shape[1]})"
            raise InputError(f"A must be real, of shape {wanted} or a stack of such, not {given.dtype} {given.shape}")
        stack = given if given.ndim == 3 else given[None]
        values = self._pattern.values(stack)
        self._pattern.require(stack, values)
        N, bad = _evaluated(self._pattern, values, fixed=True)
        if len(bad):
            N[bad] = self._pivoted(given, bad)
        result = N.astype(np.float32) if given.dtype.kind == "f" and given.dtype.itemsize <= 4 else N
        return result if given.ndim == 3 else result[0]

    def __repr__(self) -> str:
        m, n = self.shape
        columns = list(self.independent)
        return f"<ArrayFunction {m} x {n} -> {n} x {len(columns)}, independent columns {columns}, {self.operations}>"

    def _pivoted(self, given: Array, bad: IndexArray) -> Array:
        """The same by complete pivoting inside B, where the kernel's order of operations or the chart is bad."""
        part = given.reshape(-1, *self.shape)[bad]
        if not np.isfinite(part).all():
            finite_numbers(given, "A")  # raises, and names the place in the whole stack
        matrices = replace(Matrices.of(part), labels=bad, single=given.ndim == 2)
        request = Request(self.independent, (), relative_tolerance(matrices))
        return complete(matrices, request).reduced


def _require_real(A: Array) -> None:
    if np.iscomplexobj(A):
        raise InputError("compiled kernels work on real matrices; take the method 'complete' for complex ones")
