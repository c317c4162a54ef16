"""How simulations end: named, with everything that was reached."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from nullbody import SimulationError, SingularityError, Trajectory, assemble, build, derive, simulate
from nullbody.control import ComputedTorque, Quintic
from nullbody.simulate import Outcome
from tests.mechanisms import slider_crank
from tests.robot import HOME, robot, upright

FALLS = [(0.1, 0.1, 0.1), (1.0, 1.0, 1.0), (-1.0, -1.0, -1.0), (0.5, -0.3, 0.1)]


def falling(v: tuple[float, ...], **options: Any) -> Trajectory:
    return simulate(robot(), assemble(robot(), HOME, v=v), 1.0, throw=False, switch=False, **options)


def determinants(found: Trajectory) -> np.ndarray:
    return np.array([found.model.evaluate("kinematics", q, v)[3] for q, v in zip(found.q, found.v, strict=True)])


@pytest.mark.parametrize("rtol", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
@pytest.mark.parametrize("v", FALLS)
def test_free_fall_never_steps_across_the_forward_singularity(v: tuple[float, ...], rtol: float) -> None:
    found = falling(v, rtol=rtol)
    assert found.outcome is Outcome.SINGULAR_INDEPENDENT_SET
    assert 0.2 < found.t[-1] < 0.7
    assert (determinants(found) > 0).all()
    assert determinants(found)[-1] < 1e-2 * determinants(found)[0]
    assert found.statistics.residual <= 1e-13


def test_every_tolerance_stops_at_the_same_time() -> None:
    ends = [falling((0.5, -0.3, 0.1), rtol=rtol).t[-1] for rtol in (1e-4, 1e-8, 1e-12)]
    assert np.ptp(ends) < 1e-3


def test_error_holds_the_trajectory() -> None:
    model = robot()
    with pytest.raises(SimulationError, match=r"become singular.*v = rates of s1, s2, s3") as caught:
        simulate(model, assemble(model, HOME, v=(0.1, 0.1, 0.1)), 1.0, switch=False)
    found = caught.value.trajectory
    assert isinstance(found, Trajectory)
    assert f"ended at t = {found.t[-1]:.6g} s of 1 s" in str(caught.value)
    assert len(found) > 10
    assert not found.outcome.ok
    assert np.isfinite(found.kinetic).all()


def test_dense_output_up_to_the_end() -> None:
    found = falling((0.1, 0.1, 0.1))
    dense = found.sample(np.linspace(0, found.t[-1], 101))
    assert np.isfinite(dense.q).all()
    assert max(np.abs(found.model.residual(q.copy())).max() for q in dense.q) <= 1e-13


def test_samples_end_where_the_motion_did() -> None:
    found = falling((0.1, 0.1, 0.1), samples=np.linspace(0, 1, 11))
    np.testing.assert_allclose(found.t, np.arange(len(found)) / 10, atol=1e-15)
    assert 0.3 <= found.t[-1] < 0.6
    assert len(falling((0.1, 0.1, 0.1), samples=7)) == 7


def test_upright_rest_is_an_equilibrium() -> None:
    found = simulate(robot(), upright(robot()), 0.2)
    assert found.outcome is Outcome.COMPLETED
    assert np.abs(found.q - found.q[0]).max() < 1e-12


def test_start_at_the_singularity() -> None:
    model = robot()
    q = np.zeros(12)
    q[9:] = 0.1
    with pytest.raises(SimulationError, match=r"ended at t = 0 s of 1 s: .*become singular"):
        simulate(model, model.state(q, (0.1, 0.1, 0.1)), 1.0)


def test_dead_centre_of_another_mechanism() -> None:
    model = build(derive(slider_crank(), ("s",)))
    found = simulate(model, assemble(model, {"s": 0.35}, v=[1.0]), 2.0, throw=False, switch=False)
    assert found.outcome is Outcome.SINGULAR_INDEPENDENT_SET
    assert found["s"][-1] == pytest.approx(0.45, abs=1e-5)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_input_that_is_not_finite_later(bad: float) -> None:
    found = simulate(robot(), upright(robot()), 0.1, u=lambda t, x: [bad if t > 0.05 else 0.0, 0, 0], throw=False)
    assert found.outcome is Outcome.NOT_FINITE
    assert found.t[-1] == pytest.approx(0.05, abs=1e-9)
    assert np.isfinite(found.u).all()


def test_input_that_is_not_finite_at_once() -> None:
    with pytest.raises(
        SimulationError, match=r"ended at t = 0 s of 1 s: an input .* is not finite. Check u\(t, x\)"
    ) as caught:
        simulate(robot(), upright(robot()), 1.0, u=lambda t, x: [np.nan, 0, 0])
    found = caught.value.trajectory
    assert found.t.tolist() == [0.0]
    np.testing.assert_array_equal(found.sample([0.0]).q, [upright(robot()).q])
    assert simulate(
        robot(), upright(robot()), 1.0, u=lambda t, x: [np.nan, 0, 0], samples=5, throw=False
    ).t.tolist() == [0.0]


@pytest.mark.parametrize(
    "u",
    [lambda t, x: 1e8 * x.v**3 + [1, 2, 3], lambda t, x: np.exp(np.minimum(1e4 * np.abs(x.v), 800.0)) * [1, -1, 0]],
    ids=["cubic", "exponential"],
)
def test_exploding_controller(u: Callable[..., Any]) -> None:
    with np.errstate(over="ignore"):
        found = simulate(robot(), upright(robot()), 1.0, u=u, throw=False, max_steps=3000)
    assert found.outcome is not Outcome.COMPLETED
    assert np.isfinite(found.q).all()
    assert found.statistics.residual <= 1e-13


def test_discontinuous_controller_is_followed() -> None:
    found = simulate(robot(), upright(robot()), 0.02, u=lambda t, x: [0.1 if t % 0.01 < 0.005 else -0.1] * 3, rtol=1e-8)
    assert found.outcome.ok
    assert found.statistics.energy_drift < 1e-8


def test_limit_on_steps() -> None:
    model, start = robot(), assemble(robot(), HOME, v=(0.1, 0.1, 0.1))
    with pytest.raises(
        SimulationError, match=r"the limit on steps was reached.*raise max_steps.*\(3 steps\)"
    ) as caught:
        simulate(model, start, 0.2, max_steps=3)
    assert caught.value.trajectory.outcome is Outcome.TOO_MANY_STEPS
    assert caught.value.trajectory.statistics.steps == 3
    needed = simulate(model, start, 0.2).statistics.steps
    assert simulate(model, start, 0.2, max_steps=needed).outcome.ok


def test_controller_s_own_error_passes_through() -> None:
    def broken(t: float, x: Any) -> Any:
        raise KeyError("gain table")

    with pytest.raises(KeyError, match="gain table"):
        simulate(robot(), upright(robot()), 0.1, u=broken)


def test_controller_that_inverts_the_model_into_a_singularity() -> None:
    model = robot()
    down = ComputedTorque(model, Quintic((0.5,) * 3, (-0.1,) * 3, 1.0))
    found = simulate(model, assemble(model, dict.fromkeys(HOME, 0.5)), 1.0, u=down, throw=False, switch=False)
    assert found.outcome is Outcome.SINGULAR_INDEPENDENT_SET
    assert 0.1 - 1e-6 < found["s1"][-1] < 0.12


def test_controller_that_meets_its_own_singularity() -> None:
    def picky(t: float, x: Any) -> Any:
        if x["y"] < 0.45:
            raise SingularityError("no inverse here")
        return [0, 0, 0]

    found = simulate(robot(), assemble(robot(), HOME, v=(0.1, 0.1, 0.1)), 1.0, u=picky, throw=False, switch=False)
    assert found.outcome is Outcome.SINGULAR_INDEPENDENT_SET
    assert found["y"][-1] == pytest.approx(0.45, abs=1e-9)


def test_every_outcome_says_what_it_means() -> None:
    assert [outcome for outcome in Outcome if outcome.ok] == [Outcome.COMPLETED, Outcome.EVENT]
    assert all(len(outcome.value) > 20 for outcome in Outcome)


def test_free_fall_goes_through_in_other_coordinates() -> None:
    model = robot()
    found = simulate(model, assemble(model, HOME, v=(0.1, 0.1, 0.1)), 0.6, rtol=1e-10)
    assert found.statistics.switches >= 1
    assert found.statistics.energy_drift < 1e-5
    assert found.statistics.residual <= 1e-13
    assert (
        np.diff(np.sign([model.evaluate("kinematics", q, v)[3] for q, v in zip(found.q, found.v, strict=True)])) != 0
    ).any()


def test_dead_centre_is_passed() -> None:
    model = build(derive(slider_crank(), ("s",)))
    start = assemble(model, {"s": 0.35}, v=[1.0])
    found = simulate(model, start, 2.0)
    crank = build(derive(slider_crank(), ("alpha",)))
    other = simulate(crank, crank.state(start.q, [model.velocity(start)[1]]), 2.0, samples=found.t)
    assert found.statistics.switches >= 1
    np.testing.assert_allclose(found.q, other.q, atol=1e-7)


@pytest.mark.parametrize("method", ["explicit", "stiff"])
@pytest.mark.parametrize("good", [0, 1, 5, 50])
def test_controller_that_is_singular_from_some_call_on(method: str, good: int) -> None:
    calls = iter(range(10**6))

    def u(t: float, x: object) -> list[float]:
        if next(calls) >= good:
            raise SingularityError("the controller's model")
        return [0.0, 0.0, 0.0]

    found = simulate(robot(), upright(robot()), 1.0, u=u, rtol=1e-6, method=method, throw=False)
    assert found.outcome is Outcome.SINGULAR_INDEPENDENT_SET
    assert np.isfinite(found.q).all()


@pytest.mark.parametrize("good", [1, 5])
def test_stiff_motion_whose_input_is_finite_at_the_start_only(good: int) -> None:
    calls = iter(range(10**6))
    found = simulate(
        robot(),
        upright(robot()),
        1.0,
        u=lambda t, x: [0.0 if next(calls) < good else np.nan, 0.0, 0.0],
        method="stiff",
        throw=False,
    )
    assert found.outcome is Outcome.NOT_FINITE
    assert found.t[-1] == 0.0


@pytest.mark.parametrize("u", [1e150, 1e200, 1e300, -1e308])
@pytest.mark.parametrize("method", ["explicit", "stiff"])
def test_forces_beyond_measure_end_by_name(u: float, method: str) -> None:
    model = robot()
    start = assemble(model, {"s1": 0.5, "s2": 0.5, "s3": 0.5})
    found = simulate(model, start, 0.1, u=[u, 0, 0], throw=False, method=method)
    assert not found.outcome.ok


@pytest.mark.parametrize("rate", [1e100, 1e160, 1e200])
def test_rates_beyond_measure_end_by_name(rate: float) -> None:
    model = robot()
    q = assemble(model, {"s1": 0.5, "s2": 0.5, "s3": 0.5}).q
    assert not simulate(model, model.state(q, [rate, 0, 0]), 0.1, throw=False).outcome.ok
