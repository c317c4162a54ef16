"""Independent coordinates for a configuration: when those at hand are poor there, and which are good.

With an orthonormal basis Z of the null space of A, |N| = 1 / (smallest singular value of Z[v]): see
`nullbody.nullspace.switch`. Lengths are measured in the mechanism's own typical length there, so that units do not
decide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nullbody.model import Model
from nullbody.model.scale import without_units
from nullbody.typing import FloatArray

__all__ = ["Configuration", "regular_chart", "regularity"]

_RANK = 1e-9  # relative; singular values of A below it are zero
_GOOD = 0.15  # smallest singular value of Z[v], 1 at best, from which the independent coordinates are kept
_WORTH = 2.0  # by which other coordinates must be better
_TIE = 1e-6  # lengths of rows of Z that differ by less are equal, and the first is taken


@dataclass(frozen=True, eq=False)
class Configuration:
    """A at one configuration, and its null space.

    Attributes:
        labels: of the rows of A.
        A: without units.
        sizes: singular values of A.
        Z: orthonormal basis of the null space of the wanted dimension.
    """

    labels: tuple[str, ...]
    A: FloatArray
    sizes: FloatArray
    Z: FloatArray

    @classmethod
    def of(cls, model: Model, q: FloatArray, t: float = 0.0) -> Configuration:
        """All rows of A, those included that repeat others on the manifold, in radians and typical lengths."""
        labels, A = model.all_rows(q, t)
        A = without_units(model, A)
        if not len(A):
            return cls(labels, A, np.zeros(0), np.eye(len(q)))
        _, sizes, right = np.linalg.svd(A)
        return cls(labels, A, sizes, right[len(model.labels) :].T)

    @property
    def regularity(self) -> float:
        """The smallest singular value that counts against the largest: 0 where A loses rank."""
        rank = self.Z.shape[0] - self.Z.shape[1]
        return float(self.sizes[rank - 1] / self.sizes[0]) if rank else 1.0

    def quality(self, columns: list[int]) -> float:
        """1 / |N| for a choice of independent coordinates."""
        rows = self.Z[columns]
        return float(np.linalg.svd(rows, compute_uv=False)[-1]) if rows.size else 1.0

    def best_columns(self) -> list[int]:
        """The places of good independent coordinates."""
        return sorted(_longest(self.Z, self.Z.shape[1]))

    def best_rows(self) -> list[str]:
        """The labels of rows that are well independent of each other."""
        rank = self.Z.shape[0] - self.Z.shape[1]
        return [self.labels[i] for i in sorted(_longest(self.A, rank))]

    def row_quality(self, labels: tuple[str, ...]) -> float:
        """The smallest singular value of some rows against the largest of all."""
        if not labels:
            return 1.0
        kept = [self.labels.index(label) for label in labels]
        return float(np.linalg.svd(self.A[kept], compute_uv=False)[-1] / self.sizes[0])


def regularity(model: Model, q: FloatArray, t: float = 0.0) -> float:
    """`Configuration.regularity` alone, at less cost."""
    A = without_units(model, model.all_rows(q, t)[1])
    rank = len(model.labels)
    sizes = np.linalg.svd(A, compute_uv=False)
    return float(sizes[rank - 1] / sizes[0]) if rank else 1.0


def regular_chart(model: Model, q: FloatArray, t: float = 0.0, *, good: float = _GOOD) -> Model:
    """The model in independent coordinates and rows that are regular at a configuration: itself where it is good.

    Where A itself loses rank nothing is better than what is at hand.
    """
    here = Configuration.of(model, q, t)
    if here.regularity < _RANK:
        return model
    rows, names = model.labels, list(model.independent)
    if here.row_quality(rows) < good * here.regularity:
        rows = tuple(here.best_rows())
    quality = here.quality(model.independent_columns)
    if quality < good:
        columns = here.best_columns()
        if here.quality(columns) > _WORTH * quality:
            names = [model.coordinates[k] for k in columns]
    if rows == model.labels and tuple(names) == model.independent:
        return model
    return model.in_chart(names, rows)


def _longest(rows: FloatArray, count: int) -> list[int]:
    """Rows picked one by one, each the longest of what those before it leave (pivoted Gram-Schmidt)."""
    left, found = np.array(rows), []
    for _ in range(count):
        lengths = np.linalg.norm(left, axis=1)
        row = int(np.argmax(lengths >= lengths.max() - _TIE))
        direction = left[row] / lengths[row]
        left = left - np.outer(left @ direction, direction)
        found.append(row)
    return found
