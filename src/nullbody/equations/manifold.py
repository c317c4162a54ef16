"""Configurations in which the loops close, in numbers: where rank and independence are decided.

A constraint Jacobian can have a rank that holds only where Phi = 0 (Bricard's mechanism, planar linkages between
revolute joints in space). A few configurations on the manifold tell: the home, closed by Gauss-Newton steps

    q <- q - A^+ Phi,

and others reached from it by steps along the null space of A, closed again.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nullbody.equations.closure import Closures
from nullbody.expr import Expr, Tape
from nullbody.typing import FloatArray

__all__ = ["Manifold", "Sample"]

_RANK = 1e-8  # singular values below this part of the largest are zero: rows have unit length there
_SHORT = 1e-3  # rows below this part of the longest are not scaled up to unit length
_NOISE = 1e-13  # of a row [m/m, m/rad]: some thousand roundings of lengths of a metre
_CLOSED = 1e-11  # |Phi| of a sample, for lengths of about 1
_STEPS = 60
_LONGEST = 0.5  # of a Gauss-Newton step [m, rad]
_SAMPLES = 5
_TRIES = 25
_STRIDE = 0.15  # along the null space, from one sample to the next [m, rad]
_STARTS = 8  # other starts, where the home itself does not close
_TIMES = (0.0, 0.37, 1.9)  # at which rates must exist that fulfil all rows [s]
_POOR = 1e-3  # smallest singular value of Z[v] below which other coordinates are preferred


@dataclass(frozen=True)
class Sample:
    """A configuration with closed loops.

    Attributes:
        q: coordinates.
        A: all rows, scaled to unit length.
    """

    q: FloatArray
    A: FloatArray

    @cached_property
    def rank(self) -> int:
        """The numeric rank of A."""
        return int(np.sum(self._svd[1] > _RANK * max(self._svd[1].max(initial=0.0), 1e-300)))

    @property
    def null_space(self) -> FloatArray:
        """Z, n x (n - rank), orthonormal."""
        return np.asarray(self._svd[2][self.rank :].T)

    @cached_property
    def _svd(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        if not len(self.A):
            return np.zeros((0, 0)), np.zeros(0), np.eye(self.A.shape[1])
        left, sizes, right = np.linalg.svd(self.A)
        return np.asarray(left), np.asarray(sizes), np.asarray(right)

    def rank_of(self, rows: Sequence[int]) -> int:
        """The numeric rank of some of the rows; all may be independent off the manifold, and fewer on it."""
        return int(np.linalg.matrix_rank(self.A[list(rows)], tol=_RANK)) if rows else 0

    def independent_rows(self, rank: int, first: Sequence[int] = ()) -> list[int]:
        """That many rows, the first ones and then each the longest of what those before it leave of them."""
        return sorted([*first, *_longest(self.A, rank - len(first), first)])

    def independent_columns(self, preferred: Sequence[int]) -> list[int]:
        """Columns v for which |B| is large: rows of Z, the longest first; preferred ones where they are not poor."""
        Z = self.null_space
        chosen = [k for k in preferred if len(preferred) <= Z.shape[1]]
        if self.quality(chosen) < _POOR:
            chosen = []
            for k in preferred:
                if len(chosen) < Z.shape[1] and self.quality([*chosen, k]) >= _POOR:
                    chosen.append(k)
        return [*chosen, *_longest(Z, Z.shape[1] - len(chosen), chosen)]

    def quality(self, columns: Sequence[int]) -> float:
        """The smallest singular value of Z[v], 1 at best: 1 / |N|."""
        rows = self.null_space[list(columns)]
        return float(np.linalg.svd(rows, compute_uv=False)[-1]) if rows.size else 1.0


class Manifold:
    """The constraint manifold near the home, in numbers.

    Args:
        loops: the constraints.
        symbols: those of the coordinates, and that of the time.
        parameters: values by name.
        home: where to start.
    """

    def __init__(
        self,
        loops: Closures,
        symbols: tuple[Sequence[Expr], Expr],
        parameters: Mapping[str, float],
        home: Mapping[str, float],
    ) -> None:
        q, time = symbols
        self._n, self._holonomic = len(q), len(loops.Phi)
        self._parameters = [*parameters.values()]
        self._home = np.array(list(home.values()))
        self._places = [(i, j) for i, row in enumerate(loops.A) for j, entry in enumerate(row) if entry != 0]
        entries = [loops.A[i][j] for i, j in self._places]
        outputs = [*loops.Phi, *entries, *(cosine for _, cosine in loops.facing), *loops.b]
        names = [*(str(s.name) for s in q), str(time.name), *parameters]
        self._rows = len(loops.A)
        self._tape = Tape.of(outputs, names)

    @cached_property
    def samples(self) -> tuple[Sample, ...]:
        """Configurations with closed loops, the one nearest to the home first; none where none was found."""
        random = np.random.default_rng(0)
        first = self.closed(self._home)
        for _ in range(_STARTS):
            if first is None:
                first = self.closed(self._home + random.uniform(-1, 1, self._n))
        if first is None:
            return ()
        found = [first]
        for _ in range(_TRIES):
            Z = found[-1].null_space
            if len(found) == _SAMPLES or not Z.size:
                break
            step = Z @ random.normal(size=Z.shape[1])
            start = found[-1].q + _STRIDE * step / max(float(np.abs(step).max()), 1e-12)
            sample = self.closed(start)
            if sample is not None and np.abs(sample.q - start).max() < _STRIDE:
                found.append(sample)
        return tuple(found)

    def closed(self, start: FloatArray) -> Sample | None:
        """The configuration near a start in which the loops close, or None."""
        q = np.array(start, dtype=float)
        size = max(1.0, float(np.abs(q).max(initial=0.0)))
        for _ in range(_STEPS):
            Phi, A, facing, _ = self._evaluated(q)
            if not np.isfinite(Phi).all() or not np.isfinite(A).all():
                return None
            if np.abs(Phi).max(initial=0.0) <= _CLOSED * size:
                return Sample(q, _unit_rows(A)) if (facing > 0).all() else None
            change = np.linalg.lstsq(A[: self._holonomic], -Phi, rcond=_RANK)[0]
            q += change * min(1.0, _LONGEST * size / max(float(np.abs(change).max()), 1e-300))
        return None

    def unfulfilled(self, sample: Sample) -> tuple[int, float] | None:
        """A row that moves with the time, and a time at which no rates fulfil A q' + b = 0; None if all can be.

        The other rows hold what it drives: b is not in the range of A. Times at which A has another rank are left out.
        """
        for t in _TIMES:
            _, A, _, b = self._evaluated(sample.q, t)
            scaled = _unit_rows(A)
            if not (np.isfinite(A).all() and np.isfinite(b).all()) or Sample(sample.q, scaled).rank != sample.rank:
                continue
            length = np.linalg.norm(A, axis=1)
            wanted = b / np.where(length > _NOISE, length, 1.0)
            left = wanted - scaled @ np.linalg.lstsq(scaled, wanted, rcond=_RANK)[0]
            if np.abs(left).max(initial=0.0) > _RANK**0.5 * np.abs(wanted).max(initial=0.0):
                return int(np.abs(np.where(b != 0, left, 0.0)).argmax()), t
        return None

    def _evaluated(self, q: FloatArray, t: float = 0.0) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Phi, A, the facing cosines and b; NaN where they have no value."""
        A = np.zeros((self._rows, self._n))
        try:
            values = np.array(self._tape.run([*q.tolist(), t, *self._parameters]), dtype=float)
        except (ZeroDivisionError, ValueError, OverflowError):
            return np.full(self._holonomic, np.nan), A, np.zeros(0), np.full(self._rows, np.nan)
        for (i, j), value in zip(self._places, values[self._holonomic :], strict=False):
            A[i, j] = value
        end = len(values) - self._rows
        return values[: self._holonomic], A, values[self._holonomic + len(self._places) : end], values[end:]


def _unit_rows(A: FloatArray) -> FloatArray:
    """Rows of unit length; short ones, which may be about to vanish in a singular configuration, stay short.

    What rounding leaves of a loop between bodies that cannot move against each other is no row at all.
    """
    length = np.linalg.norm(A, axis=1)
    A = np.where(length[:, None] > _NOISE, A, 0.0)
    scaled: FloatArray = A / np.maximum(length, max(_SHORT * float(length.max(initial=0.0)), 1e-300))[:, None]
    return scaled


def _longest(rows: FloatArray, count: int, first: Sequence[int] = ()) -> list[int]:
    """Rows picked one by one, each the longest of what those before it leave (pivoted Gram-Schmidt)."""
    left, found = np.array(rows, dtype=float), []
    for k in (*first, *[None] * count):
        if k is None:
            lengths = np.linalg.norm(left, axis=1)
            k = max(range(len(rows)), key=lambda i: (round(float(lengths[i]), 6), -i))
            found.append(k)
        direction = left[k] / max(float(np.linalg.norm(left[k])), 1e-300)
        left = left - np.outer(left @ direction, direction)
    return found
