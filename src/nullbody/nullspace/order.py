"""The order in which a block's lines are expanded by minors: it decides how many products there are.

Rows that no right-hand side enters need no cofactors of their own, and sparse lines at both ends have few minors. How
many operations an order takes is counted on the pattern of non-zeros, without making a single one.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any, NamedTuple

from nullbody.nullspace.scalar import is_zero

__all__ = ["Lines", "chosen_lines", "products"]

_LARGEST = 8  # the largest block for which orders are counted
_STARTS = 6  # lines from which an order is grown
_TRIALS = 30  # exchanges that are tried for a seed


class Lines(NamedTuple):
    """How a block is cut into lines: their order, and whether they are rows or columns."""

    order: tuple[int, ...]
    by_rows: bool


def chosen_lines(matrix: Sequence[Sequence[Any]], driven: set[int], seed: int | None) -> Lines:
    """The lines for a block.

    Args:
        matrix: the block.
        driven: its rows that right-hand sides enter.
        seed: None for the best of a few good orders; a number for one that is reached from there by exchanges.
            Outside 3..8 lines the order is grown once, and the seed does not matter.
    """
    n = len(matrix)
    rows = [sum(1 << j for j, entry in enumerate(row) if not is_zero(entry)) for row in matrix]
    if not 2 < n <= _LARGEST:
        return Lines(_grown(rows, min(range(n), key=lambda k: rows[k].bit_count())), True)
    columns = [sum(1 << i for i in range(n) if rows[i] >> j & 1) for j in range(n)]
    starts = [Lines(_grown(rows, k), True) for k in _sparsest(rows)]
    if len(driven) == n:  # rows cannot be spared: columns may be the cheaper lines
        starts += [Lines(_grown(columns, k), False) for k in _sparsest(columns)]
    counts = [products(rows if lines.by_rows else columns, lines, driven) for lines in starts]
    best = starts[min(range(len(starts)), key=counts.__getitem__)]
    return best if seed is None else _exchanged(best, rows if best.by_rows else columns, driven, seed)


def _sparsest(masks: Sequence[int]) -> list[int]:
    """The lines from which an order may start."""
    return sorted(range(len(masks)), key=lambda k: masks[k].bit_count())[:_STARTS]


def _grown(masks: Sequence[int], first: int) -> tuple[int, ...]:
    """An order in which every line adds as few new places as possible: few minors at both ends."""
    order, rest = [first], set(range(len(masks))) - {first}
    seen = masks[first]
    while rest:
        line = min(rest, key=lambda k: ((masks[k] & ~seen).bit_count(), -masks[k].bit_count(), k))
        order.append(line)
        rest.remove(line)
        seen |= masks[line]
    return tuple(order)


def _exchanged(lines: Lines, masks: Sequence[int], driven: set[int], seed: int) -> Lines:
    """An order reached by random exchanges of two lines, none of which made it dearer by more than a tenth."""
    source = random.Random(seed)
    fewest = products(masks, lines, driven)
    for _ in range(_TRIALS):
        order = list(lines.order)
        i, j = source.sample(range(len(order)), 2)
        order[i], order[j] = order[j], order[i]
        other = Lines(tuple(order), lines.by_rows)
        count = products(masks, other, driven)
        if count <= 1.1 * fewest:
            lines, fewest = other, min(fewest, count)
    return lines


def products(masks: Sequence[int], lines: Lines, driven: set[int]) -> int:
    """Operations of the cofactors that are needed, were nothing to merge or cancel.

    Args:
        masks: the places of non-zeros of every line, as bits.
        lines: their order.
        driven: the rows whose cofactors are needed.
    """
    n, full = len(masks), (1 << len(masks)) - 1
    ordered = [masks[k] for k in lines.order]
    first, cost = _minors(ordered)
    last, more = _minors(ordered[::-1])
    cost += more
    for k, line in enumerate(lines.order):
        if lines.by_rows and line not in driven:
            continue
        for place in range(n) if lines.by_rows else driven:
            rest = full ^ (1 << place)
            terms = sum(1 for chosen in first[k] if not chosen & ~rest and rest ^ chosen in last[n - 1 - k])
            cost += max(0, terms - 1) + (terms if 0 < k < n - 1 else 0)
    return cost


def _minors(lines: Sequence[int]) -> tuple[list[set[int]], int]:
    """The places on which the first lines have minors, for every number of lines, and the operations of these."""
    sets, cost = [{0}], 0
    for k, mask in enumerate(lines[:-1]):
        terms: dict[int, int] = {}
        for chosen in sets[-1]:
            free = mask & ~chosen
            while free:
                bit = free & -free
                free ^= bit
                terms[chosen | bit] = terms.get(chosen | bit, 0) + 1
        cost += sum(2 * count - 1 for count in terms.values()) if k else 0
        sets.append(set(terms))
    return sets, cost
