"""The steps of DOP853 against SciPy's, its order, and the native road against the one by a function."""

from __future__ import annotations

import gc
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import DOP853

import nullbody
from nullbody.model import Model, State
from nullbody.simulate import Outcome
from nullbody.simulate.dop853 import INTERPOLATION, TABLEAU
from nullbody.simulate.motion import Motion
from nullbody.simulate.stepper import ByRate, Stepper
from tests.mechanisms import four_bar
from tests.robot import fitted, reference

TOLERANCES = (1e-9, 1e-11)


def test_coefficients_are_scipys_to_the_bit() -> None:
    ours = (TABLEAU.A, TABLEAU.B, TABLEAU.C, TABLEAU.E5, TABLEAU.E3, TABLEAU.A_more, TABLEAU.C_more, INTERPOLATION)
    theirs = (DOP853.A, DOP853.B, DOP853.C, DOP853.E5, DOP853.E3, DOP853.A_EXTRA, DOP853.C_EXTRA, DOP853.D)
    for our, their in zip(ours, theirs, strict=True):
        np.testing.assert_array_equal(our, their)


def test_a_simulation_loads_no_scipy() -> None:
    code = """import sys, nullbody
model = nullbody.build(nullbody.derive(nullbody.catalog.four_bar()))
nullbody.simulate(model, nullbody.assemble(model, {}), 0.1)
assert not [name for name in sys.modules if name.startswith("scipy")]"""
    subprocess.run([sys.executable, "-c", code], check=True)


def pendulum(t: float, y: np.ndarray) -> np.ndarray:
    return np.array([y[1], -9.81 * np.sin(y[0]) + 0.3 * np.cos(3 * t)])


def stepper(rate: Callable, y: Any, t1: float, tolerances: tuple[float, float] = TOLERANCES, **options: Any) -> Stepper:
    start = np.array(y, dtype=float)
    road = ByRate(rate, len(start), tolerances)
    return Stepper(lambda: road, 0.0, start, t1, tolerances, **options)


def lorenz(t: float, y: np.ndarray) -> np.ndarray:
    return np.array([10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 / 3 * y[2]])


@pytest.mark.parametrize(
    ("rate", "start", "t1", "options"),
    [
        (pendulum, [1.0, 0.0], 8.0, {}),
        (pendulum, [0.0, 0.0], 3.0, {"max_step": 0.05}),
        (pendulum, [3.1, 0.0], 4.0, {"first_step": 3.0}),  # far too long: attempts are rejected
        (lorenz, [1.0, 1.0, 1.0], 2.0, {}),
        (lambda t, y: 0 * y, [1.0, 2.0], 5.0, {}),  # no error at all
    ],
)
@pytest.mark.parametrize("tolerances", [(1e-6, 1e-8), (1e-9, 1e-11), (1e-12, 1e-14)])
def test_every_step_is_scipys(rate: Any, start: list[float], t1: float, options: Any, tolerances: Any) -> None:
    rtol, atol = tolerances
    other = DOP853(rate, 0.0, np.array(start), t1, rtol=rtol, atol=atol, **options)
    begun = other.nfev
    ours = stepper(rate, start, t1, tolerances, **options)
    while other.status == "running":
        other.step()
        ours.step()
        assert ours.status == other.status
        assert ours.nfev == other.nfev - begun
        assert ours.t == pytest.approx(other.t, rel=1e-5)  # errors are differences of stages: rounding shows in h
        assert ours.step_size == pytest.approx(other.step_size, rel=1e-4)
        inside = np.linspace(other.t_old, min(other.t, ours.t), 5)
        np.testing.assert_allclose(
            ours.dense_output()(inside), other.dense_output()(inside), rtol=1e-4 * rtol**0.5, atol=10 * rtol
        )
        begun += 3  # dense output


@pytest.mark.parametrize("rtol", [1e-3, 1e-10])
def test_a_single_step_is_scipys_to_rounding(rtol: float) -> None:
    start = np.array([1.0, 0.5, -2.0])
    other = DOP853(lorenz, 0.0, start, 1.0, rtol=rtol, atol=rtol, first_step=1e-3)
    ours = stepper(lorenz, start, 1.0, (rtol, rtol), first_step=1e-3)
    other.step()
    ours.step()
    assert ours.t == other.t
    np.testing.assert_allclose(ours.y, other.y, rtol=1e-14)
    np.testing.assert_allclose(ours.f, other.f, rtol=1e-13)
    t = np.linspace(-2e-4, 1.2e-3, 15)
    np.testing.assert_allclose(ours.dense_output()(t), other.dense_output()(t), rtol=1e-13)
    np.testing.assert_allclose([ours.dense_output()(time) for time in t], other.dense_output()(t).T, rtol=1e-13)


def one_step(h: float) -> Stepper:
    made = stepper(lambda t, y: np.array([y[1], -y[0]]), [1.0, 0.0], 10.0, (1.0, 1.0), first_step=h)
    made.step()
    return made


def test_order_of_the_method_and_of_its_dense_output() -> None:
    lengths = np.array([1.2, 0.6])
    ends, insides = [], []
    for h in lengths:
        made = one_step(float(h))
        x = np.linspace(0.1, 0.9, 9) * h
        exact = np.array([np.cos(x), -np.sin(x)])
        insides.append(np.abs(made.dense_output()(x) - exact).max())
        ends.append(np.abs(made.y - [np.cos(h), -np.sin(h)]).max())
    orders = [np.log2(errors[0] / errors[1]) for errors in (ends, insides)]
    assert orders[0] > 8.5  # local error: order 8 of the method and one more
    assert 7.5 < orders[1] < 9.5


def test_a_rate_that_refuses_shortens_steps_until_it_is_named() -> None:
    wall = stepper(lambda t, y: np.array([1.0]) if y[0] < 0.5 else np.array([np.nan]), [0.0], 1.0)
    while wall.status == "running":
        message = wall.step()
    assert wall.status == "failed"
    assert "less than spacing" in str(message)
    assert wall.y[0] == pytest.approx(0.5, abs=1e-12)
    assert wall.y[0] < 0.5


# -- native steps -------------------------------------------------------------------------------------------------


@cache
def models() -> dict[str, tuple[Model, State]]:
    """Models and where they start; one has a driver, one rolls, one is the paper's."""
    catalog = nullbody.catalog
    found = {}
    bar = nullbody.build(nullbody.derive(four_bar()))
    found["four_bar"] = bar, nullbody.assemble(bar, {"q1": 1.3}, v=[4.0])
    motion = reference("free_motion")["scenarios"]["S1_hanging_swing_zero_force"]
    robot = fitted(motion["params"])
    found["three_prs"] = robot, robot.state(motion["q"][0], motion["qd"][0][9:])
    disc = nullbody.build(nullbody.derive(catalog.rolling_disc()))
    start = nullbody.assemble(disc, {})
    found["rolling_disc"] = disc, disc.state(start.q, 0.5 * np.ones(len(disc.independent)))
    b = nullbody.MechanismBuilder("shaken", gravity=(0, -9.81, 0))  # a pendulum on a driven slide
    b.body("slide", 0.5)
    b.rod("bob", 1.0, 0.8)
    b.prismatic("x", "ground", "slide", axis="x")
    b.revolute("phi", "slide", "bob", axis="z")
    b.driver("shaker", "x", "0.1*sin(5*t)")
    b.actuator("torque", "phi")
    driven = nullbody.build(nullbody.derive(b.build()))
    found["driven"] = driven, nullbody.assemble(driven, {"phi": 0.4})
    return found


def motion_of(name: str, u: Any = None, *, fixed: bool = False) -> tuple[Motion, np.ndarray]:
    model, start = models()[name]
    motion = Motion(model, model, model.input_vector(u), np.ones(len(model.coordinates)), TOLERANCES, fixed=fixed)
    return motion, motion.start(0.0, start.q, model.velocity(start), 0.0)


def by_rate(motion: Motion) -> Callable[[], ByRate]:
    road = ByRate(motion.rate, motion.nq + motion.nv + 1, TOLERANCES)
    return lambda: road


@pytest.mark.parametrize("name", ["four_bar", "three_prs", "rolling_disc", "driven"])
def test_native_steps_are_those_by_rate(name: str) -> None:
    motion, y = motion_of(name)
    native = Stepper(motion.attempts(), 0.0, y, 0.3, TOLERANCES)
    plain = Stepper(by_rate(motion), 0.0, y, 0.3, TOLERANCES)
    while plain.status == "running":
        plain.step()
        native.step()
        assert native.status == plain.status
        assert native.nfev == plain.nfev
        assert native.t == pytest.approx(plain.t, rel=1e-4)  # errors are differences of stages: rounding shows in h
        assert native.landing is not None
        landing = motion.native.landing(native.t, native.y)
        assert landing[1:] == native.landing[1:]
        np.testing.assert_array_equal(landing.y, native.landing.y)
        inside = np.linspace(native.t - 0.5 * native.step_size, native.t, 4)
        native_y, plain_y = native.dense_output()(inside), plain.dense_output()(inside)
        np.testing.assert_allclose(native_y, plain_y, rtol=1e-8, atol=1e-8)
        for stepped in (native, plain):
            stepped.move(landing.y if stepped is native else motion.native.landing(plain.t, plain.y).y)
        np.testing.assert_allclose(native.f, motion.rate(native.t, native.y), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ["four_bar", "three_prs", "rolling_disc", "driven"])
def test_rates_are_those_of_the_forward_dynamics(name: str) -> None:
    model, _ = models()[name]
    u = np.linspace(0.5, -0.2, len(model.inputs))
    motion, y = motion_of(name, u)
    for t in (0.0, 0.3):
        q, v = y[: motion.nq], y[motion.nq : -1]
        q_ddot, q_dot, *_, power = model.evaluate("forward_dynamics", q, v, u, t=t)
        expected = np.concatenate([q_dot, q_ddot[model.independent_columns], [power]])
        np.testing.assert_array_equal(motion.rate(t, y), expected)
        np.testing.assert_array_equal(motion.q_dot(t, y), model.evaluate("kinematics", q, v, t=t)[2])
    y[0] = np.nan
    assert np.isnan(motion.rate(0.0, y)).all()
    assert motion.refused is None


def test_a_fixed_chart_keeps_its_side() -> None:
    model, start = models()["four_bar"]
    motion, y = motion_of("four_bar", fixed=True)
    assert np.isfinite(motion.rate(0.0, y)).all()
    other = nullbody.assemble(model, {"q1": 1.3}, guess={"q2": 1.5, "q3": -1.0})  # the other branch: |B| has turned
    sides = [np.sign(model.evaluate("kinematics", q, start.v)[3]) for q in (start.q, other.q)]
    assert sides[0] == -sides[1] != 0
    assert np.isnan(motion.rate(0.0, np.concatenate([other.q, start.v, [0.0]]))).all()
    assert motion.refused is Outcome.SINGULAR_INDEPENDENT_SET
    motion.start(0.0, other.q, model.velocity(other), 0.0)
    assert np.isfinite(motion.rate(0.0, np.concatenate([other.q, start.v, [0.0]]))).all()


def test_steps_in_advance_are_dropped_where_somebody_goes_on_from_elsewhere() -> None:
    motion, y = motion_of("four_bar")
    moved, fresh = (Stepper(motion.attempts(), 0.0, y, 1.0, TOLERANCES) for _ in range(2))
    for _ in range(3):
        moved.step()
        moved.move(moved.landing.y)  # type: ignore[union-attr]
    elsewhere = moved.y + 0.0
    elsewhere[3:] *= 0.5
    moved.move(elsewhere)
    moved.step()
    motion_rate = motion.rate(fresh.t, y)
    np.testing.assert_array_equal(fresh.f, motion_rate)
    again = Stepper(motion.attempts(), moved.t - moved.step_size, elsewhere, 1.0, TOLERANCES)  # type: ignore[operator]
    inside = np.array([moved.t - 0.5 * min(moved.step_size, 1e-3)])  # type: ignore[type-var]
    while again.t < inside[0]:
        again.step()
    np.testing.assert_allclose(moved.dense_output()(inside), again.dense_output()(inside), rtol=1e-8, atol=1e-9)


def test_dense_output_costs_nothing_until_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    model, start = models()["three_prs"]
    asked = []
    more = nullbody.kernels.Attempt.more
    monkeypatch.setattr(nullbody.kernels.Attempt, "more", lambda self, t, h: asked.append(t) or more(self, t, h))
    found = nullbody.simulate(model, start, 1.0)
    assert not asked
    found.sample([0.5, 0.5001, 0.9])
    assert 1 < len(asked) < 4
    found.sample([0.5, 0.9])
    assert len(asked) < 4


@pytest.mark.parametrize("name", ["four_bar", "three_prs", "driven"])
def test_constant_inputs_are_those_of_a_function(name: str) -> None:
    model, start = models()[name]
    u = 0.3 * np.ones(len(model.inputs))
    native = nullbody.simulate(model, start, 0.5, u=u, samples=21, rtol=1e-11)
    called = nullbody.simulate(model, start, 0.5, u=lambda t, x: u, samples=21, rtol=1e-11)
    np.testing.assert_allclose(native.q, called.q, atol=1e-9)
    np.testing.assert_allclose(native.work, called.work, atol=1e-9)
    np.testing.assert_array_equal(native.u, called.u)
    assert abs(native.statistics.steps - called.statistics.steps) <= 1


def test_constant_inputs_are_held_within_their_limits() -> None:
    b = nullbody.MechanismBuilder("crank", gravity=(0, -9.81, 0))
    b.rod("a", 1.0, 0.5)
    b.revolute("A", "ground", "a")
    b.actuator("torque", "A", limits=(-0.5, 0.2))
    model = nullbody.build(nullbody.derive(b.build()))
    start = nullbody.assemble(model, {"A": 0.3})
    found = nullbody.simulate(model, start, 1.0, u=[7.0])
    assert (found.u == 0.2).all()
    np.testing.assert_allclose(found.work, 0.2 * (found["A"] - 0.3), atol=1e-9)


def test_guards_end_a_simulation_by_name() -> None:
    model = nullbody.build(nullbody.derive(nullbody.catalog.slider_crank(), ("s",)))
    home = model.mechanism.home_values(model.parameters)
    start = nullbody.assemble(model, {"s": home["s"]}, v=[1.0])
    found = nullbody.simulate(model, start, 3.0, throw=False, switch=False)
    called = nullbody.simulate(model, start, 3.0, u=lambda t, x: [0.0] * len(model.inputs), throw=False, switch=False)
    assert found.outcome is called.outcome is Outcome.SINGULAR_INDEPENDENT_SET
    assert found.t[-1] == pytest.approx(called.t[-1], abs=1e-8)


def test_memory_does_not_grow_from_run_to_run() -> None:
    model, start = models()["three_prs"]

    def used() -> int:
        for _ in range(3):
            nullbody.simulate(model, start, 0.3)
        gc.collect()
        return tracemalloc.get_traced_memory()[0]

    nullbody.simulate(model, start, 0.3)
    tracemalloc.start()
    try:
        first = used()
        assert used() - first < 20_000  # one run leaves 60 kB while its trajectory lives
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("switch", [True, False])
def test_a_motion_goes_on_where_the_basis_of_the_kernels_is_singular(switch: bool) -> None:
    """Links that point straight up are singular for y, psi, theta, not for the slides."""
    basis, plain = (
        nullbody.build(nullbody.catalog.three_prs(), basis=names)
        for names in (("y", "psi", "theta"), ("s1", "s2", "s3"))
    )
    for alpha, v in ((np.pi / 2, (0.3, 0.3, 0.2)), (1.4, (0.5, 0.5, 0.5)), (1.4, (0.4, 0.5, 0.6))):
        start = nullbody.assemble(plain, {f"alpha{i}": alpha for i in (1, 2, 3)}, v=v)
        found, expected = (nullbody.simulate(model, start, 0.3, switch=switch) for model in (basis, plain))
        assert found.outcome.ok
        assert expected.outcome.ok
        np.testing.assert_allclose(found.q[-1], expected.q[-1], atol=1e-8)


def test_dense_output_is_finite_where_its_further_stages_are_refused() -> None:
    refused = False
    made = stepper(lambda t, y: np.full(2, np.nan) if refused else pendulum(t, y), [1.0, 0.5], 1.0, first_step=1e-3)
    made.step()
    refused = True
    y = made.dense_output()
    np.testing.assert_allclose(y(made.t), made.y, rtol=1e-15)
    middle = stepper(pendulum, [1.0, 0.5], made.t / 2, first_step=made.t / 2)
    middle.step()
    np.testing.assert_allclose(y(middle.t), middle.y, rtol=1e-12)  # a cubic is off by h^4 / 384 y''''


def test_a_start_where_the_rate_is_refused_fails_at_once() -> None:
    made = stepper(lambda t, y: np.full(2, np.nan), [1.0, 0.5], 1.0)
    assert made.step()
    assert made.status == "failed"
