"""Shared by the tests of the kernels: a cache of their own, and random programs."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import pytest

from nullbody.expr import Expr, Graph, cos, sin, sqrt
from nullbody.expr.tape import Tape
from nullbody.kernels import Program


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The cache folder of this test."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("NULLBODY_CACHE", str(folder))
    return folder


def _random_step(rng: random.Random, graph: Graph, pool: list[Expr]) -> Expr:
    a, b, x = rng.choice(pool[-50:]), rng.choice(pool), rng.choice(pool[:7])
    c = graph.constant(rng.choice((0.5, -1.25, 0.3)))
    kind = rng.choice(("sum", "difference", "product", "negative", "sine", "cosine", "root", "inverse"))
    bounded = {"sum": a * c + x, "difference": x - a * c, "product": sin(a) * x, "negative": -cos(a) * x - b * c}
    if kind in bounded:
        return bounded[kind]
    if kind == "root":
        return sqrt(a * a + x * x + 1)
    return 1 / (b * b + x * x + 2) if kind == "inverse" else -sin(a - x) if kind == "sine" else cos(-b - x)


@pytest.fixture
def random_program() -> Callable[..., Program]:
    """random_program(seed, steps) -> a program f(x[5], y[0], z[2]) -> (A[3, 4], s, v[2])."""

    def make(seed: int, steps: int = 60, name: str = "f") -> Program:
        rng, graph = random.Random(seed), Graph(seed)
        names = [f"x{k}" for k in range(7)]
        pool = [graph.symbol(n) for n in names]
        while len(pool) < steps:
            pool.append(_random_step(rng, graph, pool))
        outputs = [pool[0], -pool[1], graph.constant(-2.5), *pool[-12:]]
        groups = (("A", (3, 4)), ("s", ()), ("v", (2,)))
        return Program(name, (("x", 5), ("y", 0), ("z", 2)), groups, Tape.of(outputs, names))

    return make
