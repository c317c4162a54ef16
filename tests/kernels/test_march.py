"""Steps of many states: against steps written with NumPy, SciPy's integrators and exact solutions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from nullbody.errors import InputError
from nullbody.expr import Graph, cos, sin
from nullbody.expr.tape import Tape
from nullbody.kernels import Lanes, March, Program
from nullbody.kernels import compile as compile_module
from nullbody.kernels.number import BLOCK, Number

INPUTS = (("y", 2), ("t", 1), ("k", 1))


def _pendulum(correction: bool = False) -> Program:
    """y = (angle, rate): y1' = -k sin y0 + cos t; guards y0 + 10 (sign), y1 (limit); correction (y0 - y1)/8 of y0."""
    graph = Graph()
    a, b, t, k = (graph.symbol(name) for name in ("a", "b", "t", "k"))
    rate, guards = [b, cos(t) - k * sin(a)], [a + 10, b]
    outputs = {"rate": rate, "guards": guards}
    if correction:
        outputs["correction"] = [(b - a) / 8]
    tape = Tape.of([f for group in outputs.values() for f in group], ["a", "b", "t", "k"])
    shapes = tuple((name, (len(group),)) for name, group in outputs.items())
    return Program("corrected" if correction else "rate", INPUTS, shapes, tape)


def _march(limit: float = 1e3, correction: bool = False, watched: tuple[int, float] | None = None) -> March:
    return March(_pendulum(), _pendulum(correction), [limit], time=2, watched=watched)


def _started(march: March, states: int, seed: int = 0) -> tuple[Lanes, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    y, k = rng.uniform(-1, 1, (states, 2)), rng.uniform(1, 4, (states, 1))
    lanes = march.lanes(states)
    lanes.put(0, y)
    lanes.put(3, k)
    lanes.put_each("step", 0.1)
    return lanes, y, k


def _rate(t: np.ndarray | float, y: np.ndarray, k: np.ndarray) -> np.ndarray:
    return np.stack([y[:, 1], np.cos(t) - k[:, 0] * np.sin(y[:, 0])], axis=1)


def _runge_kutta(y: np.ndarray, k: np.ndarray, h: float, steps: int, fix: Callable = lambda y: 0.0) -> np.ndarray:
    for i in range(steps):
        t = i * h
        k1 = _rate(t, y, k)
        base = y + fix(y)
        k2 = _rate(t + h / 2, base + h / 2 * k1, k)
        k3 = _rate(t + h / 2, base + h / 2 * k2, k)
        k4 = _rate(t + h, base + h * k3, k)
        y = base + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return y


@pytest.mark.parametrize("states", [0, 1, 7, 8, 9, 1000])
@pytest.mark.parametrize("threads", [1, 2])
def test_fixed_steps_are_those_of_the_method(states: int, threads: int) -> None:
    march = _march()
    lanes, y, k = _started(march, states)
    march.fixed(lanes, 1.0, 0.05, 20, threads)
    np.testing.assert_allclose(lanes.rows(0, 2), _runge_kutta(y, k, 0.05, 20), rtol=0, atol=1e-13)
    assert (lanes.each("accepted") == 20).all()
    assert (lanes.each("status") == 0).all()
    np.testing.assert_allclose(lanes.each("time"), np.ones(states), rtol=1e-14)


def test_corrections_enter_at_the_begin_of_a_step() -> None:
    march = _march(correction=True)
    lanes, y, k = _started(march, 9)
    march.fixed(lanes, 0.6, 0.05, 12, 1)

    def fix(y: np.ndarray) -> np.ndarray:
        return np.stack([(y[:, 1] - y[:, 0]) / 8, np.zeros(len(y))], axis=1)

    np.testing.assert_allclose(lanes.rows(0, 2), _runge_kutta(y, k, 0.05, 12, fix), rtol=0, atol=1e-13)


def test_threads_and_parts_change_no_bit() -> None:
    march = _march()
    found = []
    for threads, parts in ((1, [(0, 50)]), (2, [(0, 50)]), (3, [(0, 7), (7, 20), (20, 50)])):
        lanes, _, _ = _started(march, 400)
        for part in parts:
            march.adaptive(lanes, 2.0, (1e-8, 1e-10), 1000, 1e-14, threads, part)
        found.append(lanes)
    for other in found[1:]:
        assert np.array_equal(found[0].inputs, other.inputs)
        assert np.array_equal(found[0].accepted, other.accepted)


def test_the_orders_are_four_and_five() -> None:
    march = _march()
    _, y, k = _started(march, 16)
    exact = (
        solve_ivp(
            lambda t, x: _rate(t, x.reshape(-1, 2), k).ravel(),
            (0, 1),
            y.ravel(),
            method="DOP853",
            rtol=1e-13,
            atol=1e-15,
        )
        .y[:, -1]
        .reshape(-1, 2)
    )

    def error(h: float) -> float:
        lanes, _, _ = _started(march, 16)
        march.fixed(lanes, 1.0, h, round(1 / h), 1)
        return float(np.abs(lanes.rows(0, 2) - exact).max())

    assert np.log2(error(0.05) / error(0.025)) == pytest.approx(4, abs=0.2)

    def one_step(h: float) -> np.ndarray:
        """With these tolerances any step is accepted: what is left is the error of one step of order 5."""
        lanes, _, _ = _started(march, 16)
        lanes.put_each("step", h)
        march.adaptive(lanes, h, (1e3, 1e3), 1, 1e-14, 1)
        fine = _runge_kutta(y, k, h / 64, 64)
        return np.linalg.norm(lanes.rows(0, 2) - fine, axis=1)

    assert np.median(np.log2(one_step(0.1) / one_step(0.05))) == pytest.approx(6, abs=0.3)


def test_every_lane_has_steps_of_its_own() -> None:
    march = _march()
    lanes, y, k = _started(march, 11)
    lanes.put(3, k * np.geomspace(1, 300, 11)[:, None])
    k = lanes.rows(3, 1)
    march.adaptive(lanes, 3.0, (1e-9, 1e-11), 5000, 1e-14, 2)
    for lane in range(11):
        exact = solve_ivp(
            lambda t, x, lane=lane: _rate(t, x[None], k[lane : lane + 1])[0],
            (0, 3),
            y[lane],
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
        ).y[:, -1]
        np.testing.assert_allclose(lanes.rows(0, 2)[lane], exact, rtol=0, atol=2e-6)
    accepted = lanes.each("accepted")
    assert accepted[-1] > 3 * accepted[0]
    assert np.array_equal(lanes.each("time"), np.full(11, 3.0))
    alone, _, _ = _started(march, 1)
    alone.put(0, y[4])
    alone.put(3, k[4])
    march.adaptive(alone, 3.0, (1e-9, 1e-11), 5000, 1e-14, 1)
    assert np.array_equal(alone.rows(0, 2)[0], lanes.rows(0, 2)[4])


def test_the_step_counts_of_the_method_are_those_of_scipy() -> None:
    march = _march()
    lanes, y, k = _started(march, 1, seed=3)
    march.adaptive(lanes, 10.0, (1e-8, 1e-10), 5000, 1e-14, 1)
    peer = solve_ivp(lambda t, x: _rate(t, x[None], k)[0], (0, 10), y[0], method="RK45", rtol=1e-8, atol=1e-10)
    assert lanes.each("accepted")[0] == pytest.approx(len(peer.t) - 1, rel=0.1)
    np.testing.assert_allclose(lanes.rows(0, 2)[0], peer.y[:, -1], rtol=0, atol=1e-6)


def test_attempts_can_be_made_in_portions() -> None:
    march = _march()
    whole, _, _ = _started(march, 20)
    march.adaptive(whole, 2.0, (1e-7, 1e-9), 1000, 1e-14, 1)
    portions, _, _ = _started(march, 20)
    calls = 0
    while (portions.each("time") < 2.0).any():
        march.adaptive(portions, 2.0, (1e-7, 1e-9), 3, 1e-14, 1)
        calls += 1
    assert calls > 3
    np.testing.assert_allclose(portions.rows(0, 2), whole.rows(0, 2), rtol=0, atol=1e-14)


@pytest.mark.parametrize("adaptive", [False, True])
def test_lanes_stop_for_their_own_reasons(adaptive: bool) -> None:
    march = _march(limit=5.0)
    lanes, y, k = _started(march, 10)
    y[2, 1] = 6.0  # beyond its limit at once
    y[5] = -9.95, -1.0  # leaves its side soon
    y[7, 0] = np.nan
    lanes.put(0, y)
    lanes.put_each("side", np.where(np.arange(10) == 6, 0.0, np.inf))
    if adaptive:
        march.adaptive(lanes, 1.0, (1e-8, 1e-10), 2000, 1e-13, 1)
    else:
        march.fixed(lanes, 1.0, 0.01, 100, 1)
    status = lanes.each("status")
    assert status[2] == 2
    assert status[5] == 1
    assert status[7] != 0
    assert lanes.each("time")[2] == 0.0
    assert 0.03 < lanes.each("time")[5] < 0.06
    assert np.array_equal(lanes.rows(0, 2)[2], y[2])
    fine = [j for j in range(10) if j not in (2, 5, 7)]
    assert (status[fine] == 0).all()
    np.testing.assert_allclose(lanes.rows(0, 2)[fine], _runge_kutta(y, k, 0.01, 100)[fine], rtol=0, atol=1e-7)


def _blow_up() -> March:
    """y' = y^2, y = 1 / (1/y0 - t)."""
    a = Graph().symbol("a")
    program = Program("blow_up", (("y", 1),), (("rate", (1,)), ("guards", (1,))), Tape.of([a * a, a], ["a"]))
    return March(program, program, [])


def test_an_overflow_stops_before_it() -> None:
    march = _blow_up()
    lanes = march.lanes(2)
    lanes.put(0, np.array([[1e200], [-1.0]]))
    march.fixed(lanes, 1.0, 0.1, 10, 1)
    assert lanes.each("status").tolist() == [2, 0]
    assert lanes.rows(0, 1)[0] == 1e200
    assert lanes.rows(0, 1)[1] == pytest.approx(-0.5, abs=1e-6)


def test_a_step_that_becomes_too_small_is_named() -> None:
    march = _blow_up()
    lanes = march.lanes(2)
    lanes.put(0, np.array([[1.0], [-1.0]]))
    lanes.put_each("step", 0.1)
    march.adaptive(lanes, 2.0, (1e-8, 1e-10), 5000, 1e-9, 1)
    assert lanes.each("status").tolist() == [3, 0]
    assert lanes.each("time")[0] == pytest.approx(1.0, abs=1e-6)
    assert lanes.rows(0, 1)[1, 0] == pytest.approx(-1 / 3, abs=1e-7)


@pytest.mark.parametrize("adaptive", [False, True])
def test_a_watched_guard_takes_a_lane_out_after_a_step(adaptive: bool) -> None:
    march = _march(limit=5.0, watched=(1, 1.5))
    lanes, y, _ = _started(march, 3)
    y[1] = -2.0, 1.0  # becomes faster than 1.5
    lanes.put(0, y)
    if adaptive:
        march.adaptive(lanes, 1.0, (1e-8, 1e-10), 500, 1e-13, 1)
    else:
        march.fixed(lanes, 1.0, 0.01, 100, 1)
    assert lanes.each("status").tolist() == [0, 5, 0]
    assert 1.5 < lanes.rows(0, 2)[1, 1] < 1.8
    assert 0.0 < lanes.each("time")[1] < 0.9


def test_lanes_that_are_there_wait() -> None:
    march = _march()
    lanes, y, k = _started(march, 4)
    times = np.array([0.0, 0.5, 1.0, 0.25])
    lanes.put_each("time", times)
    march.fixed(lanes, 1.0, 0.05, 1000, 1)
    assert lanes.each("accepted").tolist() == [20, 10, 0, 15]
    assert np.array_equal(lanes.rows(0, 2)[2], y[2])
    np.testing.assert_allclose(lanes.rows(0, 2)[0], _runge_kutta(y[:1], k[:1], 0.05, 20)[0], rtol=0, atol=1e-13)


def test_the_last_lanes_repeat_the_last_state() -> None:
    march = _march()
    lanes, y, _ = _started(march, 9)
    assert lanes.inputs.shape == (2, 4, BLOCK)
    assert (lanes.inputs[1, :2] == y[8][:, None]).all()
    march.fixed(lanes, 1.0, 0.1, 10, 1)
    assert (lanes.inputs[1] == lanes.inputs[1, :, :1]).all()


@pytest.mark.parametrize("lanes", [2, 4])
def test_every_width_of_registers_gives_the_same(lanes: int, monkeypatch: pytest.MonkeyPatch) -> None:
    whole, _, _ = _started(_march(), 11)
    _march().adaptive(whole, 2.0, (1e-8, 1e-10), 1000, 1e-14, 1)
    monkeypatch.setattr(compile_module, "_vector", lambda bits: Number(lanes, bits))
    other, _, _ = _started(_march(), 11)
    _march().adaptive(other, 2.0, (1e-8, 1e-10), 1000, 1e-14, 1)
    assert np.array_equal(whole.inputs, other.inputs)


def test_programs_must_fit() -> None:
    with pytest.raises(InputError, match="a limit for every guard but the first"):
        March(_pendulum(), _pendulum(), [])
    other = Program("f", (("x", 1),), (("r", (1,)),), Tape.of([Graph().symbol("x")], ["x"]))
    with pytest.raises(InputError, match="outputs rate and guards"):
        March(other, other, [])
