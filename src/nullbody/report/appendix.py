"""Section: the paper's appendix, exactly, in fractions."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from nullbody.nullspace import null_space, orthogonal_basis
from nullbody.report.section import Check, Section, Table, Text

__all__ = ["appendix"]

_A = ((1, 2, 0, 1), (5, 8, 1, 3))
_HALF, _THIRD = Fraction(1, 2), Fraction(1, 3)
_PAPER_N = ((-1, 1), (_HALF, -1), (1, 0), (0, 1))
_PAPER_SCALED = ((2, -2), (-1, 2), (-2, 0), (0, -2))
_PAPER_ORTHOGONAL = ((-1, _THIRD), (_HALF, -2 * _THIRD), (1, 2 * _THIRD), (0, 1))
_PAPER_D = ((Fraction(9, 4), 0), (0, 2))
_PAPER_DELTA, _PAPER_DELTA_2 = -2, Fraction(-9, 2)


def appendix() -> Section:
    """A = [[1, 2, 0, 1], [5, 8, 1, 3]]: N, |B| and the orthogonal basis as fractions."""
    A = [[Fraction(entry) for entry in row] for row in _A]
    space = null_space(A, (2, 3))
    first = [row[0] for row in space.basis]
    appended = null_space([*A, first], (3,))
    orthogonal = orthogonal_basis(A, (2, 3))
    D = _product(tuple(zip(*orthogonal, strict=True)), orthogonal)
    zero = _product(A, orthogonal)
    pairs: list[tuple[str, Any, Any]] = [
        ("|B|", _PAPER_DELTA, space.delta),
        ("N", _PAPER_N, space.basis),
        ("|B| N", _PAPER_SCALED, space.scaled),
        ("|B| with N₁ appended", _PAPER_DELTA_2, appended.delta),
        ("orthogonal N", _PAPER_ORTHOGONAL, orthogonal),
        ("NᵀN of it", _PAPER_D, D),
        ("A N of it", ((0, 0), (0, 0)), zero),
    ]
    rows = tuple(
        (name, _text(paper), _text(found), "equal" if _same(paper, found) else "DIFFERENT")
        for name, paper, found in pairs
    )
    exact = all(_same(paper, found) for _, paper, found in pairs)
    return Section(
        "appendix",
        "The appendix's example, exactly",
        (
            Text(
                "<i>A</i> = [1 2 0 1; 5 8 1 3]. The determinant method needs only sums, products and one division, "
                "so the same code that derives the robot runs on fractions. The paper prints decimals (0.33, "
                "−0.66); here are the fractions behind them."
            ),
            Table(("quantity", "paper", "found", "verdict"), rows),
        ),
        (Check.holds("All fractions of the appendix are the paper's", exact, "exactly equal"),),
        {"appendix.exact": exact},
    )


def _product(left: Sequence[Sequence[Any]], right: Sequence[Sequence[Any]]) -> tuple[tuple[Any, ...], ...]:
    columns = list(zip(*right, strict=True))
    return tuple(tuple(sum(a * b for a, b in zip(row, column, strict=True)) for column in columns) for row in left)


def _same(one: Any, two: Any) -> bool:
    """Whether two scalars or matrices are equal, entry by entry."""
    if isinstance(one, Sequence):
        return len(one) == len(two) and all(_same(a, b) for a, b in zip(one, two, strict=True))
    return bool(one == two)


def _text(value: Any) -> str:
    if isinstance(value, Sequence):
        return "[" + "; ".join(", ".join(str(entry) for entry in row) for row in value) + "]"
    return str(value)
