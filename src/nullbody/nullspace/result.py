"""What `null_space` returns: a basis N with A N = 0, and what is needed to use it and to trust it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from nullbody.expr import Operations

__all__ = ["FORMS", "Form", "NullSpace"]

Form = Literal["reduced", "scaled", "orthogonal", "orthonormal"]

#: The forms of a basis, and what each one means.
FORMS: Mapping[str, str] = {
    "reduced": "N = [-B^-1 C; I]: the identity in the independent places",
    "scaled": "N~ = |B| N = [-adj(B) C; |B| I]: free of divisions",
    "orthogonal": "N^ = N T, T unit upper triangular: N^^T N^ is diagonal",
    "orthonormal": "Z = N^ with columns of length 1: Z^T Z = I",
}


@dataclass(frozen=True, eq=False, repr=False)
class NullSpace(ABC):
    """A basis of the null space of A (m x n, rank r), n x d with d = n - r.

    With the columns of A split into dependent ones B and independent ones C, A's rows `rows` give

        N = [-B^-1 C; I],   delta = |B|,   N~ = delta N                                     [9, 11-13]

    Attributes:
        form: which of `FORMS` `basis` has.
        method: how it was found.
        independent: columns of A that are free, in the order of the basis's columns.
        dependent: the other columns, in increasing order.
        rows: independent rows of A that were used.
        redundant: rows of A that repeat others; `repeats` says how.
    """

    form: Form
    method: str
    independent: tuple[int, ...]
    dependent: tuple[int, ...]
    rows: tuple[int, ...]
    redundant: tuple[int, ...]

    @property
    def rank(self) -> int:
        """The rank of A."""
        return len(self.rows)

    @property
    def shape(self) -> tuple[int, int]:
        """(n, d) of the basis."""
        return len(self.dependent) + len(self.independent), len(self.independent)

    @property
    @abstractmethod
    def delta(self) -> Any:
        """|B|, the pivot of the chosen columns; it vanishes where they are a bad choice."""

    @property
    def basis(self) -> Any:
        """The basis in the form that was asked for, n x d: q' = basis u."""
        return self.in_form(self.form)

    @abstractmethod
    def in_form(self, form: Form) -> Any:
        """The basis in one of `FORMS`, n x d."""

    @property
    def reduced(self) -> Any:
        """N = [-B^-1 C; I]: q' = N v."""
        return self.in_form("reduced")

    @property
    def scaled(self) -> Any:
        """N~ = |B| N, free of divisions where it is made of determinants."""
        return self.in_form("scaled")

    @property
    def orthogonal(self) -> Any:
        """N^ = N T with N^^T N^ diagonal: q' = N^ u."""
        return self.in_form("orthogonal")

    @property
    def orthonormal(self) -> Any:
        """Z with Z^T Z = I: q' = Z u."""
        return self.in_form("orthonormal")

    @property
    @abstractmethod
    def repeats(self) -> Mapping[int, Mapping[int, Any]]:
        """How redundant rows repeat others: A[i] = sum_k repeats[i][k] A[k], over rows k of `rows`."""

    @property
    @abstractmethod
    def condition(self) -> float:
        """The largest singular value of N = [-B^-1 C; I]: 1 at best, infinite where |B| = 0.

        It does not change when rows of A are scaled. Velocities v of size 1 give coordinates of at most this size.
        """

    @property
    @abstractmethod
    def subspace_error(self) -> float:
        """The angle [rad] by which rounding turns the subspace: about eps * condition; 0 for exact numbers.

        |A N| never shows this error. Where it exceeds what you can bear, choose other independent columns
        (`charts`, or leave `independent` out), or take the form "orthonormal".
        """

    @abstractmethod
    def offset(self, c: Sequence[Any]) -> Any:
        """gamma with A gamma + c = 0 and zeros in the independent places: gamma = [-B^-1 c; 0]   [40, 41 corrected].

        Args:
            c: one entry for each row of A.
        """

    @property
    @abstractmethod
    def operations(self) -> Operations | None:
        """Operation counts of the basis, each shared sub-expression once; None where nothing is left to evaluate."""

    @abstractmethod
    def to_sympy(self) -> Any:
        """The basis as a SymPy matrix."""

    @abstractmethod
    def latex(self) -> str:
        """The basis in LaTeX."""

    def __repr__(self) -> str:
        n, d = self.shape
        parts = [f"{self.form} {n} x {d}", f"rank {self.rank}", f"independent columns {_listed(self.independent)}"]
        if self.redundant:
            parts.append(f"redundant rows {_listed(self.redundant)}")
        return f"<NullSpace {', '.join([*parts, f'by {self.method}', self._figure])}>"

    @property
    @abstractmethod
    def _figure(self) -> str:
        """The last word of the repr: what the basis costs, or how good it is."""


def _listed(numbers: Sequence[int]) -> str:
    """A list of indices that fits a line."""
    if len(numbers) <= 12:
        return str(list(numbers))
    return f"[{', '.join(map(str, numbers[:5]))}, ... {numbers[-1]}] ({len(numbers)})"
