"""Motions that meet configuration singularities: passed on the same way at every tolerance, or ended by name."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import nullbody
from nullbody.simulate import Outcome
from nullbody.verify.sample import admissible_states


def test_slider_crank_that_touches_its_limit() -> None:
    # e = l - r: at theta = -90 degrees the coupler stands on the rail's normal, and A loses rank
    model = nullbody.build(nullbody.derive(nullbody.catalog.slider_crank(r=0.1, l=0.35, e=0.25)))
    start = nullbody.assemble(model, {"theta": 1.0}, v=[2.0])
    runs = [nullbody.simulate(model, start, 3.0, rtol=rtol) for rtol in (1e-9, 1e-10, 1e-12)]
    assert [run.statistics.crossings for run in runs] == [3, 3, 3]
    for run in runs:
        np.testing.assert_allclose(run.q[-1], runs[-1].q[-1], atol=2e-5)
        assert run.statistics.energy_drift < 1e-6
    stiff = nullbody.simulate(model, start, 3.0, rtol=3e-7, method="stiff")
    np.testing.assert_allclose(stiff.q[-1], runs[-1].q[-1], atol=1e-3)


def test_three_prs_in_free_fall_goes_one_way() -> None:
    model = nullbody.build(nullbody.derive(nullbody.catalog.three_prs()))
    start = admissible_states(model, 4, seed=3)[3]
    ends = []
    for rtol in (1e-9, 1e-10, 1e-11):
        run = nullbody.simulate(model, start, 0.6, rtol=rtol, throw=False)
        assert run.outcome in (Outcome.COMPLETED, Outcome.CONFIGURATION_SINGULARITY)
        if run.outcome is Outcome.COMPLETED:
            ends.append(run.q[-1])
    assert len(ends) >= 2
    for end in ends:
        np.testing.assert_allclose(end, ends[0], atol=1e-4)


@pytest.mark.parametrize("v", [(0.1, 0.05, -0.1), (0.2, -0.1, 0.0)])
def test_no_simulation_creeps_to_a_configuration_singularity(v: tuple[float, ...]) -> None:
    model = nullbody.build(nullbody.derive(nullbody.catalog.three_prs(), ("s1", "s2", "s3")))
    start = nullbody.assemble(model, {"s1": 0.6, "s2": 0.6, "s3": 0.6}, v=v)
    run = nullbody.simulate(model, start, 1.2, throw=False, max_steps=4000)
    assert run.outcome in (Outcome.COMPLETED, Outcome.CONFIGURATION_SINGULARITY)
    assert run.statistics.energy_drift < 1e-3


def four_bar_with(lengths: tuple[float, float, float, float], driver: str | None = None) -> nullbody.Model:
    base, *bars = lengths
    b = nullbody.MechanismBuilder("bars", gravity=(0, -9.81, 0))
    for name, length in zip(("a", "b", "c"), bars, strict=True):
        b.rod(name, 1.0, length)
    b.revolute("A", "ground", "a")
    b.revolute("B", "a", "b", at=(bars[0], 0, 0))
    b.revolute("C", "ground", "c", at=(base, 0, 0))
    b.revolute("D", "b", "c", at=(bars[1], 0, 0), on=(bars[2], 0, 0))
    b.home(A=1.0, B=-0.5, C=1.5)
    if driver is not None:
        b.driver("d", "C", driver)
    return nullbody.build(nullbody.derive(b.build()))


@pytest.mark.parametrize("motion", ["1.7 + 2*t", "1.3 + tan(t)"])
def test_a_driver_beyond_reach_ends_by_name(motion: str) -> None:
    model = four_bar_with((0.8, 0.4, 1.0, 0.9), motion)
    run = nullbody.simulate(model, nullbody.assemble(model, {}), 3.0, throw=False, max_steps=5000)
    assert run.outcome is Outcome.CONFIGURATION_SINGULARITY
    assert 0.3 < run.t[-1] < 0.9


def test_bars_that_cannot_move_end_by_name() -> None:
    model = four_bar_with((1.1, 0.2, 0.5, 0.4))  # 0.2 + 0.5 + 0.4 = 1.1: closed in one point only
    start = nullbody.assemble(model, {}, guess={"A": 0.01, "B": 0.0, "C": 3.14})
    run = nullbody.simulate(model, start, 1.0, throw=False)
    assert run.outcome is Outcome.CONFIGURATION_SINGULARITY
    assert run.t[-1] == 0


@pytest.mark.parametrize("distance", [1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_rest_beside_a_flat_pose_is_right_or_ends_by_name(distance: float) -> None:
    model = nullbody.build(nullbody.derive(nullbody.catalog.n_four_bar(3)))
    angle = np.pi / 2 - distance
    q = {name: angle if name.startswith("theta") else -angle for name in model.coordinates}
    start = nullbody.consistent(model, q, dict.fromkeys(q, 0.0)).state
    run = nullbody.simulate(model, start, 5.0, throw=False, max_steps=2000)
    assert run.outcome in (Outcome.COMPLETED, Outcome.CONFIGURATION_SINGULARITY)
    assert run.outcome is Outcome.COMPLETED or distance < 1e-2  # nearer, rounding decides
    assert run.t[-1] > 1
    k = 9.81 * (4 / 2 + 3) / (4 / 3 + 3)  # four bars of 1 kg that turn, three couplers of 1 kg that do not
    exact = solve_ivp(lambda t, y: [y[1], k * np.sin(y[0])], (0, run.t[-1]), [angle, 0], rtol=1e-12, atol=1e-13)
    assert run["theta0"][-1] == pytest.approx(exact.y[0, -1], abs=1e-6)
