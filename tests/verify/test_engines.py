"""Engine against engine on every joint in both roles, every constraint and every load, also where loops are open."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from nullbody.formats import Step
from nullbody.mechanism import Mechanism
from nullbody.verify import MujocoEngine, MultiplierEngine, PinocchioEngine, tree_engine
from nullbody.verify.engine_motion import VelocityMap
from nullbody.verify.taylor import Taylor
from tests.verify.cases import CASES
from tests.verify.mechanisms import tree

CLASSES = {"mujoco": MujocoEngine, "pinocchio": PinocchioEngine}
AGREEMENT = 1e-12  # relative; measured 7e-14

#: Redundant loops: open ones have no solution that engines could agree on, and those that hold nothing no reaction.
CLOSED_ONLY = ("welded_twice", "locked_ball", "rigid_pair")


@pytest.fixture(params=sorted(CLASSES))
def kind(request):
    """Each engine in turn."""
    pytest.importorskip(request.param, reason=f"{request.param} is not installed")
    return CLASSES[request.param]


def motions(mechanism: Mechanism, count: int = 3) -> Iterator[tuple]:
    """Random q near the home, q', u, t; Euler parameters of length 1."""
    draw = np.random.default_rng(5)
    home = np.array(list(mechanism.home_values(mechanism.values()).values()))
    for _ in range(count):
        q, q_dot = home + 0.2 * draw.normal(size=len(home)), draw.normal(size=len(home))
        for joint in mechanism.joints:
            if joint.own_rows:
                at = [mechanism.coordinates.index(name) for name in joint.coordinates[-4:]]
                q[at] /= np.linalg.norm(q[at])
                q_dot[at] -= q[at] * (q[at] @ q_dot[at])
        yield q, q_dot, draw.normal(size=len(mechanism.inputs)), draw.uniform(0, 2)


def worst(mechanism: Mechanism, kind: type) -> float:
    """The largest relative difference of q'', of multipliers that are forces, and of M q'' + h along the motion."""
    rows = (*mechanism.holonomic_rows, *mechanism.nonholonomic_rows)
    labels = tuple(label for label, _ in rows)
    norms = {f"{joint.name} {row}" for joint in mechanism.joints for row in joint.own_rows}
    forces = [i for i, label in enumerate(labels) if label not in norms]
    ours, theirs = (made(mechanism, mechanism.values(), labels) for made in (MultiplierEngine, kind))
    found = [0.0]
    for q, q_dot, u, t in motions(mechanism):
        (a, lam), (b, mu) = (engine.forward_dynamics(q, q_dot, u, t) for engine in (ours, theirs))
        found.append(np.abs(a - b).max() / np.abs(a).max())
        if forces:
            found.append(np.abs(lam - mu)[forces].max() / np.abs(lam).max())
        power, other = (q_dot @ engine.generalized_forces(q, q_dot, a, t) for engine in (ours, theirs))
        gross = np.abs(q_dot) @ np.abs(ours.generalized_forces(q, q_dot, 0 * a, t))
        found.append(abs(power - other) / gross)
    return max(found)


@pytest.mark.parametrize("name", [name for name in CASES if name not in CLOSED_ONLY])
def test_engines_agree(name, kind) -> None:
    assert worst(CASES[name](), kind) < AGREEMENT


def a_column_of_euler_parameters(patch) -> None:
    """omega = 2 G(e) e' with one column turned."""
    honest = VelocityMap.matrix
    patch.setattr(VelocityMap, "matrix", lambda self, q: honest(self, q) * np.where(np.arange(len(q)) == 4, -1, 1))


def the_rate_of_a_jacobian(patch) -> None:
    """p'' and omega' with -J' nu and -W' nu."""
    honest = tree_engine.body_motion

    def turned(frame, *rest):
        return honest(frame._replace(J_rate=-frame.J_rate, W_rate=-frame.W_rate), *rest)

    patch.setattr(tree_engine, "body_motion", turned)


def a_sign_in_taylor_arithmetic(patch) -> None:
    """-x = x"""
    patch.setattr(Taylor, "__neg__", lambda self: self)


@pytest.mark.parametrize(
    ("plant", "name"),
    [
        (a_column_of_euler_parameters, "quaternion loop Revolute"),
        (a_column_of_euler_parameters, "constraint RollingDisc"),
        (a_column_of_euler_parameters, "load Flywheel"),
        (the_rate_of_a_jacobian, "loop Revolute"),
        (the_rate_of_a_jacobian, "massless_links"),
        (a_sign_in_taylor_arithmetic, "quaternion loop Revolute"),
        (a_sign_in_taylor_arithmetic, "constraint RollingDisc"),
    ],
)
def test_planted_error_is_noticed(plant: Callable, name, kind, monkeypatch) -> None:
    plant(monkeypatch)
    assert worst(CASES[name](), kind) > 1e-3


def test_rate_of_the_velocity_map_is_its_derivative() -> None:
    """E is linear in Euler parameters: E(q + q') - E(q) = E' along q', and E' q' = 0 leaves no acceleration."""
    names = ("e0", "e1", "e2", "e3", "s")
    E = VelocityMap(names, [(Step(names[:4], "ball"), 1), (Step(("s",), "slide"), 0)], 4)
    q, q_dot = np.random.default_rng(1).normal(size=(2, 5))
    assert E.rate(q_dot) == pytest.approx(E.matrix(q + q_dot) - E.matrix(q), abs=1e-15)
    assert E.rate(q_dot) @ q_dot == pytest.approx(np.zeros(4), abs=1e-15)
    assert E.matrix(q)[0].tolist() == [0, 0, 0, 0, 1]


def test_pinocchio_solves_loops_of_points_itself(monkeypatch) -> None:
    """Its contact dynamics, not our dense solve, give q'' and lambda of spherical loops."""
    pytest.importorskip("pinocchio", reason="pinocchio is not installed")
    mechanism = CASES["loop Spherical"]()
    labels = tuple(label for label, _ in mechanism.holonomic_rows)
    engine = PinocchioEngine(mechanism, mechanism.values(), labels)
    monkeypatch.setattr(PinocchioEngine, "terms", None)
    q, q_dot, u, t = next(motions(mechanism))
    honest = MultiplierEngine(mechanism, mechanism.values(), labels)
    for found, expected in zip(
        engine.forward_dynamics(q, q_dot, u, t), honest.forward_dynamics(q, q_dot, u, t), strict=True
    ):
        assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_mass_matrix_is_singular_along_euler_parameters_alone(kind) -> None:
    """M e = 0 of each ball: no kinetic energy belongs to |e|."""
    mechanism = tree("Spherical")
    engine = kind(mechanism, mechanism.values(), ("first norm", "last norm"))
    q, q_dot, _, _ = next(motions(mechanism))
    M = engine.terms(q, q_dot)[0]
    for at in (slice(0, 4), slice(5, 9)):
        assert np.abs(M[:, at] @ q[at]).max() < 1e-14
    assert np.linalg.matrix_rank(M, tol=1e-10) == 7
