"""The model against all engines on every joint in both roles, every constraint and every load; planted errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from nullbody import Model, VerificationError, build, derive
from nullbody.mechanism import Motion
from nullbody.verify import MujocoEngine, MultiplierEngine, PinocchioEngine, compare
from tests.verify.cases import CASES
from tests.verify.mechanisms import CONSTRAINTS, LOADS, LOOP_JOINTS, TREE_JOINTS, constrained, loaded, loop, tree

CLASSES = {"mujoco": MujocoEngine, "pinocchio": PinocchioEngine, "multipliers": MultiplierEngine}
AGREEMENT = 1e-11  # relative; measured 2e-13


@cache
def model_of(name: str) -> Model:
    return build(derive(CASES[name]()))


@pytest.fixture(params=sorted(CLASSES))
def engine(request) -> str:
    """Each engine in turn."""
    if request.param != "multipliers":
        pytest.importorskip(request.param, reason=f"{request.param} is not installed")
    return request.param


@pytest.mark.parametrize("name", CASES)
def test_model_agrees(name, engine) -> None:
    found = compare(model_of(name), engines=(engine,), states=6, tolerance=AGREEMENT).check()
    assert not found[engine].skipped
    assert {"forward_dynamics", "inverse_dynamics"} <= set(found[engine].quantities)
    assert ("reactions" in found[engine].quantities) == any("norm" not in label for label in model_of(name).labels)


@pytest.mark.parametrize("name", CASES)
def test_a_millionth_of_p_is_noticed(name, engine) -> None:
    model = model_of(name)
    planted = CLASSES[engine](model.mechanism, {"p": 0.2 * (1 + 1e-6)}, model.labels)
    assert not compare(model, engines=(planted,), states=3).ok


def moving_parts() -> Iterator[tuple[str, str]]:
    """Joints with the velocities that are not zero."""
    for name, (kind, axes) in TREE_JOINTS.items():
        motion = kind("j", "a", "b", **axes).motion(np.ones(7)[: len(kind.units)], np.sin, np.cos)
        yield from ((name, part) for part in ("angular", "linear") if np.any(getattr(motion, part)))


@pytest.mark.parametrize(("name", "part"), list(moving_parts()))
def test_a_sign_in_a_joints_velocities_is_noticed(name, part, monkeypatch) -> None:
    """Only the derivation uses the velocities that joints state; engines differentiate or know them by themselves."""
    kind, _ = TREE_JOINTS[name]
    honest = kind.motion

    def flipped(self, q, sin, cos) -> Motion:
        motion = honest(self, q, sin, cos)
        return replace(motion, **{part: [[-x for x in column] for column in getattr(motion, part)]})

    monkeypatch.setattr(kind, "motion", flipped)
    model = build(derive(tree(name)))
    monkeypatch.undo()
    assert not compare(model, engines=("multipliers",), states=3).ok


def parts(table: Mapping[str, object], methods: Sequence[str]) -> list[tuple[str, str]]:
    """Names with those of the methods that their types have."""
    return [(name, part) for name, entry in table.items() for part in methods if part in vars(type(entry))]


@pytest.mark.parametrize(("name", "part"), parts(LOADS, ("potential", "kinetic", "efforts")))
def test_a_sign_of_a_load_is_noticed(name, part, monkeypatch) -> None:
    kind = type(LOADS[name])
    honest = getattr(kind, part)

    def flipped(self, motion):
        found = honest(self, motion)
        return [(-effort, flow) for effort, flow in found] if part == "efforts" else -found

    monkeypatch.setattr(kind, part, flipped)
    model = build(derive(loaded(name)))
    monkeypatch.undo()
    undamped = (name, part) == ("Spring without length", "efforts")
    assert compare(model, engines=("multipliers",), states=3).ok == undamped


@pytest.mark.parametrize("name", LOOP_JOINTS)
def test_a_sign_of_a_loop_is_noticed(name, monkeypatch) -> None:
    kind = LOOP_JOINTS[name][0]
    honest = kind.closure
    monkeypatch.setattr(kind, "closure", lambda self, a, b, scalar: [-x for x in honest(self, a, b, scalar)])
    model = build(derive(loop(name)))
    monkeypatch.undo()
    with pytest.raises(VerificationError, match="disagree on reactions"):
        compare(model, engines=("multipliers",), states=3).check()


@pytest.mark.parametrize(
    ("name", "part"), parts({name: entry[0] for name, entry in CONSTRAINTS.items()}, ("holonomic", "nonholonomic"))
)
def test_a_sign_of_a_constraint_is_noticed(name, part, monkeypatch) -> None:
    kind = type(CONSTRAINTS[name][0])
    honest = getattr(kind, part)
    monkeypatch.setattr(kind, part, lambda self, motion: [-x for x in honest(self, motion)])
    model = build(derive(constrained(name)))
    monkeypatch.undo()
    with pytest.raises(VerificationError, match="disagree on reactions"):
        compare(model, engines=("multipliers",), states=3).check()
