"""The harness with a clock of its own: turns, rounds, medians, ratios turn by turn."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import pytest

from nullbody.bench.speed.interleave import Turns, calls_of, interleaved
from nullbody.bench.timing import Timing, Work, native_function


class Clock:
    """A clock that only works move; it slows all of them down while it is disturbed."""

    def __init__(self) -> None:
        self.now, self.slow = 0.0, 1.0
        self.ran: list[str] = []

    def __call__(self) -> float:
        return self.now

    def work(self, name: str, seconds: float, calls: int = 1, first: float = 0.0) -> Work:
        state = {"first": first}

        def run(rounds: int) -> None:
            self.ran.append(name)
            self.now += self.slow * rounds * seconds + state["first"]
            state["first"] = 0.0

        return Work(run, calls)


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_works_are_done_in_turns(clock: Clock) -> None:
    works = {name: clock.work(name, 2.0) for name in "abc"}
    interleaved(works, repeats=4, seconds=1.0, patience=100.0, clock=clock)
    assert clock.ran == ["a", "b", "c"] * 5  # once to find the rounds


def test_work_of_several_threads_is_timed_by_the_wall(clock: Clock) -> None:
    wall = iter(range(0, 10_000, 7))
    works = {"alone": clock.work("alone", 2.0), "many": clock.work("many", 2.0)._replace(threads=True)}
    turns = interleaved(works, 3, 1.0, patience=1e9, clock=clock, wall=lambda: float(next(wall)))
    assert (turns.timing("alone").median, turns.timing("many").median) == (2.0, 7.0)


def test_time_is_for_one_call_whatever_the_rounds(clock: Clock) -> None:
    works = {"fast": clock.work("fast", 3e-6, calls=3), "slow": clock.work("slow", 5.0)}
    turns = interleaved(works, repeats=5, seconds=0.1, patience=100.0, clock=clock)
    assert turns.timing("fast").median == pytest.approx(1e-6) and turns.timing("slow").median == pytest.approx(5.0)
    assert turns.ratio("slow", "fast") == pytest.approx(5e6)


def test_rounds_fill_the_length_of_a_measurement(clock: Clock) -> None:
    begin = clock.now
    interleaved({"a": clock.work("a", 1e-5)}, repeats=1, seconds=0.1, clock=clock)
    assert 0.1 < clock.now - begin < 0.1 * (1 + 8 / 7)  # the search for the rounds costs about a turn at most


def test_what_is_loaded_on_first_use_does_not_count(clock: Clock) -> None:
    turns = interleaved({"a": clock.work("a", 1e-3, first=0.05)}, repeats=3, seconds=0.1, clock=clock)
    assert turns.seconds["a"] == pytest.approx([1e-3] * 3)


def test_slow_works_have_fewer_turns(clock: Clock) -> None:
    works = {"slow": clock.work("slow", 4.0), "fast": clock.work("fast", 0.01)}
    turns = interleaved(works, repeats=9, seconds=0.1, patience=5.0, clock=clock)
    assert (len(turns.seconds["slow"]), len(turns.seconds["fast"])) == (3, 9)
    assert len(interleaved(works, repeats=9, seconds=0.1, patience=1.0, least=1, clock=clock).seconds["slow"]) == 1


def test_a_disturbance_that_slows_all_leaves_the_ratio(clock: Clock) -> None:
    """From the third turn on everything takes 5 times longer: medians suffer, the ratio does not."""
    works = {"ours": clock.work("ours", 1.0), "peer": clock.work("peer", 7.0)}
    original = works["peer"].run

    def peer(rounds: int) -> None:
        original(rounds)
        clock.slow = 5.0 if clock.ran.count("peer") > 2 else 1.0

    turns = interleaved({"ours": works["ours"], "peer": Work(peer)}, 9, 0.5, patience=1e9, clock=clock)
    assert turns.timing("ours").median == pytest.approx(5.0)
    assert turns.ratio("peer", "ours") == pytest.approx(7.0)


def test_median_and_spread_of_turns() -> None:
    turns = Turns({"a": [1.0, 2.0, 3.0, 4.0, 100.0], "b": [2.0, 4.0]})
    assert turns.timing("a") == Timing(3.0, 2 / 3, 1.0)
    assert turns.ratio("b", "a") == 2.0


def test_calls_go_over_all_functions() -> None:
    found: list[int] = []
    functions: list[Callable[[], object]] = [lambda k=k: found.append(k) for k in range(3)]
    work = calls_of(functions)
    work.run(2)
    assert (found, work.calls) == ([0, 1, 2, 0, 1, 2], 3)


def test_a_native_function_is_called_as_often_as_asked() -> None:
    seen: list[tuple[int, int]] = []
    callback = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(lambda a, b: seen.append((a, b)))
    run = native_function(ctypes.cast(callback, ctypes.c_void_p).value or 0, 4096, 8192, callback)
    run(5)
    assert seen == [(4096, 8192)] * 5
