"""The benchmark with little to measure: short chains, few states, two cheap tools."""

from __future__ import annotations

import pytest

from nullbody.bench import Benchmark, Settings, bench_null_space

SMALL = Settings(
    limit=20.0,
    repeats=2,
    patience=0.01,
    states=4,
    accuracy_states=20,
    chains=(1, 2),
    search=2,
    peers=("symengine_lu", "casadi_solve"),
    growing=("symengine_lu",),
    scattered=("symengine_lu",),
)


@pytest.fixture(scope="session")
def found() -> Benchmark:
    return bench_null_space(SMALL)
