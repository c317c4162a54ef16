"""Many robots in lock step: against `simulate` one by one, and what becomes of those that cannot go on."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import nullbody
from nullbody import Model, simulate_batch
from nullbody.errors import InputError, StateError, UnknownName
from nullbody.simulate import Outcome
from nullbody.simulate import batch as batch_module
from tests.model.test_batch import model
from tests.robot import robot

TIMES = np.linspace(0, 0.2, 5)


@cache
def starts(name: str = "three_prs", count: int = 9, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """(q, v), closed at t = 0."""
    made, rng = model(name), np.random.default_rng(seed)
    near = {"s1": 0.6, "s2": 0.6, "s3": 0.6} if name == "three_prs" else {}
    q = np.tile(nullbody.assemble(made, near).q, (count, 1))
    q[:, made.independent_columns] += rng.uniform(-0.02, 0.02, (count, len(made.independent)))
    closed = made.batch.assemble(q)
    assert closed.closed.all()
    return closed.q, 0.2 * rng.normal(size=(count, len(made.independent)))


def _one(made: Model, q: np.ndarray, v: np.ndarray, t1: float, **options: object) -> nullbody.Trajectory:
    return nullbody.simulate(made, made.trusted_state(q.copy(), v.copy()), t1, **options)


@pytest.mark.parametrize(
    ("name", "t1"),
    [
        ("three_prs", 0.2),
        ("four_bar", 0.5),
        ("stewart_platform", 0.2),
        ("rolling_disc", 0.5),
        ("driven", 0.5),
        ("andrews", 0.002),
        ("chaplygin_sleigh", 1.0),
        ("a01_pendulum", 2.0),
    ],
)
def test_robots_move_as_simulate_moves_them(name: str, t1: float) -> None:
    made, (q, v) = model(name), starts(name)
    u = 0.1 * np.random.default_rng(1).normal(size=(len(q), len(made.inputs)))
    found = simulate_batch(made, (q, v), [0.0, 0.4 * t1, t1], u, rtol=1e-10)
    assert found.completed.all()
    for k in (0, 4, 8):
        wanted = _one(made, q[k], v[k], t1, u=u[k], samples=[0.4 * t1, t1])
        np.testing.assert_allclose(found.q[1:, k], wanted.q, rtol=1e-7, atol=1e-7)
        np.testing.assert_allclose(found.v[1:, k], wanted.v, rtol=1e-6, atol=1e-6)
    assert found.residual.max() < 1e-13
    assert np.array_equal(found.ended, np.full(len(q), t1))


@pytest.mark.parametrize("name", ["three_prs", "rolling_disc", "driven"])
def test_fixed_steps_are_of_order_four(name: str) -> None:
    made, (q, v) = model(name), starts(name)
    exact = simulate_batch(made, (q, v), 0.1, rtol=1e-12)

    def error(step: float) -> float:
        found = simulate_batch(made, (q, v), 0.1, step=step)
        assert (found.accepted == round(0.1 / step)).all()
        return float(np.abs(found.q[-1] - exact.q[-1]).max())

    assert math.log2(error(0.01) / error(0.005)) == pytest.approx(4, abs=0.5)


def test_tolerances_are_kept() -> None:
    made, (q, v) = robot(), starts()
    exact = simulate_batch(made, (q, v), 0.2, rtol=1e-12)
    errors, steps = [], []
    for rtol in (1e-6, 1e-8, 1e-10):
        found = simulate_batch(made, (q, v), 0.2, rtol=rtol)
        errors.append(float(np.abs(found.q[-1] - exact.q[-1]).max()))
        steps.append(found.statistics.steps)
        assert found.energy_drift.max() < 1e3 * rtol
    assert errors[0] < 1e-4
    assert errors[2] < 1e-8
    assert errors[0] > errors[1] > errors[2]
    assert steps[0] < steps[1] < steps[2]


@pytest.mark.parametrize("count", [0, 1, 7, 8, 9, 1000])
@pytest.mark.parametrize("step", [None, 0.01])
def test_any_number_of_robots(count: int, step: float | None) -> None:
    made, (q, v) = robot(), starts()
    many = simulate_batch(made, (np.resize(q, (count, 12)), np.resize(v, (count, 3))), [0, 0.02, 0.05], step=step)
    few = simulate_batch(made, (q, v), [0, 0.02, 0.05], step=step, threads=1)
    assert many.q.shape == (3, count, 12)
    assert np.array_equal(many.q, few.q[:, np.arange(count) % 9])
    assert len(many.outcome) == count
    assert many.to_xarray().sizes["robot"] == count
    assert str(count) in repr(many)


@pytest.mark.parametrize("step", [None, 0.01])
def test_threads_change_no_bit(step: float | None) -> None:
    made, (q, v) = robot(), starts(count=300)
    found = [simulate_batch(made, (q, v), TIMES, step=step, threads=n) for n in (1, 2, 3)]
    for other in found[1:]:
        assert np.array_equal(found[0].q, other.q)
        assert np.array_equal(found[0].accepted, other.accepted)
        assert np.array_equal(found[0].energy_drift, other.energy_drift)


def test_projection_keeps_the_loops_closed_over_long_runs() -> None:
    made, (q, v) = model("four_bar"), starts("four_bar")
    times = np.linspace(0, 20, 5)
    kept = simulate_batch(made, (q, v), times, step=0.005)
    free = simulate_batch(made, (q, v), times, step=0.005, projection=False)
    assert (kept.accepted == 4000).all()
    assert kept.residual.max() < 1e-12
    assert free.residual.max() > 1e3 * kept.residual.max()
    assert np.abs(made.batch.residual(kept.q[-1])).max() <= kept.residual.max()
    assert free.completed.all()


def test_inputs_for_all_for_each_for_each_interval_and_as_a_function() -> None:
    made, (q, v) = robot(), starts()
    one = np.array([0.5, -0.2, 1.0])
    each = np.tile(one, (len(q), 1))
    for_all = simulate_batch(made, (q, v), TIMES, one)
    assert np.array_equal(for_all.q, simulate_batch(made, (q, v), TIMES, each).q)
    assert np.array_equal(for_all.q, simulate_batch(made, (q, v), TIMES, np.tile(one, (4, 1, 1))).q)
    assert np.array_equal(for_all.q, simulate_batch(made, (q, v), TIMES, lambda t, q, v: one).q)
    seen: list[float] = []

    def wave(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        seen.append(t)
        return math.cos(9 * t) * each - v

    by_function = simulate_batch(made, (q, v), TIMES, wave)
    assert seen == TIMES[:-1].tolist()
    u = [math.cos(9 * t) * each - by_function.v[i] for i, t in enumerate(TIMES[:-1])]
    assert np.array_equal(simulate_batch(made, (q, v), TIMES, np.array(u)).q, by_function.q)
    seen.clear()
    simulate_batch(made, (q, v), TIMES, wave, hold=0.02)
    np.testing.assert_allclose(seen, np.concatenate([np.linspace(a, a + 0.05, 4)[:-1] for a in TIMES[:-1]]), atol=1e-12)


def test_inputs_stay_within_their_limits() -> None:
    b = nullbody.MechanismBuilder("cart", gravity=(0, 0, -9.81))
    b.box("cart", mass=2.0, size=(0.1, 0.1, 0.1))
    b.prismatic("x", "ground", "cart", axis="x")
    b.actuator("push", "x", limits=(-1, 3))
    cart = nullbody.build(nullbody.derive(b.build()))
    found = simulate_batch(cart, (np.zeros((3, 1)), np.zeros((3, 1))), 1.0, [[10.0], [2.0], [-10.0]])
    np.testing.assert_allclose(found.q[-1, :, 0], [3 / 4, 2 / 4, -1 / 4], rtol=1e-7)


def test_every_robot_has_its_parameters() -> None:
    made, (q, v) = robot(), starts()
    masses = np.linspace(0.5, 3.0, len(q))
    found = simulate_batch(made, (q, v), 0.1, parameters={"M": masses})
    for k in (0, 5, 8):
        heavy = made.replace(M=masses[k])
        np.testing.assert_allclose(found.q[-1, k], _one(heavy, q[k], v[k], 0.1).q[-1], rtol=0, atol=1e-7)
    assert found.parameters.shape == (9, len(made.values))
    assert "parameters" in found.to_xarray()
    lengths = made.batch.assemble(q, parameters={"l": 0.5 + 0.01 * np.arange(9)})
    other = simulate_batch(made, (lengths.q, v), 0.1, parameters={"l": 0.5 + 0.01 * np.arange(9)})
    assert other.completed.all()
    with pytest.raises(
        StateError, match=r"loops are open by up to [\d.]+ m at the start of 8 of 9 robots, the first one is 1"
    ):
        simulate_batch(made, (q, v), 0.1, parameters={"l": 0.5 + 0.01 * np.arange(9)})


def test_states_can_be_a_list() -> None:
    made, (q, v) = robot(), starts()
    states = [made.state(a, b) for a, b in zip(q, v, strict=True)]
    assert np.array_equal(simulate_batch(made, states, 0.05).q, simulate_batch(made, (q, v), 0.05).q)
    assert np.array_equal(simulate_batch(made, (q, v[0]), 0.05).v[0], np.tile(v[0], (9, 1)))
    assert simulate_batch(made, [], 0.05).q.shape == (2, 0, 12)


def test_independent_coordinates_change_where_they_become_poor() -> None:
    """A pendulum in x and y goes through x = 0 and y = 0, where one of them after the other is singular."""
    made = model("a01_pendulum")
    home = nullbody.assemble(made, {})
    q, v = np.tile(home.q, (4, 1)), np.tile(home.v, (4, 1))
    found = simulate_batch(made, (q, v), np.linspace(0, 5, 11), rtol=1e-10)
    assert found.completed.all()
    assert found.statistics.switches > 8
    wanted = nullbody.simulate(made, home, 5.0, samples=np.linspace(0, 5, 11))
    np.testing.assert_allclose(found.q[:, 0], wanted.q, rtol=0, atol=1e-6)
    assert found.energy_drift.max() < 1e-7
    stuck = simulate_batch(made, (q, v), np.linspace(0, 5, 11), switch=False)
    assert stuck.counts() == {Outcome.SINGULAR_INDEPENDENT_SET: 4}
    assert (stuck.ended < 1.0).all()
    fixed = simulate_batch(made, (q, v), np.linspace(0, 5, 11), step=0.002)
    np.testing.assert_allclose(fixed.q[:, 0], wanted.q, rtol=0, atol=1e-3)


def test_robots_with_their_own_parameters_change_coordinates_too() -> None:
    """Robots of different masses fall until other coordinates are needed."""
    made = robot()
    home = nullbody.assemble(made, {"s1": 0.6, "s2": 0.58, "s3": 0.63})
    masses = np.linspace(0.5, 2.0, 9)
    v = np.random.default_rng(2).normal(size=(9, 3)) * 0.2
    found = simulate_batch(made, (np.tile(home.q, (9, 1)), v), 0.4, parameters={"M": masses}, rtol=1e-9)
    assert found.statistics.switches > 0
    assert found.completed.any()
    for k in np.flatnonzero(found.completed)[::3]:
        heavy = made.replace(M=masses[k])
        wanted = _one(heavy, home.q, v[k], 0.4)
        np.testing.assert_allclose(found.q[-1, k], wanted.q[-1], rtol=0, atol=1e-5)


def test_robots_that_meet_a_singularity_end_by_name_and_the_others_go_on() -> None:
    """Robots that fall, legs and platform turning over: most meet a configuration in which A loses rank."""
    made = model("three_prs")
    home = nullbody.assemble(made, {"s1": 0.6, "s2": 0.6, "s3": 0.6})
    count = 40
    q = np.tile(home.q, (count, 1))
    q[:, made.independent_columns] += np.random.default_rng(0).uniform(-0.05, 0.05, (count, 3))
    q = made.batch.assemble(q).q
    found = simulate_batch(made, (q, np.zeros((count, 3))), np.linspace(0, 1.2, 25), rtol=1e-9)
    assert Outcome.CONFIGURATION_SINGULARITY in found.counts()
    assert set(found.counts()) <= {Outcome.CONFIGURATION_SINGULARITY, Outcome.COMPLETED}
    assert found.energy_drift.max() < 1e-4  # nobody went through by luck
    gone = np.isnan(found.q).any(axis=2)
    assert np.array_equal(gone, found.t[:, None] > found.ended[None] + 1e-12)
    assert (found.ended[~found.completed] < 1.2).all()


def test_inputs_that_are_not_finite_end_a_robot() -> None:
    made, (q, v) = robot(), starts()

    def broken(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        u = np.zeros((9, 3))
        u[3, 1] = np.nan if t > 0.07 else 0.0
        return u

    found = simulate_batch(made, (q, v), TIMES, broken)
    assert found.counts() == {Outcome.COMPLETED: 8, Outcome.NOT_FINITE: 1}
    assert found.outcome[3] is Outcome.NOT_FINITE
    assert found.ended[3] == pytest.approx(0.1)
    assert np.isnan(found.q[3:, 3]).all()
    assert np.isfinite(found.q[:3, 3]).all()
    assert np.array_equal(np.delete(found.q, 3, axis=1), np.delete(simulate_batch(made, (q, v), TIMES).q, 3, axis=1))


def test_too_many_steps_and_too_small_ones_are_named() -> None:
    made, (q, v) = robot(), starts()
    assert simulate_batch(made, (q, v), 0.2, max_steps=5).counts() == {Outcome.TOO_MANY_STEPS: 9}
    assert simulate_batch(made, (q, v), 0.2, step=1e-4, max_steps=100).counts() == {Outcome.TOO_MANY_STEPS: 9}
    wild = simulate_batch(made, (q, v), 10.0, step=1.0)  # far too long steps: seen, not passed over
    assert not wild.completed.any() or wild.energy_drift.max() > 1e-3


def test_starts_that_make_no_sense_are_named() -> None:
    made, (q, v) = robot(), starts()
    for states, t, options, error, says in (
        ((q + 0.1 * (np.arange(9)[:, None] == 4), v), 1.0, {}, StateError, "1 of 9 robots, the first one is 4"),
        ((q, v[:, :2]), 1.0, {}, InputError, r"\(states, 3\)"),
        ((q, v[:4]), 1.0, {}, InputError, "coordinates for 9 robots and rates for 4"),
        (q, 1.0, {}, InputError, r"arrays \(q, v\) with a row for each robot, or a list of States"),
        ((q, v), 0.0, {}, InputError, "increasing times"),
        ((q, v), [0, 1, 1], {}, InputError, "increasing times"),
        ((q, v), [0, np.nan], {}, InputError, "increasing times"),
        ((q, v), "later", {}, InputError, "increasing times"),
        ((q, v), "0.01", {}, InputError, "increasing times"),
        ((q, v), True, {}, InputError, "increasing times"),
        ((q, v), np.array([0, 0.01 + 1j]), {}, InputError, "increasing times"),
        ((q, v), 1.0, {"step": 0}, InputError, "step must be positive"),
        ((q, v), 1.0, {"step": "x"}, InputError, "step must be a number"),
        ((q, v), 1.0, {"rtol": 1e-20}, InputError, "rtol = 1e-20 must be within"),
        ((q, v), 1.0, {"atol": -1}, InputError, "atol must be positive"),
        ((q, v), 1.0, {"hold": 0}, InputError, "hold must be positive"),
        ((q, v), 1.0, {"projection": 1}, InputError, "projection must be True or False"),
        ((q, v), 1.0, {"max_steps": 0}, InputError, "max_steps must be a whole number from 1"),
        ((q, v), 1.0, {"threads": 0}, InputError, "threads must be a whole number from 1"),
        ((q, v), 1.0, {"stepp": 1}, UnknownName, "did you mean 'step'"),
        ((q, v), 1.0, {"u": np.zeros((4, 3))}, InputError, "there are 9 robots, but inputs for 4"),
        ((q, v), 1.0, {"u": np.zeros((2, 9, 3))}, InputError, r"\(1 intervals, 9 robots or 1, 3\)"),
        (
            (q, v),
            1.0,
            {"u": lambda t, q, v: np.zeros((9, 2))},
            InputError,
            r"has shape \(9, 2\), not \(9, 3\) or \(3,\)",
        ),
        ((q, v), 1.0, {"u": [np.nan, 0, 0]}, InputError, "must be finite"),
    ):
        with pytest.raises(error, match=says):
            simulate_batch(made, states, t, **options)  # type: ignore[arg-type]


def test_results_that_do_not_fit_into_memory_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batch_module, "_free_memory", lambda: 5000.0)
    with pytest.raises(InputError, match=r"5 results of 9 robots take 5.4e-06 GB.*to='motions.nc'"):
        simulate_batch(robot(), starts(), TIMES)


def test_progress_runs_over_the_time_of_the_robots(monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[float] = []

    @contextmanager
    def bar(title: str, begin: float, end: float, wanted: bool | None) -> Iterator[Callable[[float], None]]:
        assert (title, begin, end, wanted) == ("simulating 300 x three_prs", 0.0, 0.2, True)
        yield shown.append

    monkeypatch.setattr(batch_module, "progress_bar", bar)
    simulate_batch(robot(), starts(count=300), TIMES, progress=True)
    assert shown == sorted(shown)
    assert shown[-1] == 0.2
    assert len(shown) >= 4


@pytest.mark.parametrize("to_file", [False, True])
def test_a_robot_goes_on_alone(to_file: bool, tmp_path: Path) -> None:
    made, (q, v) = robot(), starts()
    masses = {"M": np.linspace(0.5, 3.0, 9)}
    options = {"to": tmp_path / "run.nc"} if to_file else {}
    found = simulate_batch(made, (q, v), TIMES, parameters=masses, rtol=1e-10, **options)
    heavy, state = found.alone(5)
    assert heavy.parameters["M"] == masses["M"][5]
    assert state.t == TIMES[-1]
    on = nullbody.simulate(heavy, state, 0.3)
    np.testing.assert_allclose(on.q[-1], _one(heavy, q[5], v[5], 0.3).q[-1], rtol=0, atol=1e-7)
    assert np.array_equal(found["s1"], found.q[:, :, made.coordinates.index("s1")])
    assert np.array_equal(found["s3'"], found.v[:, :, 2])
    with pytest.raises(UnknownName, match="did you mean 's1'"):
        found["s11"]
    with pytest.raises(InputError, match="there are robots 0 to 8, not 9"):
        found.alone(9)


def test_a_robot_that_has_ended_goes_on_alone() -> None:
    made = robot()
    q, v = (np.tile(a, (3, 1)) for a in (nullbody.assemble(made, {"s1": 0.6, "s2": 0.58, "s3": 0.63}).q, np.zeros(3)))
    found = simulate_batch(made, (q, v), np.linspace(0, 1.5, 31))
    stopped = np.flatnonzero(~found.completed)
    assert len(stopped)
    alone, state = found.alone(int(stopped[0]))
    assert state.t <= found.ended[stopped[0]] < state.t + 0.05
    assert nullbody.simulate(alone, state, state.t + 0.2, throw=False).t[-1] > found.ended[stopped[0]]


def test_results_are_read_only() -> None:
    found = simulate_batch(robot(), starts(), 0.05)
    for array in (found.q, found.v, found.t, found.ended, found.accepted, found.residual, found.energy_drift):
        assert not array.flags.writeable
    with pytest.raises(AttributeError):
        found.t = np.zeros(3)  # type: ignore[misc]


@pytest.mark.parametrize("step", [0.002, None])
def test_a_robot_may_use_all_its_steps_and_no_more(step: float | None) -> None:
    made, (q, v) = robot(), starts(count=1)
    whole = simulate_batch(made, (q, v), 0.02, step=step)
    used = int(whole.accepted[0] + whole.refused[0])
    enough = simulate_batch(made, (q, v), 0.02, step=step, max_steps=used)
    assert enough.completed.all()
    assert np.array_equal(enough.q, whole.q)
    less = simulate_batch(made, (q, v), 0.02, step=step, max_steps=used - 1)
    assert less.counts() == {Outcome.TOO_MANY_STEPS: 1}
    assert less.accepted[0] + less.refused[0] == used - 1
    assert less.ended[0] < 0.02
