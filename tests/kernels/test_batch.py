from __future__ import annotations

import math
import threading
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nullbody.errors import InputError
from nullbody.expr import Graph, cos, sin, sqrt
from nullbody.expr.tape import Tape
from nullbody.kernels import BLOCK, Kernel, Program, block, compile_programs, interpret
from nullbody.kernels import compile as compile_module
from nullbody.kernels.number import Number
from nullbody.kernels.threads import shared_out
from nullbody.kernels.trigonometry import RANGE

EMPTY = np.zeros(0)


def _states(seed: int, states: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.uniform(-2, 2, (states, 5)), EMPTY, rng.uniform(-2, 2, (states, 2))


def _one_by_one(kernel: Kernel, *groups: np.ndarray) -> list[np.ndarray]:
    """What the scalar kernel gives, state after state."""
    states = max(len(group) for group in groups if group.ndim == 2)
    rows = [kernel(*(group[k] if group.ndim == 2 else group for group in groups)) for k in range(states)]
    return [np.array([row[k] for row in rows]) for k in range(len(rows[0]))]


@pytest.mark.parametrize("seed", range(6))
def test_a_batch_has_the_bits_of_single_calls(seed: int, random_program: Callable[..., Program]) -> None:
    program = random_program(seed, 3000 if seed == 0 else 150)
    kernel = compile_programs([program], wide=seed % 2 == 0).kernels["f"]
    groups = _states(seed, 37)
    results = kernel.batch(*groups)
    for wide, single, reference in zip(results, _one_by_one(kernel, *groups), interpret(program, *groups), strict=True):
        assert np.array_equal(wide, single)
        np.testing.assert_allclose(wide, reference, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("lanes", [2, 4, 8])
def test_every_width_gives_the_same(
    lanes: int, random_program: Callable[..., Program], monkeypatch: pytest.MonkeyPatch
) -> None:
    program, groups = random_program(7, 200), _states(7, 19)
    expected = compile_programs([program]).kernels["f"].batch(*groups)
    monkeypatch.setattr(compile_module, "_vector", lambda bits: Number(lanes, bits))
    kernel = compile_programs([program]).kernels["f"]
    assert all(np.array_equal(a, b) for a, b in zip(kernel.batch(*groups), expected, strict=True))
    single = kernel.batch(*groups, dtype=np.float32)
    np.testing.assert_allclose(single[0], expected[0], rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("states", [0, 1, 7, 8, 9, 16, 1000])
def test_any_number_of_states_will_do(
    states: int, random_program: Callable[..., Program], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(block, "_GRAIN", 3)
    program, groups = random_program(1), _states(1, states)
    results = compile_programs([program]).kernels["f"].batch(*groups)
    assert [r.shape for r in results] == [(states, 3, 4), (states,), (states, 2)]
    for wide, reference in zip(results, interpret(program, *groups), strict=True):
        np.testing.assert_allclose(wide, reference, rtol=1e-12, atol=1e-14)


def test_groups_are_shared_or_have_a_row_for_every_state(random_program: Callable[..., Program]) -> None:
    kernel = compile_programs([random_program(2)]).kernels["f"]
    x, _, z = _states(2, 21)
    shared = kernel.batch(x, EMPTY, z[0])
    repeated = kernel.batch(np.asfortranarray(x), np.zeros((21, 0)), np.broadcast_to(z[0], z.shape))
    assert all(np.array_equal(a, b) for a, b in zip(shared, repeated, strict=True))
    assert all(np.array_equal(a, b[::-1]) for a, b in zip(kernel.batch(x[::-1], [], z[0]), shared, strict=True))
    whole = kernel.batch([[1, 2, 3, 4, 5]], [], [1, 2])
    assert np.array_equal(whole[0][0], kernel(np.arange(1.0, 6.0), EMPTY, np.array([1.0, 2.0]))[0])


def test_results_are_new_arrays(random_program: Callable[..., Program]) -> None:
    kernel = compile_programs([random_program(3)]).kernels["f"]
    first = kernel.batch(*_states(3, 10))
    kept = [r.copy() for r in first]
    kernel.batch(*_states(4, 10))
    assert all(np.array_equal(r, k) for r, k in zip(first, kept, strict=True))


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads_change_no_bit(
    threads: int, random_program: Callable[..., Program], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(block, "_GRAIN", 2)
    kernel, groups = compile_programs([random_program(3)]).kernels["f"], _states(3, 501)
    expected = kernel.batch(*groups, threads=1)
    assert all(np.array_equal(a, b) for a, b in zip(kernel.batch(*groups, threads=threads), expected, strict=True))


def test_results_go_where_they_are_wanted(random_program: Callable[..., Program]) -> None:
    kernel, groups = compile_programs([random_program(3)]).kernels["f"], _states(3, 21)
    expected = kernel.batch(*groups)
    room = [np.full((23, *r.shape[1:]), 7.0) for r in expected]
    out = [r[1:22] for r in room]
    given = kernel.batch(*groups, out=out)
    for result, place, whole, wanted in zip(given, out, room, expected, strict=True):
        assert result is place
        assert np.array_equal(result, wanted)
        assert (whole[[0, 22]] == 7.0).all()


def test_a_batch_into_given_arrays_allocates_nothing_for_its_states(random_program: Callable[..., Program]) -> None:
    kernel, groups = compile_programs([random_program(3)]).kernels["f"], _states(3, 20_000)
    out = kernel.batch(*groups)
    tracemalloc.start()
    kernel.batch(*groups, out=out)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 20_000


def test_wrong_places_for_results_are_named(random_program: Callable[..., Program]) -> None:
    kernel, groups = compile_programs([random_program(3)]).kernels["f"], _states(3, 5)
    good = list(kernel.batch(*groups))
    frozen = good[2].copy()
    frozen.flags.writeable = False
    for wrong, says in (
        (good[:2], "out has 2 arrays, not 3"),
        ([good[0], good[1], good[2].astype(np.float32)], r"out for 'v' must be a float64 array \(5, 2\)"),
        ([good[0][:4], *good[1:]], r"out for 'A' must be a float64 array \(5, 3, 4\)"),
        ([good[0], good[1], np.zeros((10, 2))[::2]], "out for 'v' must be contiguous"),
        ([good[0], good[1], frozen], "contiguous and writeable"),
        ([good[0], good[1], groups[2]], "out for 'v' shares memory"),
    ):
        with pytest.raises(InputError, match=says):
            kernel.batch(*groups, out=wrong)
    for threads in (0, -1, 1.5, True, "2"):
        with pytest.raises(InputError, match="threads must be a whole number from 1"):
            kernel.batch(*groups, threads=threads)


def test_a_mistake_in_a_thread_is_raised_when_all_have_stopped() -> None:
    done: list[int] = []

    def work(begin: int, end: int) -> None:
        if begin == 5:
            raise ValueError("five")
        done.append(begin)

    with pytest.raises(ValueError, match="five"):
        shared_out(work, 1000, 4, 1)
    count = len(done)
    shared_out(done.append, 0, 4, 1)
    assert len(done) == count


def test_parts_of_a_program_are_batches_too(random_program: Callable[..., Program]) -> None:
    kernel, groups = compile_programs([random_program(3)]).kernels["f"], _states(3, 21)
    A, _, v = kernel.batch(*groups)
    blocks = kernel.blocks(np.float64, ("v", "A"))
    assert kernel.blocks(np.float64, ("v", "A")) is blocks
    for result, wanted in zip(blocks(*groups), (v, A), strict=True):
        np.testing.assert_allclose(result, wanted, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize(
    ("groups", "says"),
    [
        ((np.zeros((3, 4)), EMPTY, np.zeros(2)), r"input 'x' has shape \(3, 4\), not \(states, 5\) or \(5,\)"),
        ((np.zeros((2, 3, 5)), EMPTY, np.zeros(2)), "input 'x' has shape"),
        ((1.0, EMPTY, np.zeros(2)), r"input 'x' has shape \(\)"),
        ((np.zeros((3, 5)), EMPTY, np.zeros((4, 2))), "different numbers of states: 'x' 3, 'z' 4"),
        ((np.zeros(5), EMPTY, np.zeros(2)), "their number is unknown"),
        ((np.zeros((3, 5), dtype=complex), EMPTY, np.zeros(2)), "input 'x' holds complex128"),
        ((np.zeros((3, 5)),), "takes 3 input groups, not 1"),
    ],
)
def test_wrong_inputs_are_named(groups: tuple, says: str, random_program: Callable[..., Program]) -> None:
    kernel = compile_programs([random_program(3)]).kernels["f"]
    with pytest.raises(InputError, match=says) as caught:
        kernel.batch(*groups)
    assert "kernel f(x[5], y[0], z[2])" in str(caught.value)
    with pytest.raises(InputError, match="float64 or float32, not int64"):
        kernel.batch(*groups, dtype=np.int64)


def test_blocks_are_evaluated_in_place(random_program: Callable[..., Program]) -> None:
    kernel = compile_programs([random_program(4)]).kernels["f"]
    x, _, z = _states(4, 3 * BLOCK)
    source = np.concatenate([x, z], axis=1).reshape(3, BLOCK, 7).transpose(0, 2, 1).copy()
    target = np.full((3, 15, BLOCK), np.nan)
    kernel.blocks().run(source, target)
    expected = np.concatenate([r.reshape(3 * BLOCK, -1) for r in kernel.batch(x, EMPTY, z)], axis=1)
    assert np.array_equal(target.transpose(0, 2, 1).reshape(3 * BLOCK, 15), expected)
    kernel.blocks().run(source[:0], target[:0])


def test_wrong_blocks_are_refused(random_program: Callable[..., Program]) -> None:
    blocks = compile_programs([random_program(5)]).kernels["f"].blocks()
    source, target = np.zeros((3, 7, 8)), np.zeros((3, 15, 8))
    frozen = target.copy()
    frozen.flags.writeable = False
    for wrong in (np.zeros((2, 15, 8)), np.zeros((3, 8, 15)), target.astype(np.float32), target[:, :, ::-1], frozen):
        with pytest.raises(InputError, match="target is a float"):
            blocks.run(source, wrong)
    with pytest.raises(InputError, match="source is a float64 array"):
        blocks.run(source[:, :6], target)
    with pytest.raises(InputError, match=r"source is a float64 array \(\)"):
        blocks.run(np.array(1.0), target)
    memory = np.zeros(3 * 22 * 8)
    with pytest.raises(InputError, match="share memory"):
        blocks.run(memory[: 3 * 7 * 8].reshape(3, 7, 8), memory[8 : 8 + 3 * 15 * 8].reshape(3, 15, 8))


def test_threads_do_not_mix_their_data(random_program: Callable[..., Program]) -> None:
    kernel = compile_programs([random_program(6, 300)]).kernels["f"]
    wrong: list[int] = []

    def work(number: int) -> None:
        groups = _states(number, 50 + number)
        expected = _one_by_one(kernel, *groups)
        for _ in range(50):
            if not all(np.array_equal(a, b) for a, b in zip(kernel.batch(*groups), expected, strict=True)):
                wrong.append(number)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_special_values_stay_in_their_lane() -> None:
    x = Graph().symbol("x")
    forms = [sin(x), -cos(x), sqrt(x), 1 / x, x * x - x]
    program = Program("f", (("x", 1),), (("r", (5,)),), Tape.of(forms, ["x"]))
    kernel = compile_programs([program]).kernels["f"]
    values = [
        0.0,
        -0.0,
        math.inf,
        -math.inf,
        math.nan,
        RANGE,
        math.nextafter(RANGE, 9e9),
        -1e22,
        5e-324,
        1.0,
        -2.5,
        1e300,
    ]
    rows = np.array([[a] for pair in zip(values, reversed(values), strict=True) for a in (*pair, 0.7)])
    (result,) = kernel.batch(rows)
    (expected,) = _one_by_one(kernel, rows)
    assert np.array_equal(result, expected, equal_nan=True)
    assert np.array_equal(np.signbit(result), np.signbit(expected))


def test_floats_are_rounded_once_in_every_operation() -> None:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    forms = [x * y, x + y, 1 / x, sqrt(x), sin(x), cos(y), x - 0.1]
    program = Program("f", (("x", 1), ("y", 1)), (("r", (7,)),), Tape.of(forms, ["x", "y"]))
    a, b = np.random.default_rng(0).uniform(0, 50, (2, 43, 1)).astype(np.float32)
    (result,) = compile_programs([program]).kernels["f"].batch(a, b, dtype=np.float32)
    exact = interpret(program, a, b)[0][:, :6]
    assert result.dtype == np.float32
    assert np.array_equal(result[:, :6], exact.astype(np.float32))
    assert np.array_equal(result[:, 6:], a - np.float32(0.1))


def test_wide_code_is_only_compiled_where_it_is_asked_for(random_program: Callable[..., Program], cache: Path) -> None:
    compile_programs([random_program(9, name="other")], wide=True).kernels["other"].blocks()  # what all batches share
    shared = len(list(cache.iterdir()))
    programs = [random_program(1), replace(random_program(2), name="g")]
    kernels = compile_programs(programs).kernels
    assert len(list(cache.iterdir())) == shared + 1
    kernels["g"].batch(*_states(0, 3))
    kernels["g"].batch(*_states(0, 3))
    assert len(list(cache.iterdir())) == shared + 2
    together = compile_programs(programs, wide=True)
    assert together.origin == "compiled"
    together.kernels["f"].batch(*_states(0, 3))
    assert len(list(cache.iterdir())) == shared + 3
    assert compile_programs(programs, wide=True).origin == "cache"


def test_empty_programs_work() -> None:
    program = Program("nothing", (("p", 0),), (("r", (0, 3)),), Tape((), (), (), ()))
    assert compile_programs([program]).kernels["nothing"].batch(np.zeros((9, 0)))[0].shape == (9, 0, 3)
