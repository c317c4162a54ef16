"""A joint that closes a loop moves bodies as the same joint in the tree does: residuals against poses.

All engines share the mechanism's residuals with the model; here poses of tree joints judge them.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from nullbody.formats import frame
from nullbody.mechanism import AbstractTreeJoint
from nullbody.verify import MultiplierEngine
from nullbody.verify.taylor_motion import Variables
from tests.verify.mechanisms import LOOP_JOINTS, loop, twin, twin_coordinates

BOTH = [name for name, (kind, *_) in LOOP_JOINTS.items() if issubclass(kind, AbstractTreeJoint)]
TORQUE = np.array([0.7])


class Twins:
    """One motion of an arm with a body behind it, in the coordinates of the tree and in those of the loop."""

    def __init__(self, name: str) -> None:
        held, free = twin(name), loop(name)
        self.tree = MultiplierEngine(held, held.values(), tuple(label for label, _ in held.holonomic_rows))
        self.loop = MultiplierEngine(free, free.values(), tuple(label for label, _ in free.holonomic_rows))
        self.q = np.array(list(held.home_values(held.values()).values()))
        self.balls = any(joint.own_rows for joint in held.joints)
        self.q_dot = self.admissible(np.random.default_rng(3).normal(size=len(self.q)))
        self.variables = partial(Variables.at, held.coordinates)
        x, x_dot = self.free_motion(self.q, self.q_dot)
        self.x, self.x_dot = np.array([self.q[0], *x]), np.array([self.q_dot[0], *x_dot])

    def admissible(self, rates: np.ndarray) -> np.ndarray:
        """Rates of the arm and the joint, of Euler parameters those that keep |e|."""
        if not self.balls:
            return rates
        e = self.q[1:]
        return np.array([rates[0], *(rates[1:] - e * (e @ rates[1:]))])

    def free_motion(self, q, q_dot) -> tuple[list[float], list[float]]:
        """Position and roll-pitch-yaw angles of the body, and their rates."""
        body = self.tree._poses(self.variables(q, q_dot, 0.0))["body"]
        turning = body.rotation.first[-1] @ body.rotation.value.T
        omega = turning[2, 1], turning[0, 2], turning[1, 0]
        return twin_coordinates(body.rotation.value, body.position.value, omega, body.position.first[-1])

    def acceleration(self, q_ddot) -> np.ndarray:
        """p'' of the body for accelerations of the tree."""
        position = self.tree._poses(self.variables(self.q, self.q_dot, 0.0))["body"].position
        return position.second[-1] + position.first[: len(self.q)].T @ q_ddot


@pytest.fixture(params=BOTH)
def twins(request) -> Twins:
    """Each joint that has both roles."""
    return Twins(request.param)


def test_motions_of_the_tree_are_those_that_the_loop_lets_free(twins) -> None:
    A = twins.loop.terms(twins.x, twins.x_dot)[2]
    rates = [twins.admissible(unit) for unit in np.eye(len(twins.q))]
    free = np.array([[held[0], *twins.free_motion(twins.q, held)[1]] for held in rates])
    assert np.abs(A @ free.T).max() < 1e-14
    assert np.linalg.matrix_rank(A, tol=1e-9) + np.linalg.matrix_rank(free, tol=1e-9) == 7
    assert np.linalg.matrix_rank(A, tol=1e-9) == len(A)


def test_both_roles_have_the_same_accelerations(twins) -> None:
    q_ddot, _ = twins.tree.forward_dynamics(twins.q, twins.q_dot, TORQUE)
    x_ddot, _ = twins.loop.forward_dynamics(twins.x, twins.x_dot, TORQUE)
    assert x_ddot[0] == pytest.approx(q_ddot[0], rel=1e-12)
    assert x_ddot[1:4] == pytest.approx(twins.acceleration(q_ddot), rel=1e-12)


@pytest.mark.parametrize("name", ["Distance", "PointOnLine", "PointOnPlane"])
def test_points_keep_to_what_holds_them(name) -> None:
    """Distance, line and plane written out: the point b on the body against the frame a on the arm."""
    free = loop(name)
    engine = MultiplierEngine(free, free.values(), tuple(label for label, _ in free.holonomic_rows))
    draw = np.random.default_rng(4)
    x = np.array(list(free.home_values(free.values()).values()))
    x_dot = draw.normal(size=7)
    _, _, A, c = engine.terms(x, x_dot)
    joint = free.loops[0]

    def gaps(t: float) -> np.ndarray:
        bodies = engine._poses(Variables.at(free.coordinates, x + t * x_dot, x_dot, 0.0))
        at, on = frame(joint.at, {"p": 0.2}), frame(joint.on, {"p": 0.2})
        R = bodies["arm"].rotation.value @ at.rotation
        a = bodies["arm"].position.value + bodies["arm"].rotation.value @ at.position
        b = bodies["body"].position.value + bodies["body"].rotation.value @ on.position
        local = R.T @ (a - b)
        return {
            "Distance": np.array([(local @ local / 0.6 - 0.6) / 2]),
            "PointOnLine": local[[2, 1]],
            "PointOnPlane": local[[1]],
        }[name]

    h = 1e-4
    assert np.abs(gaps(0.0)).max() < 1e-15
    assert A @ x_dot == pytest.approx((gaps(h) - gaps(-h)) / (2 * h), abs=1e-7)
    assert c == pytest.approx((gaps(h) - 2 * gaps(0.0) + gaps(-h)) / h**2, abs=1e-6)
