"""Events: each crossing once, several at a time, what `then` may give back, and events without end."""

from dataclasses import replace

import numpy as np
import pytest

import nullbody
from nullbody import Event, Model, State
from nullbody.errors import InputError, StateError
from nullbody.simulate import Outcome


def pendulum() -> Model:
    b = nullbody.MechanismBuilder("pendulum", gravity=(0, -9.81, 0))
    b.rod("bar", 1.0, 1.0)
    b.revolute("th", "ground", "bar")
    return nullbody.build(nullbody.derive(b.build()))


def ball() -> Model:
    b = nullbody.MechanismBuilder("ball", gravity=(0, -9.81, 0))
    b.box("ball", 1.0, (0.1, 0.1, 0.1))
    b.prismatic("y", "ground", "ball", axis="y")
    return nullbody.build(nullbody.derive(b.build()))


@pytest.mark.parametrize("method", ["explicit", "stiff"])
@pytest.mark.parametrize("direction", [-1, 0, 1])
def test_every_crossing_is_found_once(method: str, direction: int) -> None:
    model = pendulum()
    plain = nullbody.simulate(model, model.state([-1.0]), 6.0, samples=60_001)
    values = plain["th"] + 1.3
    crossings = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))
    expected = [plain.t[k] for k in crossings if direction in (0, np.sign(values[k + 1] - values[k]))]
    event = Event("low", lambda t, x: x["th"] + 1.3, direction=direction)
    run = nullbody.simulate(model, model.state([-1.0]), 6.0, events=[event], method=method)
    assert len(expected) >= 3
    np.testing.assert_allclose([one.t for one in run.events], expected, atol=2e-4)


def test_a_fast_turn_hides_no_crossing() -> None:
    b = nullbody.MechanismBuilder("wheel")
    b.rod("bar", 1.0, 1.0)
    b.revolute("th", "ground", "bar")
    model = nullbody.build(nullbody.derive(b.build()))
    event = Event("zero", lambda t, x: np.sin(x["th"]), direction=1)
    run = nullbody.simulate(model, model.state([0.1], [6.0]), 10.0, events=[event], max_step=5.0)
    np.testing.assert_allclose([one.t for one in run.events], (2 * np.pi * np.arange(1, 10) - 0.1) / 6, rtol=1e-9)


def test_events_at_one_moment_happen_all_and_a_terminal_one_ends() -> None:
    model = pendulum()
    events = [Event("a", lambda t, x: t - 1.0), Event("c", lambda t, x: t - 1.0, terminal=True)]
    run = nullbody.simulate(model, model.state([0.3]), 2.0, events=events)
    assert run.outcome is Outcome.EVENT
    assert [(one.name, one.t) for one in run.events] == [("a", 1.0), ("c", 1.0)]
    assert run.t[-1] == 1.0


def test_a_ball_bounces_at_the_times_of_the_closed_form() -> None:
    model = ball()
    hit = Event("hit", lambda t, x: x["y"], direction=-1, then=lambda t, x: model.state(x.q, -0.8 * x.v))
    run = nullbody.simulate(model, model.state([1.0]), 3.0, events=[hit])
    fall = np.sqrt(2 / 9.81)
    expected = fall + np.concatenate([[0], np.cumsum(2 * fall * 0.8 ** np.arange(1, len(run.events)))])
    np.testing.assert_allclose([one.t for one in run.events], expected, rtol=1e-9)
    assert run["y"].min() > -1e-12


def test_bounces_without_end_are_named() -> None:
    model = ball()
    hit = Event("hit", lambda t, x: x["y"], direction=-1, then=lambda t, x: model.state(x.q, -0.5 * x.v))
    run = nullbody.simulate(model, model.state([1.0]), 3.0, events=[hit], throw=False)
    assert run.outcome is Outcome.EVENTS_ACCUMULATE
    assert run.t[-1] == pytest.approx(3 * np.sqrt(2 / 9.81), rel=1e-5)
    assert run["y"].min() > -1e-12


def test_steps_between_events_are_limited_too() -> None:
    model = ball()
    hit = Event("hit", lambda t, x: x["y"], direction=-1, then=lambda t, x: model.state([0.001], [0.0]))
    run = nullbody.simulate(model, model.state([0.001]), 3.0, events=[hit], throw=False, max_steps=50)
    assert run.outcome is Outcome.TOO_MANY_STEPS


def test_then_must_give_a_state_with_closed_loops_at_that_time() -> None:
    b = nullbody.MechanismBuilder("driven", gravity=(0, -9.81, 0))
    b.rod("bar", 1.0, 1.0)
    b.revolute("q", "ground", "bar")
    b.driver("d", "q", "2*t")
    model = nullbody.build(nullbody.derive(b.build()))
    start = nullbody.assemble(model, {})
    back = Event("back", lambda t, x: t - 0.5, then=lambda t, x: start)
    with pytest.raises(StateError, match=r"event 'back': then\(t, x\) at t = 0.5 s: loop 'd' is open by 1 rad"):
        nullbody.simulate(model, start, 1.0, events=[back])


@pytest.mark.parametrize("given", [3.0, None, "x"])
def test_then_must_give_a_state(given: object) -> None:
    model = pendulum()
    wrong = Event("wrong", lambda t, x: t - 0.5, then=lambda t, x: given)  # type: ignore[arg-type, return-value]
    with pytest.raises(InputError, match="must give a State of the model"):
        nullbody.simulate(model, model.state([0.3]), 1.0, events=[wrong])


def test_then_must_give_a_finite_state() -> None:
    model = pendulum()

    def lost(t: float, x: State) -> State:
        return replace(x, v=np.array([np.nan]))

    with pytest.raises(StateError, match="gives a state that is not finite"):
        nullbody.simulate(model, model.state([0.3]), 1.0, events=[Event("lost", lambda t, x: t - 0.5, then=lost)])


@pytest.mark.parametrize("events", [None, Event("a", lambda t, x: t), 3])
def test_events_are_a_list(events: object) -> None:
    model = pendulum()
    with pytest.raises(InputError, match="events must be a list"):
        nullbody.simulate(model, model.state([0.3]), 1.0, events=events)  # type: ignore[arg-type]


def test_why_an_event_has_no_value_is_said() -> None:
    model = pendulum()
    with pytest.raises(InputError, match=r"event 'bad': when.*no finite number: .*angle"):
        nullbody.simulate(model, model.state([0.3]), 1.0, events=[Event("bad", lambda t, x: x["angle"])])


def test_equations_left_out_as_repetitions_are_checked_at_the_start() -> None:
    b = nullbody.MechanismBuilder("planar")
    offset = b.parameter("w", 0.0, "m", sign="any")
    for name, length in (("crank", 0.4), ("coupler", 1.0), ("rocker", 0.9)):
        b.rod(name, 1.0, length)
    b.revolute("A", "ground", "crank")
    b.revolute("B", "crank", "coupler", at=(0.4, 0, 0))
    b.revolute("C", "ground", "rocker", at=(0.8, 0, offset))
    b.revolute("D", "coupler", "rocker", at=(1.0, 0, 0), on=(0.9, 0, 0))
    b.home(A=1.0, B=-0.5, C=1.5)
    model = nullbody.build(nullbody.derive(b.build()))
    state = nullbody.assemble(model, {"A": 1.0})
    shifted = model.replace(w=0.05)
    with pytest.raises(nullbody.NullbodyError, match="can never close"):
        nullbody.simulate(shifted, state, 0.1)
    assert len(nullbody.branches(model, {"A": 1.0})) == 2
    assert not len(nullbody.branches(shifted, {"A": 1.0}))
