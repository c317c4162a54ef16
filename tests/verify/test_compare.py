"""Independent engines agree with the model, and notice when it is wrong."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest

from nullbody import InputError, UnknownName, VerificationError, build, derive
from nullbody.mechanism import GROUND, AbstractTreeJoint, Body, Mechanism, Motion, Pose, Revolute
from nullbody.verify import AbstractEngine, MujocoEngine, MultiplierEngine, PinocchioEngine, compare
from tests.mechanisms import four_bar, slider_crank, two_bodies
from tests.verify.hard import SPECIAL
from tests.verify.mechanisms import quaternion_loop, tree

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

    def __init__(self, model, fault: str, row: int = 4) -> None:
        self.labels = model.labels
        self.fault, self.row = fault, row
        self.honest = MultiplierEngine(model.mechanism, model.parameters, model.labels)

    def forward_dynamics(self, q, q_dot, u, t=0.0):
        q_ddot, lam = self.honest.forward_dynamics(q, q_dot, u, t)
        return q_ddot, lam * np.where(np.arange(len(lam)) == self.row, -1, 1) if self.fault == "reactions" else lam

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


def test_flipped_generalized_force_is_named_where_inputs_are_few() -> None:
    model = build(derive(tree("Universal")))
    assert compare(model, engines=(Planted(model, ""),), states=3).ok
    found = compare(model, engines=(Planted(model, "generalized_forces"),), states=3)
    wrong = [name for name, quantity in found["planted"].quantities.items() if quantity.max_rel_error > 1e-10]
    assert wrong == ["inverse_dynamics"]


def test_multipliers_of_norms_are_no_reactions() -> None:
    """Another number for |e| = 1 alone is no disagreement; for a force it is."""
    model = build(derive(quaternion_loop("Spherical")))
    norm = model.labels.index("free norm")
    assert (
        "reactions"
        in compare(model, engines=(Planted(model, "reactions", norm),), states=3).check()["planted"].quantities
    )
    assert not compare(model, engines=(Planted(model, "reactions", 0),), states=3).ok


def test_redundant_equations_share_their_force() -> None:
    """Compared are generalized forces: a flipped one is noticed all the same."""
    model = build(derive(SPECIAL["welded_twice"]()))
    found = compare(model, engines=(Planted(model, ""),), states=3).check()
    assert found["planted"]["reactions"].ours.shape == (len(model.coordinates),)
    assert not compare(model, engines=(Planted(model, "reactions", 1),), states=3).ok


def test_mechanism_that_an_engine_cannot_have_is_skipped_with_the_reason(engine) -> None:
    @dataclass(frozen=True)
    class Helix(AbstractTreeJoint):
        """p = q / 10 along z, R = Rz(q)."""

        units = ("rad",)
        zero = (0,)

        def motion(self, q, sin, cos) -> Motion:
            turn = Revolute("turn", "a", "b").motion(q, sin, cos)
            return Motion(Pose(turn.pose.rotation, [0, 0, q[0] / 10]), turn.angular, [[0, 0, Fraction(1, 10)]])

    bolt = Body("bolt", 2, (0.1, 0, 0), (0.1, 0.1, 0.1))
    model = build(derive(Mechanism("bolt", (bolt,), (Helix("thread", GROUND, "bolt", ("q",)),), gravity=(0, 0, -9.81))))
    found = compare(model, engines=(engine,), states=3)
    if engine == "multipliers":
        assert found.check().ok
        return
    assert "joint 'thread' is a Helix, which cannot be written for another engine" in found[engine].skipped
    assert not found.ok
    with pytest.raises(VerificationError, match="nothing was verified"):
        found.check()
    assert compare(model, engines=(engine, "multipliers"), states=3).ok


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
