"""The basis of a null space as a compiled function of its symbols: one point or many at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isfinite
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nullbody.errors import InputError, SingularityError, UnknownName
from nullbody.expr import Expr, Graph, Tape
from nullbody.kernels import Kernel, Program, compile_programs
from nullbody.kernels.reference import FUNCTIONS
from nullbody.nullspace.numeric.equilibrate import Matrices
from nullbody.nullspace.result import Form
from nullbody.nullspace.sample import double, sampled
from nullbody.nullspace.switch import better_chart, conditions, orthonormal
from nullbody.nullspace.symbolic import SymbolicNullSpace
from nullbody.tolerances import EPS, REGULAR_SPREAD
from nullbody.typing import FloatArray

__all__ = ["NullSpaceFunction", "function_of"]

_SHOWN = 6  # symbols whose values a message shows


def function_of(space: SymbolicNullSpace) -> NullSpaceFunction:
    """The basis of a null space, in its form, as a compiled function; native code is kept in the cache.

    Raises:
        InputError: a constant of the basis is beyond the range of doubles.
        CacheError: the cache cannot be written or trusted; NULLBODY_CACHE=off does without.
    """
    delta = space._factors.delta
    entries = [entry for row in space.inward(space.form) for entry in row]
    others = () if space.form in ("reduced", "scaled") else [entry for row in space.inward("reduced") for entry in row]
    arguments = _Arguments.of(space, [*entries, *others])
    delta_arguments = _Arguments.of(space, [*entries, *others, delta])
    basis, determinant = _compiled(
        _Part("null_space", arguments, entries, space.shape), _Part("delta", delta_arguments, [delta], ())
    )
    return NullSpaceFunction(space.form, space.independent, arguments.names, space, basis, determinant)


@dataclass(frozen=True, repr=False)
class NullSpaceFunction:
    """The basis as a function of its symbols.

    Attributes:
        form: the form of the basis.
        independent: the columns that are free, in the order of the basis's columns.
        symbols: the arguments, in the order of their creation. A stand-in of the SymPy bridge is one too, under its
            short name or as SymPy prints it; one that is a number (pi) is not.
    """

    form: Form
    independent: tuple[int, ...]
    symbols: tuple[str, ...]
    _space: SymbolicNullSpace
    _basis: _Compiled
    _delta: _Compiled

    def __call__(
        self, x: ArrayLike | Mapping[str, ArrayLike] | None = None, /, *, check: bool = True, **values: ArrayLike
    ) -> FloatArray:
        """The basis at one point, (n, d), or at N points, (N, n, d), 8 of which are evaluated at a time.

        Args:
            x: numbers (k,) or (N, k) in the order of `symbols`; or a mapping from names to numbers and arrays (N,).
            check: look for arguments that are not finite, and for points too close to |B| = 0: where EPS |N| exceeds
                1e-9. Without it nothing is looked for, and rows of such points are large, infinite or NaN.
            values: instead of x, a number or an array (N,) for every symbol.

        Raises:
            UnknownName: there is no such symbol.
            InputError: symbols are missing, or arguments have another shape, are no real numbers or not finite.
            SingularityError: |B| = 0 to rounding at a point; the message names columns that would do there.
        """
        X = self._basis.arguments.array(x, values)
        if check:
            _finite(X, self.symbols)
        N = self._basis(X)
        if check and not self._regular(N).all():
            raise self._singular(X, ~self._regular(N))
        return N

    def delta(self, x: ArrayLike | Mapping[str, ArrayLike] | None = None, /, **values: ArrayLike) -> Any:
        """|B|, a float, or (N,) for N points; arguments as for the basis.

        Where |B| needs symbols that the basis does not need, x has `delta_symbols`.
        """
        X = self._delta.arguments.array(x, values)
        _finite(X, self.delta_symbols)
        result = self._delta(X)
        return result if result.ndim else float(result)

    @property
    def delta_symbols(self) -> tuple[str, ...]:
        """The arguments of `delta`: those of the basis, and what |B| needs beside them."""
        return self._delta.arguments.names

    def subspace_error(self, x: ArrayLike | Mapping[str, ArrayLike] | None = None, /, **values: ArrayLike) -> Any:
        """EPS times the largest singular value of N = [-B^-1 C; I]: by how much rounding turns the subspace [rad].

        Infinite at |B| = 0. Where it exceeds what you can bear, change the chart (`better_chart`).

        Returns:
            A float, or (N,) for N points; arguments as for the basis.
        """
        X = self._basis.arguments.array(x, values)
        _finite(X, self.symbols)
        with np.errstate(all="ignore"):
            if self.form == "scaled":
                N: Any = self._basis(X)
                N = N / N[..., self.independent[0], 0][..., None, None]
            else:
                N = self._reduced(X)
        regular = np.asarray(np.isfinite(N).all(axis=(-2, -1)))
        largest = np.linalg.norm(np.where(regular[..., None, None], N, 0.0), 2, axis=(-2, -1))
        error = EPS * np.where(regular, largest, np.inf)
        return error if error.ndim else float(error)

    def __repr__(self) -> str:
        n, d = self._space.shape
        names = list(self.symbols) if len(self.symbols) <= 12 else [*self.symbols[:5], "...", self.symbols[-1]]
        return f"<NullSpaceFunction ({', '.join(names)}) -> {self.form} {n} x {d}>"

    @cached_property
    def _reduced(self) -> _Compiled:
        if self.form == "reduced":
            return self._basis
        entries = [entry for row in self._space.inward("reduced") for entry in row]
        return _compiled(_Part("null_space", self._basis.arguments, entries, self._space.shape))[0]

    def _regular(self, N: FloatArray) -> Any:
        """Whether |N|^2 <= REGULAR_SPREAD, of the reduced basis; of the orthogonal forms that of N^, about as large."""
        if N.ndim == 2 and self.form in ("reduced", "orthogonal"):  # one point: in a microsecond
            return np.vdot(N, N) <= REGULAR_SPREAD
        with np.errstate(all="ignore"):
            if self.form == "orthonormal":  # its rows at the independent columns hold 1 / |column of N^|
                lengths = 1 / N[..., self.independent, range(len(self.independent))]
                return (lengths * lengths).sum(axis=-1) <= REGULAR_SPREAD
            spread = np.einsum("...ij,...ij->...", N, N)
            return (spread / N[..., self.independent[0], 0] ** 2 if self.form == "scaled" else spread) <= REGULAR_SPREAD

    def _singular(self, X: FloatArray, singular: Any) -> SingularityError:
        """What to raise for the first point that is too close to |B| = 0."""
        arguments, place = self._basis.arguments, ""
        if X.ndim == 2:
            bad = np.flatnonzero(singular)
            place = f"point {bad[0]} ({len(bad)} of {len(X)} points are singular): "
            X = X[bad[0]]
        point = dict(zip(arguments.names, map(float, X), strict=True))
        shown = ", ".join(f"{name} = {value:.6g}" for name, value in list(point.items())[:_SHOWN])
        text = f"{place}null space at {shown}{', ...' if len(point) > _SHOWN else ''}: "
        (A,) = sampled(self._space.simplified, [{**point, **arguments.fixed}])
        chosen = list(self.independent)
        if not np.isfinite(A).all():
            return SingularityError(f"{text}A itself is not finite there")
        (Z,) = orthonormal(Matrices.of(A), len(A))
        if Z is None:
            return SingularityError(f"{text}A loses rank, so that |B| = 0 for all choices of independent columns")
        condition = conditions(Z, np.array([chosen]))[0]
        if condition * condition <= REGULAR_SPREAD:
            return SingularityError(
                f"{text}a pivot of the elimination vanishes, though |B| does not; use method='minors'"
            )
        would_do = list(better_chart(A, self.independent))
        return SingularityError(
            f"{text}|B| = 0 to rounding, EPS |N| = {EPS * condition:.1e}: columns {chosen} cannot be the independent "
            f"ones there; columns {would_do} would do (check=False evaluates all the same)"
        )


# -- arguments --------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Arguments:
    """The symbols of some expressions.

    Attributes:
        names: those that are arguments, in the order of their creation.
        fixed: stand-ins that are numbers, with their values.
        printed: how stand-ins are printed, and their names.
        hints: what to say of names that stand in A and are no arguments.
    """

    names: tuple[str, ...] = ()
    fixed: Mapping[str, float] = field(default_factory=dict)
    printed: Mapping[str, str] = field(default_factory=dict)
    hints: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, space: SymbolicNullSpace, entries: Sequence[Any]) -> _Arguments:
        given = [entry for row in space._given.matrix for entry in row.values() if isinstance(entry, Expr)]
        if not given:
            return cls()
        graph = given[0].graph
        mask = _symbols_of(graph, entries)
        everything = mask | _symbols_of(graph, given)
        names, fixed, printed = [], {}, {}
        cancelled: dict[str, str] = {}
        inner: dict[str, str] = {}
        for k, name in enumerate(graph.symbols):
            if not everything >> k & 1:
                continue
            meant = space._given.outward(graph.symbol(name))
            text = name if isinstance(meant, Expr) else str(meant)
            if not mask >> k & 1:
                cancelled |= dict.fromkeys((name, text), f"{text!r} cancels out of this basis")
            elif getattr(meant, "is_number", False):
                fixed[name] = float(meant)
            else:
                names.append(name)
                printed[text] = name
                remark = f"{text} is an argument of its own: give its value"
                inner |= dict.fromkeys(map(str, getattr(meant, "free_symbols", ())), remark)
        others = {text: name for text, name in printed.items() if text not in names}
        return cls(tuple(names), fixed, others, cancelled | inner)

    def array(self, x: Any, values: Mapping[str, Any]) -> FloatArray:
        """Numbers (k,) or (N, k) from what a caller gave."""
        if isinstance(x, Mapping):
            x, values = None, {**{str(name): value for name, value in x.items()}, **values}
        if x is not None and values:
            raise InputError(f"give the numbers in one array or by name, not both: {', '.join(values)} came by name")
        if x is None:
            return self._named(values)
        array = _real(x, "the argument")
        if array.ndim not in (1, 2) or array.shape[-1] != len(self.names):
            raise InputError(
                f"the argument has shape {array.shape}, not ({len(self.names)},) or (N, {len(self.names)}): "
                f"{self._listed()}"
            )
        return array

    def _named(self, values: Mapping[str, Any]) -> FloatArray:
        found = {}
        for name, value in values.items():
            known = self.printed.get(name, name)
            if known not in self.names:
                hint = f" ({self.hints[name]})" if name in self.hints else ""
                raise UnknownName("symbol", name, self.names, place=f"the null space{hint}")
            found[known] = _real(value, known)
        missing = [name for name in self.names if name not in found]
        if missing:
            raise InputError(f"the null space needs values for {', '.join(missing)}: {self._listed()}")
        if any(value.ndim > 1 for value in found.values()):
            raise InputError("by name, a symbol has one number or an array (N,)")
        try:
            columns = np.broadcast_arrays(*(found[name] for name in self.names))
        except ValueError:
            sizes = ", ".join(f"{name} {found[name].size}" for name in self.names if found[name].ndim)
            raise InputError(f"the numbers of points differ: {sizes}") from None
        return np.stack(columns, axis=-1) if columns else np.zeros(0)

    def _listed(self) -> str:
        return f"its symbols are {', '.join(self.names)}" if self.names else "it has no symbols"


def _symbols_of(graph: Graph, entries: Sequence[Any]) -> int:
    """The symbols on which the expressions among some entries depend, as bits."""
    mask = 0
    for entry in entries:
        if isinstance(entry, Expr):
            mask |= graph.depends[entry.ref >> 1]
    return mask


def _real(value: Any, name: str) -> FloatArray:
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise InputError(f"{name} is no array of numbers: {error}") from None
    if array.size and array.dtype.kind not in "iuf":
        raise InputError(f"{name} must be real numbers, not {array.dtype}")
    return np.asarray(array, dtype=np.float64)


def _finite(X: FloatArray, names: Sequence[str]) -> None:
    if not (all(map(isfinite, X.tolist())) if X.ndim == 1 else np.isfinite(X).all()):
        place = np.argwhere(~np.isfinite(X))[0]
        point = f" at point {place[0]}" if len(place) == 2 else ""
        raise InputError(f"{names[place[-1]]} must be finite, not {X[tuple(place)]}{point}")


# -- programs ---------------------------------------------------------------------------------------------------


class _Part(NamedTuple):
    """Something to be compiled."""

    name: str
    arguments: _Arguments
    entries: Sequence[Any]
    shape: tuple[int, ...]


@dataclass(frozen=True)
class _Compiled:
    """An array of some shape as a function of arguments (k,) or (N, k); without arguments a constant one."""

    arguments: _Arguments
    value: Kernel | FloatArray

    def __call__(self, X: FloatArray) -> FloatArray:
        if isinstance(self.value, Kernel):
            return self.value(X)[0] if X.ndim == 1 else self.value.batch(X)[0]
        return np.tile(self.value, (*X.shape[:-1], *(1 for _ in self.value.shape)))


def _compiled(*parts: _Part) -> list[_Compiled]:
    """All parts, in one piece of native code."""
    programs = {k: _program(part) for k, part in enumerate(parts) if part.arguments.names}
    kernels = compile_programs(list(programs.values())).kernels if programs else {}
    return [
        _Compiled(part.arguments, kernels[part.name] if k in programs else _constant(part))
        for k, part in enumerate(parts)
    ]


def _program(part: _Part) -> Program:
    return Program(part.name, (("x", len(part.arguments.names)),), (("N", part.shape),), _tape(part))


def _constant(part: _Part) -> FloatArray:
    if any(isinstance(entry, Expr) for entry in part.entries):
        with np.errstate(all="ignore"):
            values = _tape(part).run([], FUNCTIONS)
    else:
        values = [double(entry) for entry in part.entries]
    return np.array(values, dtype=np.float64).reshape(part.shape)


def _tape(part: _Part) -> Tape:
    """The tape of a part; stand-ins that are numbers are constants in it."""
    graph: Graph = next(entry.graph for entry in part.entries if isinstance(entry, Expr))
    entries = [entry if isinstance(entry, Expr) else graph.constant(entry) for entry in part.entries]
    names, fixed = part.arguments.names, part.arguments.fixed
    try:
        tape = Tape.of(entries, [*names, *fixed])
    except OverflowError:
        raise InputError("a constant of the basis is beyond the range of doubles") from None
    first = len(tape.constants)
    code = [
        ("const", first + a - len(names), 0) if op == "symbol" and a >= len(names) else (op, a, b)
        for op, a, b in tape.code
    ]
    return replace(tape, inputs=names, constants=(*tape.constants, *fixed.values()), code=tuple(code))
