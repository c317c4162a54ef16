"""What the sections are computed from: force tables, engines as robots, growth rates, the paper's variants."""

from __future__ import annotations

import numpy as np
import pytest

from nullbody.control import ComputedTorque, paper_reference
from nullbody.report import Check, Section, Verdict
from nullbody.report.case import Case
from nullbody.report.growth import linear_growth
from nullbody.report.plant import plant_motion
from nullbody.report.run import ForceTable
from nullbody.report.tracking import time_to
from nullbody.report.variant import EQUATION_41, GRAVITY, INERTIA, NO_COUPLING, RIGHT, Robot
from nullbody.simulate import simulate
from nullbody.verify import MultiplierEngine


@pytest.fixture(scope="module")
def robot(case: Case) -> Robot:
    return Robot(case)


def engine(case: Case) -> MultiplierEngine:
    return MultiplierEngine(case.model.mechanism, case.model.parameters, case.model.labels)


def test_force_table_is_inverse_dynamics(case: Case) -> None:
    table = ForceTable(case.desired.inputs, case.settings.duration, 32)
    for t in (0.0, 0.123, 0.37, 0.5):
        assert np.abs(table(t) - case.desired.inputs(t)).max() < 1e-13


def test_an_engine_under_our_controller_follows(case: Case) -> None:
    times = np.linspace(0, 0.3, 4)
    torque = ComputedTorque(case.model, paper_reference())
    run = plant_motion(engine(case), case.model, case.states[0], times, torque, 1e-8)
    assert run.times[-1] == times[-1]
    assert case.tracking_error(run.times, run.q).max() < 1e-9


def test_a_motion_that_leaves_the_path_is_timed_and_stopped(case: Case) -> None:
    times, push = np.linspace(0, 0.2, 201), np.array([20.0, -20.0, 0.0])
    run = plant_motion(engine(case), case.model, case.states[0], times, lambda t, x: push, 1e-5)
    crossed = time_to(case, run, 1e-3)
    error = case.tracking_error(run.times, run.q)
    assert crossed is not None and run.times[-1] < 0.15
    assert error[run.times < crossed].max() <= 1e-3 < error[run.times > crossed].min()


def test_growth_predicts_a_perturbed_simulation(case: Case) -> None:
    """The linearised amplification bounds that of any direction, and a simulation reaches a good part of it."""
    growth, size, start = linear_growth(case), 1e-7, case.states[0]
    factors = []
    for direction in np.eye(3):
        pushed = case.model.trusted_state(start.q.copy(), start.v + size * direction)
        run = simulate(case.model, pushed, 0.4, u=lambda t, x: case.desired.inputs(t), rtol=1e-11, progress=False)
        factors.append(np.linalg.norm(run.q[-1, -3:] - case.desired.state(0.4).q[-3:]) / size)
    predicted = growth.at(0.4)
    assert predicted is not None
    assert max(factors) <= 1.001 * predicted <= 2 * np.linalg.norm(factors)


def test_right_variant_is_the_model(case: Case, robot: Robot) -> None:
    x, F = case.desired.state(0.4), np.array([1.0, -2.0, 3.0])
    expected = case.model.forward_dynamics(x, F)[-3:]
    assert np.abs(robot.accelerations(x, F)[RIGHT] - expected).max() < 1e-11
    assert np.abs(robot.forces(x, expected)[RIGHT] - F).max() < 1e-12


@pytest.mark.parametrize("variant", [EQUATION_41, INERTIA, GRAVITY, NO_COUPLING])
def test_variants_differ_and_agree_with_themselves(case: Case, robot: Robot, variant: str) -> None:
    """Each variant's forward dynamics inverts its own inverse dynamics, which is why the paper saw nothing."""
    x, v_dot = case.desired.state(0.4), np.array([0.3, -0.1, 0.2])
    forces = robot.forces(x, v_dot)
    assert np.abs(robot.accelerations(x, forces[variant])[variant] - v_dot).max() < 1e-12
    assert np.abs(forces[variant] - forces[RIGHT]).max() > 1e-4


def test_equation_41_is_off_by_gammas_independent_rows(case: Case, robot: Robot) -> None:
    """v'' = w + gamma_independent, with gamma = -A^+ A' q' by numpy's own pseudo-inverse."""
    x, F = case.desired.state(0.4), case.desired.inputs(0.4)
    A, gamma = case.model.jacobian(x.q), case.model.null_space(x).gamma
    least = np.linalg.pinv(A) @ A @ gamma
    found = robot.accelerations(x, F)
    assert np.abs(found[EQUATION_41] + least[-3:] - found[RIGHT]).max() < 1e-11


def test_no_section_of_the_small_report_differs(made: list[Section]) -> None:
    """Time limits aside, which depend on the machine, every check that ran agrees."""
    checks = [check for section in made for check in section.checks if check.unit != "s" and "faster" not in check.what]
    assert [check.what for check in checks if check.verdict is Verdict.DIFFERS] == []
    assert sum(check.verdict is Verdict.AGREES for check in checks) >= 12


def test_appendix_turns_red_when_a_fraction_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    from nullbody.report import appendix

    right = appendix.appendix()
    monkeypatch.setattr(appendix, "_PAPER_N", ((-1, 1), (0.5, -1), (1, 0), (0, 2)))
    wrong = appendix.appendix()
    verdicts: list[Check] = [right.checks[0], wrong.checks[0]]
    assert [check.verdict for check in verdicts] == [Verdict.AGREES, Verdict.DIFFERS]
    assert wrong.numbers["appendix.exact"] is False


def test_missing_engine_is_named_and_null(case: Case) -> None:
    from dataclasses import replace

    from nullbody.report.agreement import agreement

    bare = replace(case, engines={}, missing={"mujoco": "not installed", "pinocchio": "not installed"})
    section = agreement(bare)
    assert section.numbers["forward_dynamics.max_rel_error.mujoco"] is None
    assert {check.verdict for check in section.checks} == {Verdict.MISSING}
    assert any("<b>pinocchio was not run:</b>" in getattr(part, "html", "") for part in section.parts)
