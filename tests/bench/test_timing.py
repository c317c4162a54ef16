"""Timings count what they say, and the compiled loops go over all states."""

from __future__ import annotations

import time

import numpy as np

from nullbody.bench.matrix import three_prs_generic, three_prs_trigonometric
from nullbody.bench.own import WAYS, derived, eliminated, kernels
from nullbody.bench.timing import Timing, block_seconds, native_seconds, seconds_per_call
from nullbody.expr import Graph, Tape
from nullbody.kernels import Program, compile_programs
from nullbody.nullspace import null_space


def test_median_and_spread() -> None:
    assert Timing.of([1.0, 2.0, 3.0, 4.0, 5.0]) == Timing(3.0, 2 / 3, 1.0)
    assert Timing.of([2.0]) == Timing(2.0, 0.0)


def test_seconds_per_call_divides_by_the_calls() -> None:
    found = seconds_per_call(lambda: time.sleep(0.01), calls=5, repeats=3)
    assert 0.002 <= found.median < 0.01


def test_slow_functions_are_timed_once() -> None:
    calls: list[int] = []
    seconds_per_call(lambda: (calls.append(1), time.sleep(0.02)), repeats=9, limit=0.01)
    assert len(calls) == 1


def test_native_loops_take_more_time_for_more_work() -> None:
    graph = Graph()
    x = graph.symbol("x")
    long = x
    for _ in range(400):
        long = 1 / (long + x)
    programs = [
        Program(name, (("x", 1),), (("y", ()),), Tape.of([y], ["x"])) for name, y in (("short", x + 1), ("long", long))
    ]
    library = compile_programs(programs)
    rows = np.ones((64, 1))
    for measure in (native_seconds, block_seconds):
        short, slow = (measure(library.kernels[name], rows, 3, 2e-3).median for name in ("short", "long"))
        assert slow > 10 * short > 0


def test_kernels_and_eliminated_code_agree() -> None:
    robot, generic = three_prs_trigonometric(), three_prs_generic()
    values = robot.sample(np.random.default_rng(0), 5)
    stack = robot.numbers(values)
    made = kernels(
        {
            "state": (robot, null_space(robot.rows, robot.independent).basis),
            "matrix": (generic, null_space(generic.rows, generic.independent).basis),
            "gauss": eliminated(robot, stack[0]),
        }
    )
    expected = made["state"].batch(values)[0]
    assert np.abs(stack @ expected).max() < 1e-14
    assert np.abs(made["matrix"].batch(generic.values(stack))[0] - expected).max() < 1e-12
    assert np.abs(made["gauss"].batch(stack.reshape(5, -1))[0] - expected).max() < 1e-12


def test_derived_counts_its_own_graph() -> None:
    found = derived(three_prs_generic, WAYS["N"], repeats=2, patience=1.0)
    again = derived(three_prs_generic, WAYS["N, searched"], repeats=1, patience=0.0, search=3)
    assert len(found.basis) == 12 and found.time.median > 0
    assert again.operations.arithmetic < found.operations.arithmetic
