"""simulate: arguments that are wrong, named before any work is done."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nullbody import InputError, StateError, UnknownName, assemble, build, derive, simulate
from tests.mechanisms import four_bar
from tests.robot import HOME, robot, upright


def run(**options: Any) -> Any:
    return simulate(robot(), upright(robot()), **{"t1": 0.05, **options})


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"t1": 0.0}, r"t1 = 0.0 must be finite and after the start t0 = 0"),
        ({"t1": -1}, "after the start"),
        ({"t1": 1.0, "t0": 1.0}, "after the start t0 = 1"),
        ({"t1": np.nan}, "must be finite"),
        ({"t1": np.inf}, "must be finite"),
        ({"t0": np.nan}, "must be finite"),
        ({"t1": "1"}, "t1 must be a number, not '1'"),
        ({"t1": None}, "t1 must be a number, not None"),
        ({"t0": "0"}, "t0 must be a number"),
        ({"rtol": 1e-14}, r"rtol = 1e-14 must be within 1e-13\.\.0\.1"),
        ({"rtol": 0.5}, "must be within"),
        ({"rtol": np.nan}, "must be within"),
        ({"rtol": "fine"}, "rtol must be a number, not 'fine'"),
        ({"atol": 0.0}, "atol must be positive"),
        ({"max_step": -1.0}, "max_step must be positive"),
        ({"max_step": np.nan}, "max_step must be positive"),
        ({"max_step": "long"}, "max_step must be a number"),
        ({"max_steps": 0}, "max_steps must be positive"),
        ({"samples": 1}, "at least 2 samples"),
        ({"samples": []}, "samples must be a number of them or increasing times"),
        ({"samples": True}, "increasing times"),
        ({"samples": 2.5}, "increasing times"),
        ({"samples": "many"}, "increasing times"),
        ({"samples": [0.0, 0.02, 0.02]}, "increasing times"),
        ({"samples": [-0.01, 0.02]}, r"increasing times within 0\.\.0\.05 s"),
        ({"samples": [0.0, 0.06]}, r"increasing times within 0\.\.0\.05 s"),
        ({"samples": [0.0, np.nan]}, "increasing times"),
        ({"u": (1, 2)}, "3 input values are needed"),
        ({"u": (1, 2, np.nan)}, "input F3 must be finite"),
        ({"u": "off"}, "real numbers"),
        ({"u": {"F1": 1, "F2": 2}}, "input values are missing: F3"),
        ({"u": {"F1": 1, "F2": 2, "F3": 3, "G": 4}}, "no input 'G'"),
    ],
)
def test_wrong_argument(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        run(**options)


def test_unknown_option_suggests_a_known_one() -> None:
    with pytest.raises(UnknownName, match="no option of simulate 'maxstep'; did you mean 'max_step'"):
        run(maxstep=0.1)


@pytest.mark.parametrize(
    ("result", "message"),
    [
        ([1, 2], r"u\(t, x\) at t = 0 s: 3 input values are needed \(F1, F2, F3\), not an array of shape \(2,\)"),
        (None, r"u\(t, x\) at t = 0 s: "),
        (1.0, "not an array of shape \\(\\)"),
        (["1", "2", "3"], "real numbers"),
        ({"F1": 1}, "input values are missing: F2, F3"),
    ],
)
def test_wrong_result_of_a_controller(result: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        run(u=lambda t, x: result)


def test_controller_may_answer_by_name() -> None:
    by_name = run(u=lambda t, x: {"F3": 3.0, "F1": 1.0, "F2": 2.0})
    np.testing.assert_array_equal(by_name.q, run(u=lambda t, x: (1, 2, 3)).q)
    np.testing.assert_array_equal(by_name.u[0], [1, 2, 3])


def test_start_must_be_a_state_of_the_model() -> None:
    bar = build(derive(four_bar()))
    for start in (assemble(bar, {"q1": 1.3}), dict(HOME), np.zeros(12), None):
        with pytest.raises(InputError, match="starts from a State of the same model"):
            simulate(robot(), start, 1.0)  # type: ignore[arg-type]


def test_start_of_a_model_with_other_parameters() -> None:
    with pytest.raises(StateError, match=r"is open by 0\.1 m .*of these parameters.*assemble"):
        simulate(robot().replace(l=0.6), upright(robot()), 1.0)
    assert simulate(robot().replace(m=0.6), upright(robot()), 0.05).outcome.ok


@pytest.mark.parametrize(
    "samples", [3, np.int64(3), [0.0, 0.025, 0.05], np.array([0.0, 0.025, 0.05]), (0, 0.025, 0.05)]
)
def test_forms_of_samples(samples: Any) -> None:
    np.testing.assert_allclose(run(samples=samples).t, [0, 0.025, 0.05], atol=1e-16)


def test_summed_up_times_may_exceed_the_end_by_rounding() -> None:
    times = np.cumsum(np.full(10, 0.1))
    assert run(t1=times[-1], samples=[*times[:-1], times[-1] + 1e-16]).t[-1] == times[-1]
    assert len(run(samples=[0.03]).t) == 1


def test_progress_bar_is_silent_unless_wanted(capsys: pytest.CaptureFixture[str]) -> None:
    run()
    assert capsys.readouterr() == ("", "")
    run(progress=True)
    assert capsys.readouterr().out == ""
