"""Native attempts, steps and Newton's method against the same written with NumPy and the interpreter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from nullbody.expr import Expr, Graph, cos, sin
from nullbody.expr.tape import Tape
from nullbody.kernels import (
    Attempt,
    Bounds,
    Closing,
    Evaluation,
    Guard,
    Part,
    Program,
    Steps,
    Tableau,
    compile_programs,
    interpret,
)

EULER_HEUN = Tableau(  # of order 2, with errors that are nothing but differences of stages
    A=((0.0, 0.0), (1.0, 0.0)),
    B=(0.5, 0.5),
    C=(0.0, 1.0),
    E5=(0.25, -0.5, 0.25),
    E3=(0.5, -0.5, 0.0),
    A_more=((0.125, 0.125, 0.25, 0.0),),
    C_more=(0.5,),
)


def program(size: int, timed: bool = True) -> Program:
    """f(y[size], [t], p[2]) -> (spare[1], g[size], y'[size] backwards, s)."""
    graph = Graph()
    names = [*(f"y{k}" for k in range(size)), *(["t"] if timed else []), "a", "b"]
    y = [graph.symbol(f"y{k}") for k in range(size)]
    a, b = graph.symbol("a"), graph.symbol("b")
    t = graph.symbol("t") if timed else graph.constant(0.5)
    rates = [a * sin(y[(k + 1) % size] + t) - b * y[k] * (k % 3) for k in range(size)]
    outputs: list[Expr] = [y[0] * 2, *(value + 1 for value in y), *reversed(rates), y[0] * y[-1] + b]
    groups = (("y", size), *((("t", 1),) if timed else ()), ("p", 2))
    results = (("spare", (1,)), ("g", (size,)), ("f", (size,)), ("s", ()))
    return Program("f", groups, results, Tape.of(outputs, names))


P = np.array([0.7, -0.3])


def evaluation(size: int, timed: bool = True) -> tuple[Program, Evaluation]:
    made = program(size, timed)
    return made, Evaluation(compile_programs([made]).kernels["f"], np.zeros(size), ["y"], {"p": P})


def rate(made: Program, t: float, y: np.ndarray) -> np.ndarray:
    groups = (y, np.array([t]), P) if len(made.inputs) == 3 else (y, P)
    return np.array(interpret(made, *groups)[2][::-1])


def attempt(
    size: int, timed: bool = True, guards: Sequence[Guard] = (), **tolerances: float
) -> tuple[Program, Attempt]:
    made, evaluated = evaluation(size, timed)
    first = evaluated.starts["f"]
    places = np.arange(first + size - 1, first - 1, -1)
    return made, Attempt(EULER_HEUN, evaluated, places, guards, **({"rtol": 1e-3, "atol": 1e-4} | tolerances))


@pytest.mark.parametrize("size", [1, 3, 8, 9, 21])
@pytest.mark.parametrize("timed", [True, False])
def test_attempt_is_the_method(size: int, timed: bool) -> None:
    made, native = attempt(size, timed)
    y, t, h = np.linspace(-1, 2, size), 0.3, 0.05
    native.y[:] = y
    assert native.rate(t) == 0
    assert native(t, h) == 0
    k1 = rate(made, t, y)
    k2 = rate(made, t + h, y + h * k1)
    y1 = y + h * (k1 + k2) / 2
    k3 = rate(made, t + h, y1)
    np.testing.assert_allclose(native.stages[:3], [k1, k2, k3], rtol=1e-14, atol=1e-15)
    np.testing.assert_allclose(native.y1, y1, rtol=1e-14, atol=1e-15)
    scale = 1e-4 + 1e-3 * np.maximum(np.abs(y), np.abs(y1))
    five, three = ((np.array(E) @ [k1, k2, k3]) / scale for E in (EULER_HEUN.E5, EULER_HEUN.E3))
    error = h * (five @ five) / np.sqrt((five @ five + 0.01 * (three @ three)) * size)
    assert native.error == pytest.approx(error, rel=1e-9)
    assert native.more(t, h) == 0
    middle = rate(made, t + h / 2, y + h * (k1 / 8 + k2 / 8 + k3 / 4))
    np.testing.assert_allclose(native.stages[3], middle, rtol=1e-14, atol=1e-15)


def test_no_error_is_zero() -> None:
    _, native = attempt(2, timed=False)
    native.y[:] = 0.0, -0.5
    native.rate(0.0)
    native.stages[0] = 0.0
    assert native(0.0, 0.0) == 0
    assert native.error == 0.0


@pytest.mark.parametrize(
    ("guard", "value"),
    [
        (lambda at: Guard(at["s"], 1, -np.inf, 0.0), 2),
        (lambda at: Guard(at["g"], 3, -np.inf, 3.0), 2),
        (lambda at: Guard(at["g"], 3, -1.0, np.inf), 0),
    ],
)
def test_guards_are_named_by_their_number(guard: Callable[[Any], Guard], value: int) -> None:
    _, evaluated = evaluation(3)
    never, holds = guard(evaluated.starts), Guard(evaluated.starts["spare"], 1, -np.inf, np.inf)
    for guards, expected in (([holds, never], 2), ([never, holds], 1), ([holds, holds], 0), ([], 0)):
        _, native = attempt(3, guards=guards)
        native.y[:] = 2.5 if value else -3.0
        native.y[0] = 0.5
        assert native.rate(0.1) == expected
        assert native(0.1, 1e-3) == expected


def test_bounds_of_guards_are_strict_and_hold_for_no_nan() -> None:
    _, evaluated = evaluation(3)
    at = evaluated.starts["spare"]
    for low, high, expected in ((1.0, 2.0, 1), (0.0, 1.0, 1), (0.9, 1.1, 0)):
        _, native = attempt(3, guards=[Guard(at, 1, low, high)])
        native.y[:] = 0.5
        assert native.rate(0.0) == expected
    _, native = attempt(3, guards=[Guard(evaluated.starts["f"], 3, -np.inf, np.inf)])
    native.y[:] = 0.5
    assert native.rate(np.inf) == 1  # sin(inf)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_refused(bad: float) -> None:
    _, native = attempt(11)
    native.y[7] = bad
    assert native.rate(0.0) == -1
    native.y[7] = 1.0
    native.rate(0.0)
    native.stages[0, 3] = bad
    assert native(0.0, 0.1) == -1


def test_rows_are_single_evaluations() -> None:
    made, evaluated = evaluation(4)
    t, y = np.linspace(0, 1, 5), np.random.default_rng(1).normal(size=(5, 4))
    found = evaluated.rows(t, y, "f")
    assert found.shape == (5, 4)
    for row, time, state in zip(found, t, y, strict=True):
        np.testing.assert_allclose(row[::-1], rate(made, time, state), rtol=1e-14)
    assert evaluated.rows(t[:0], y[:0], "s").shape == (0,)
    assert evaluated.rows(t, y[:, ::-1], "s").shape == (5,)


# -- Newton -------------------------------------------------------------------------------------------------------


def circle(y: np.ndarray, bounds: Bounds) -> tuple[Closing, Evaluation]:
    """r = x^2 + z^2 - p, closed by x alone: d = -r / 2 x; N = (1, -z / x), m = 1 / x^2."""
    graph = Graph()
    x, z, p = (graph.symbol(name) for name in ("x", "z", "p"))
    r = x * x + z * z - p
    groups, names = (("q", 2), ("p", 1)), ["x", "z", "p"]
    made = {
        "gap": Program("gap", groups, (("A", (2,)), ("r", (1,))), Tape.of([x, z, r], names)),
        "step": Program("step", groups, (("m", ()), ("d", (2,))), Tape.of([x, -r / (2 * x), 0 * x], names)),
        "space": Program(
            "space", groups, (("N", (2,)), ("m", ())), Tape.of([graph.constant(1), -z / x, 1 / x / x], names)
        ),
    }
    kernels = compile_programs(list(made.values())).kernels
    parts = {name: Evaluation(kernel, y, ["q"], {"p": np.array([4.0])}) for name, kernel in kernels.items()}
    weights = np.array([1.0, 3.0])
    gap, step, space = Part(parts["gap"], "r"), Part(parts["step"], "d"), Part(parts["space"], "N")
    return Closing(y, gap, step, space, weights, "m", bounds), parts["space"]


def test_newton_closes_and_holds_the_rest() -> None:
    y = np.array([1.5, 1.0])
    closing, _ = circle(y, Bounds(matrix=100.0, measure=10.0, open=1e-12, short=1e-8))
    assert closing(0.0) > 2
    before, after, size = closing.results
    assert before == pytest.approx(0.75)
    assert after < 1e-15
    assert size == pytest.approx(1 + (3 * 1.0 / 1.5) ** 2)
    np.testing.assert_allclose(y, [np.sqrt(3), 1.0], rtol=1e-15)
    assert closing(0.0) == 0
    assert closing.results[:2] == (after, after)


@pytest.mark.parametrize(("x", "matrix", "measure"), [(1.5, 4.0, 10.0), (1.5, 100.0, 0.4), (0.0, 100.0, 10.0)])
def test_newton_is_not_tried_where_it_would_not_be_right(x: float, matrix: float, measure: float) -> None:
    y = np.array([x, 1.0])
    closing, _ = circle(y, Bounds(matrix=matrix, measure=measure, open=1e-12, short=1e-8))
    assert closing(0.0) == 0
    before, after, _ = closing.results
    assert before == after == abs(x * x + 1 - 4)
    assert y.tolist() == [x, 1.0]


def test_gaps_that_are_no_numbers_are_reported_as_such() -> None:
    y = np.array([np.nan, 1.0])
    closing, _ = circle(y, Bounds(matrix=100.0, measure=10.0, open=1e-12, short=1e-8))
    assert closing(0.0) == 0
    assert np.isnan(closing.results[0])


# -- steps --------------------------------------------------------------------------------------------------------


def round_and_round(rtol: float) -> tuple[Attempt, Steps]:
    """x' = -z, z' = x on the circle x^2 + z^2 = 4."""
    graph = Graph()
    x, z = graph.symbol("x"), graph.symbol("z")
    made = Program("turn", (("q", 2),), (("f", (2,)), ("c", ())), Tape.of([-z, x, cos(x)], ["x", "z"]))
    turn = Evaluation(compile_programs([made]).kernels["turn"], np.zeros(2), ["q"], {})
    native = Attempt(EULER_HEUN, turn, np.array([0, 1]), [Guard(turn.starts["f"], 1, -1.9, np.inf)], rtol, 1e-12)
    closing, space = circle(np.zeros(2), Bounds(matrix=1000.0, measure=10.0, open=1e-12, short=1e-8))
    at = space.starts
    return native, Steps(native, closing, (at["m"], at["N"], at["N"] + 1), slice(1, 3))


def test_steps_are_attempts_controls_and_closings() -> None:
    native, steps = round_and_round(1e-4)
    begin, slope = np.array([np.sqrt(3), 1.0]), np.array([-1.0, np.sqrt(3)])
    made = steps(0.0, begin, slope, 10.0, (0.5, 0.04), 100)
    assert 5 < len(made.numbers) < 100  # until z = 1.9 is refused
    t, y, f, wanted = 0.0, begin, slope, 0.5
    for row, raw, closed, f1, stages in zip(made.numbers, made.raw, made.y, made.f, made.stages, strict=True):
        t1, h, following, tries, before, after, size, moved, m, N0, N1 = row
        expected = min(wanted, 0.04)
        native.y[:], native.stages[0] = y, f
        count = 1
        while native(t, expected) == 0 and not native.error < 1:
            expected *= max(0.2, 0.9 * native.error ** (-1 / 8))
            count += 1
        assert (h, t1, tries) == (pytest.approx(expected, rel=1e-12), t + h, count)
        assert following == pytest.approx(h * min(10 if count == 1 else 1, 0.9 * native.error ** (-1 / 8)), rel=1e-9)
        np.testing.assert_allclose(raw, native.y1, rtol=1e-13)
        np.testing.assert_allclose(stages, native.stages[1:3], rtol=1e-13)
        assert before == pytest.approx(abs(raw @ raw - 4), abs=1e-15)
        assert after < 1e-14
        assert closed == pytest.approx([np.sqrt(4 - raw[1] ** 2) if moved else raw[0], raw[1]], rel=1e-14)
        np.testing.assert_allclose(f1, [-closed[1], closed[0]], rtol=1e-15)
        assert (m, N0, N1) == pytest.approx((1 / raw[0] ** 2, 1, -raw[1] / raw[0]))
        assert size == pytest.approx(1 + 9 * N1 * N1)
        t, y, f, wanted = t1, closed, f1, following
    assert y[1] < 1.9 < y[1] + 0.05 * 2


def test_steps_end_at_the_end_and_after_what_remains_open() -> None:
    _, steps = round_and_round(1e-4)
    begin, slope = np.array([2.0, 0.0]), np.array([0.0, 2.0])
    made = steps(0.0, begin, slope, 0.1, (0.04, 1.0), 40)
    assert made.numbers[-1][0] == 0.1
    assert steps(0.1, begin, slope, 0.1, (0.04, 1.0), 40).numbers == []
    assert len(steps(0.0, begin, slope, 0.1, (0.01, 0.01), 3).numbers) == 3
    native, closing_never = round_and_round(1e-4)
    far = closing_never(0.0, np.array([0.2, 1.0]), np.array([-1.0, 0.2]), 1.0, (0.01, 0.01), 40)
    assert len(far.numbers) == 1  # m = 1 / x^2 is too large for Newton there
    assert far.numbers[0][5] > 1e-3
    assert native.y.tolist() == [0.2, 1.0]


@pytest.mark.parametrize("t", [0.0, 1e-300, 1.0, -1.0, 1e9, -1e9])
def test_no_step_is_shorter_than_ten_spacings(t: float) -> None:
    _, steps = round_and_round(1e-4)
    made = steps(t, np.array([2.0, 0.0]), np.array([0.0, 2.0]), np.inf, (0.0, 1.0), 1)
    assert made.numbers[0][1] == pytest.approx(10 * (np.nextafter(t, np.inf) - t), rel=0.1)
