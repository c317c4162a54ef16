"""Feed-forward and computed torque: what they send, and how the robot follows."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from nullbody import AssemblyError, InputError, Trajectory, assemble, build, derive, simulate
from nullbody.control import (
    AbstractReference,
    ComputedTorque,
    Demand,
    DesiredMotion,
    FeedForward,
    Quintic,
    Sine,
    desired_motion,
    paper_reference,
)
from tests.mechanisms import four_bar, slider_crank
from tests.robot import HOME, SLIDES, equations, reference, robot


@cache
def desired() -> DesiredMotion:
    return desired_motion(robot(), paper_reference(), 3.0)


def errors(found: Trajectory) -> np.ndarray:
    """Largest error of a slide at every stored time."""
    wanted = np.array([paper_reference()(float(t)).position for t in found.t])
    return np.abs(found.q[:, 9:] - wanted).max(axis=1)


def followed(u: Any, t1: float = 3.0, **options: Any) -> Trajectory:
    return simulate(robot(), desired().state(0.0), t1, u=u, **options)


def test_desired_states_are_on_the_reference_and_closed() -> None:
    for t in np.linspace(0, 3, 101):
        state, demand = desired().state(float(t)), paper_reference()(float(t))
        np.testing.assert_array_equal(state.q[9:], demand.position)
        np.testing.assert_array_equal(state.v, demand.rate)
        assert np.abs(robot().residual(state.q)).max() <= 1e-14


def test_desired_states_are_the_reference_s() -> None:
    motion = reference("inverse_dynamics")
    for k, t in enumerate(motion["t"]):
        np.testing.assert_allclose(desired().state(t).q, motion["q"][k], atol=1e-14)
        np.testing.assert_allclose(robot().velocity(desired().state(t)), motion["qd"][k], atol=1e-14)
        np.testing.assert_allclose(desired().inputs(t), motion["F"][k], atol=1e-13)


def test_feed_forward_is_inverse_dynamics() -> None:
    u, here = FeedForward(desired()), assemble(robot(), HOME)
    for t in (0.0, 0.7, 2.9):
        wanted = robot().inverse_dynamics(desired().state(t), paper_reference()(t).acceleration)
        np.testing.assert_array_equal(u(t, here), wanted)


def test_feedback_is_proportional_to_the_errors() -> None:
    t, kp, kd = 0.7, (10.0, 20.0, 30.0), 4.0
    model, on = robot(), desired().state(0.7)
    s = dict(zip(SLIDES, on.q[9:] + np.array([0.01, -0.02, 0.03]), strict=True))
    off = assemble(model, s, v=on.v + np.arange(1, 4), guess=on)
    sent = FeedForward(desired(), kp, kd)(t, off) - desired().inputs(t)
    np.testing.assert_allclose(sent, [-0.1 - 4, 0.4 - 8, -0.9 - 12], rtol=1e-12)


def test_computed_torque_commands_the_acceleration() -> None:
    model, t = robot(), 0.7
    state = assemble(model, {"s1": 0.62, "s2": 0.5, "s3": 0.55}, v=(0.1, 0.2, 0.3))
    u = ComputedTorque(model, paper_reference(), kp=(1.0, 2.0, 3.0), kd=5.0)(t, state)
    demand = paper_reference()(t)
    command = demand.acceleration + 5.0 * (demand.rate - state.v) + [1, 2, 3] * (demand.position - state.q[9:])
    np.testing.assert_allclose(model.forward_dynamics(state, u)[9:], command, rtol=1e-10)


def test_open_loop_diverges() -> None:
    found = followed(FeedForward(desired()), rtol=1e-10, throw=False)
    lost = errors(found) > 1e-3
    assert lost.any()
    assert 1.5 < found.t[np.argmax(lost)] < 2.2


def test_tighter_tolerance_only_delays_the_divergence() -> None:
    times = []
    for rtol in (1e-6, 1e-10, 1e-13):
        found = followed(FeedForward(desired()), rtol=rtol, throw=False, samples=601)
        times.append(found.t[np.argmax(errors(found) > 1e-3)])
    assert 0.8 < times[0] < times[1] < times[2] < 2.7


def test_feed_forward_with_feedback_holds() -> None:
    found = followed(FeedForward(desired(), kp=50.0, kd=4.0))
    assert found.outcome.ok
    assert errors(found).max() < 1e-12


def test_computed_torque_holds() -> None:
    found = followed(ComputedTorque(robot(), paper_reference()))
    assert found.outcome.ok
    assert errors(found).max() < 1e-12


def test_feedback_without_feed_forward_is_far_worse() -> None:
    def feedback(t: float, x: Any) -> np.ndarray:
        return FeedForward(desired(), kp=50.0, kd=4.0)(t, x) - desired().inputs(t)

    assert 0.05 < errors(followed(feedback, throw=False)).max() < 0.5


def test_wrong_model_in_the_controller_leaves_an_error() -> None:
    heavier = robot().replace(M=1.1)
    found = followed(ComputedTorque(heavier, paper_reference()), t1=1.0)
    assert 1e-4 < errors(found).max() < 0.1


@pytest.mark.parametrize(("kp", "kd"), [(100.0, 20.0), (64.0, 4.0)], ids=["critical", "swinging"])
def test_error_of_computed_torque_obeys_its_equation(kp: float, kd: float) -> None:
    model, e0 = robot(), np.array([0.02, -0.01, 0.015])
    demand = paper_reference()(0.0)
    start = assemble(model, dict(zip(SLIDES, demand.position - e0, strict=True)), v=demand.rate)
    found = simulate(model, start, 1.0, u=ComputedTorque(model, paper_reference(), kp, kd), samples=21)
    error = np.array([paper_reference()(float(t)).position for t in found.t]) - found.q[:, 9:]
    roots = np.roots([1.0, kd, kp])
    if kd**2 == 4 * kp:
        shape = (1 + kd / 2 * found.t) * np.exp(-kd / 2 * found.t)
    else:
        shape = (
            (roots[1] * np.exp(roots[0] * found.t) - roots[0] * np.exp(roots[1] * found.t)) / (roots[1] - roots[0])
        ).real
    np.testing.assert_allclose(error, np.outer(shape, e0), atol=1e-10)


def test_quintic_move_arrives_at_rest() -> None:
    model = robot()
    move = Quintic((0.6, 0.6, 0.6), (0.7, 0.5, 0.55), duration=0.8)
    found = simulate(model, assemble(model, HOME), 1.0, u=ComputedTorque(model, move))
    np.testing.assert_allclose(found.q[-1, 9:], move.end, atol=1e-11)
    np.testing.assert_allclose(found.v[-1], 0, atol=1e-10)


def test_other_mechanism_turns_as_demanded() -> None:
    model = build(derive(four_bar(), ("q1",)))
    spin = Sine((1.3,), (3.0,), omega=2.0)
    u = ComputedTorque(model, spin)
    found = simulate(model, assemble(model, {"q1": 1.3}, v=[6.0]), 1.0, u=u)
    np.testing.assert_allclose(found["q1"], [spin(float(t)).position[0] for t in found.t], atol=1e-9)


@pytest.mark.parametrize("gain", [-1.0, np.nan, np.inf, (1, 2), (1, 2, -3), "stiff", None, [[1, 2, 3]]])
@pytest.mark.parametrize("name", ["kp", "kd"])
def test_wrong_gains(name: str, gain: Any) -> None:
    for make in (lambda **k: FeedForward(desired(), **k), lambda **k: ComputedTorque(robot(), paper_reference(), **k)):
        with pytest.raises(InputError, match=f"{name} must be one gain or 3 of them, finite and not negative"):
            make(**{name: gain})


def test_reference_of_another_length() -> None:
    short = Sine((0.6, 0.6), (0.1, 0.1))
    with pytest.raises(InputError, match="the reference moves 2 coordinates, the model has 3"):
        ComputedTorque(robot(), short)
    with pytest.raises(InputError, match="moves 2 coordinates, the model has 3 independent ones: s1, s2, s3"):
        desired_motion(robot(), short, 1.0)


@pytest.mark.parametrize("times", [{"t1": 0.0}, {"t1": -1.0}, {"t1": np.nan}, {"t1": 1.0, "t0": 2.0}, {"t1": np.inf}])
def test_wrong_times(times: dict[str, float]) -> None:
    with pytest.raises(InputError, match="must be finite and after the start"):
        desired_motion(robot(), paper_reference(), **times)


@pytest.mark.parametrize("t", [-0.5, 3.5, 1e9, np.nan])
def test_desired_motion_ends_where_it_was_prepared(t: float) -> None:
    with pytest.raises(InputError, match=r"prepared for t = 0\.\.3 s, not for"):
        desired().state(t)


def test_reference_out_of_reach_names_the_point() -> None:
    with pytest.raises(AssemblyError, match=r"point .* of 51 of the path"):
        desired_motion(robot(), Sine((0.6, 0.6, 0.6), (2.0, 0.3, 0.2)), 1.0)


class Spike(AbstractReference):
    """Rests at the home, but is far out of reach for a moment between two knots."""

    def __call__(self, t: float) -> Demand:
        away = 2.0 if 0.105 < t < 0.115 else 0.0
        return Demand(np.array([0.6 + away, 0.6, 0.6]), np.zeros(3), np.zeros(3))


def test_moment_out_of_reach_is_no_silent_garbage() -> None:
    motion = desired_motion(robot(), Spike(), 0.5)
    np.testing.assert_allclose(motion.state(0.1).q[9:], 0.6)
    with pytest.raises(AssemblyError, match=r"cannot be closed for s1 = 2\.6"):
        motion.state(0.11)


def test_feedback_needs_the_actuated_coordinates_independent() -> None:
    model = build(derive(slider_crank(), ("alpha",)))
    motion = desired_motion(model, Sine((1.0,), (0.2,)), 0.5)
    with pytest.raises(InputError, match=r"acts on the actuated coordinates s: derive with these .*not alpha"):
        FeedForward(motion)


def test_desired_motion_on_another_branch() -> None:
    below = assemble(robot(), HOME, guess={"y": -0.5} | dict.fromkeys(("alpha1", "alpha2", "alpha3"), -1.5))
    motion = desired_motion(robot(), paper_reference(), 0.5, guess=below)
    assert all(motion.state(t)["y"] < 0 for t in (0.0, 0.25, 0.5))


def test_equations_with_other_independent_coordinates_agree() -> None:
    other = build(derive(equations().mechanism, ("y", "psi", "phi")))
    t = 0.8
    state = desired().state(t)
    v = [robot().velocity(state)[other.coordinates.index(name)] for name in other.independent]
    q_ddot = robot().forward_dynamics(state, (1, 2, 3))
    np.testing.assert_allclose(other.forward_dynamics(other.state(state.q, v), (1, 2, 3)), q_ddot, rtol=1e-9, atol=1e-9)
