"""Independent engines agree with the model, and notice when it is wrong."""

from __future__ import annotations

import json
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from nullbody import InputError, UnknownName, VerificationError, build, derive
from nullbody.verify import AbstractEngine, MujocoEngine, MultiplierEngine, PinocchioEngine, compare
from tests.mechanisms import four_bar, slider_crank, two_bodies

PACKAGES = {"mujoco": "mujoco", "pinocchio": "pin", "multipliers": ""}
CLASSES = {"mujoco": MujocoEngine, "pinocchio": PinocchioEngine, "multipliers": MultiplierEngine}
AGREEMENT = 1e-11  # relative; measured 3e-14


@pytest.fixture(params=sorted(PACKAGES))
def engine(request) -> str:
    """Each engine in turn."""
    if PACKAGES[request.param]:
        package = PACKAGES[request.param]
        pytest.importorskip(request.param, reason=f"{request.param} is not installed: pip install {package}")
    return request.param


@pytest.mark.parametrize("parameters", ["robot", "general"])
def test_engine_agrees_on_the_robot(engine, parameters, request) -> None:
    found = compare(request.getfixturevalue(parameters), engines=(engine,), states=40, tolerance=AGREEMENT).check()
    assert set(found[engine].quantities) == {"forward_dynamics", "inverse_dynamics", "reactions"}
    assert found.ok


@pytest.mark.parametrize("mechanism", [four_bar, slider_crank, two_bodies])
def test_engine_agrees_on_other_mechanisms(engine, mechanism) -> None:
    model = build(derive(mechanism()))
    assert compare(model, engines=(engine,), states=20, tolerance=AGREEMENT).check().ok


@pytest.mark.parametrize("other", [{"l": 0.5 + 1e-6}, {"g": -9.8}, {"ms": 1e-6}, {"Izz": 0.01 + 1e-7}])
def test_engine_notices_other_parameters(engine, other, robot) -> None:
    planted = CLASSES[engine](robot.mechanism, robot.replace(**other).parameters, robot.labels)
    found = compare(robot, engines=(planted,), states=8)
    assert not found.ok
    with pytest.raises(VerificationError, match=f"{engine}.* and nullbody disagree on q'' of 'three_prs'"):
        found.check()


class Planted(AbstractEngine):
    """An engine with one wrong sign."""

    name = "planted"
    version = "0"

    def __init__(self, model, fault: str) -> None:
        self.labels = model.labels
        self.fault = fault
        self.honest = MultiplierEngine(model.mechanism, model.parameters, model.labels)

    def forward_dynamics(self, q, q_dot, u, t=0.0):
        q_ddot, lam = self.honest.forward_dynamics(q, q_dot, u, t)
        return q_ddot, lam * np.where(np.arange(len(lam)) == 4, -1, 1) if self.fault == "reactions" else lam

    def inverse_dynamics(self, q, q_dot, q_ddot, t=0.0):
        u, lam = self.honest.inverse_dynamics(q, q_dot, q_ddot, t)
        return u * [1, -1, 1] if self.fault == "inverse_dynamics" else u, lam

    def generalized_forces(self, q, q_dot, q_ddot, t=0.0):
        forces = self.honest.generalized_forces(q, q_dot, q_ddot, t)
        return forces * np.where(np.arange(len(forces)) == 3, -1, 1) if self.fault == "generalized_forces" else forces


@pytest.mark.parametrize("fault", ["reactions", "inverse_dynamics"])
def test_one_flipped_force_is_named(fault, robot) -> None:
    found = compare(robot, engines=(Planted(robot, fault),), states=4)
    wrong = [name for name, quantity in found["planted"].quantities.items() if quantity.max_rel_error > 1e-10]
    assert wrong == [fault]
    with pytest.raises(VerificationError, match=r"in state \d of 4, seed 0: .* State: x = "):
        found.check()
    assert "<- too large" in str(found)


def test_wrong_gamma_is_noticed(robot, engine, monkeypatch) -> None:
    right = type(robot).forward_dynamics

    def wrong(model, state, u=None):
        return right(model, state, u) - 2 * model.null_space(state).gamma

    monkeypatch.setattr(type(robot), "forward_dynamics", wrong)
    assert not compare(robot, engines=(engine,), states=4).ok


def test_not_a_number_does_not_agree(robot, monkeypatch) -> None:
    monkeypatch.setattr(type(robot), "inverse_dynamics", lambda *_: np.full(3, np.nan))
    found = compare(robot, engines=("multipliers",), states=3)
    assert not found.ok
    with pytest.raises(VerificationError, match="inverse-dynamics forces"):
        found.check()


@pytest.mark.parametrize(("library", "package"), [("mujoco", "mujoco"), ("pinocchio", "pin")])
def test_missing_engine_names_the_command(library, package, robot, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(VerificationError, match=f'python -m pip install "{package}>='):
        compare(robot, engines=(library,), states=1)
    found = compare(robot, engines=(library, "multipliers"), states=1, missing="skip")
    assert found.ok
    assert f'pip install "{package}>=' in found[library].skipped
    assert "skipped" in str(found)
    assert "skipped" in found.to_dict()["engines"][library]


def test_engine_that_is_too_old_is_refused(robot, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", SimpleNamespace(__version__="3.2.7"))
    with pytest.raises(VerificationError, match=r"mujoco 3\.2\.7 is older than 3\.3\.3"):
        compare(robot, engines=("mujoco",), states=1)


def test_nothing_verified_is_not_ok(robot, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    found = compare(robot, engines=("mujoco",), states=1, missing="skip")
    assert not found.ok
    with pytest.raises(VerificationError, match="nothing was verified"):
        found.check()


def test_dictionary_is_json_and_has_the_stable_keys(robot) -> None:
    found = json.loads(json.dumps(compare(robot, engines=("multipliers",), states=2).to_dict()))
    engine = found["engines"]["multipliers"]
    assert engine["forward_dynamics"]["max_rel_error"] < 1e-11
    assert engine["inverse_dynamics"]["max_abs_force_error"] < 1e-10
    assert engine["reactions"]["max_rel_error"] < 1e-11
    assert found["ok"] is True


def test_progress_counts_every_state(robot) -> None:
    seen = []
    compare(robot, engines=("multipliers", "multipliers"), states=3, progress=lambda *at: seen.append(at))
    assert seen == [(k, 6) for k in range(1, 7)]


def test_bad_arguments_are_refused(robot) -> None:
    with pytest.raises(UnknownName, match="did you mean 'mujoco'"):
        compare(robot, engines=("mujocoo",))
    with pytest.raises(InputError, match="at least one state"):
        compare(robot, engines=("multipliers",), states=0)
    with pytest.raises(InputError, match="'raise' or 'skip'"):
        compare(robot, engines=("multipliers",), missing="ignore")
    other = MultiplierEngine(robot.mechanism, robot.parameters, robot.labels[:3])
    with pytest.raises(InputError, match="other closures"):
        compare(robot, engines=(other,))
