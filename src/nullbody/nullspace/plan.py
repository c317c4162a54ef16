"""A plan: the choices that leave a null space as it is and change only how many operations it takes."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

__all__ = ["DEFAULT", "SMALL_BLOCK", "Plan", "Weights"]

#: The largest irreducible block that is expanded by minors unless asked to: a dense block of 6 takes some 200 products
#: by minors and 90 by elimination, one of 9 takes 4000 and 250.
SMALL_BLOCK = 6


@dataclass(frozen=True)
class Weights:
    """What rows are taken to cost while they are simplified.

    Attributes:
        operation: each operation in a non-zero entry, beside 1 for the entry itself.
        constant: an entry that is a number.
    """

    operation: float = 0.02
    constant: float = 0.8

    def entry(self, size: int) -> float:
        """The cost of an entry that is an expression with so many operations."""
        return 1.0 + self.operation * size


@dataclass(frozen=True)
class Plan:
    """Choices on the way from A to N.

    Attributes:
        seed: decides between choices that look alike; None takes the first.
        largest: the largest block that is expanded by minors; 0 leaves everything to pivots.
        simplify: whether to make rows cheaper by constant row operations first.
        weights: what they are taken to cost then.
        offsets: whether right-hand sides other than A's own columns (gamma) will come.
        noise: how much the gain of a row operation is varied at random.
        sizes: absolute values of an expression at points that matter: pivots that are expressions are not taken where
            they are small there against their column. None takes any.
    """

    seed: int | None = None
    largest: int = SMALL_BLOCK
    simplify: bool = True
    weights: Weights = Weights()
    noise: float = 0.0
    offsets: bool = False
    sizes: Callable[[Any], Any] | None = field(default=None, compare=False, repr=False)

    @classmethod
    def random(cls, seed: int, like: Plan) -> Plan:
        """A plan like another one, with its choices drawn from a seed."""
        source = random.Random(seed)
        weights = Weights(source.choice((0.02, 0.05, 0.1, 0.2, 0.4)), source.choice((0.02, 0.1, 0.2, 0.4, 0.8)))
        return replace(like, seed=seed, weights=weights, noise=source.choice((0.0, 0.3, 1.0)))

    def tie(self) -> Callable[[], float]:
        """A source of numbers that decide ties: the same sequence for the same plan."""
        if self.seed is None:
            return lambda: 0.0
        return random.Random(self.seed).random


DEFAULT = Plan()
