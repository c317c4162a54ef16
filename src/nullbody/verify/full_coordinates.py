"""A second road inside: multipliers in all redundant coordinates, by differentiating poses in time exactly.

Nothing is symbolic and nothing is eliminated. Of the mechanism only the joints' poses and the residuals of its
constraints and loads are used: neither the velocities that joints state, nor M, h, A, N, c or gamma of the derivation.
Each body's pose carries its derivatives along unit changes of q and along the motion (`Taylor`, exact rules):

    p -> J = dp/dq, acceleration p'';   R -> [W_j x] = dR/dq_j R^T,  [omega x] = R' R^T,  [omega' x] = R'' R^T + R' R'^T
    M = sum m J^T J + W^T I W                                      I in the ground frame, about the centre
    h = sum m J^T (p'' - g) + W^T (I omega' + omega x I omega)     for q'' = 0
    A = dPhi/dq,  c = Phi'' for q'' = 0
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from nullbody.formats import frame, mass_properties, triple
from nullbody.mechanism import GROUND, Mechanism
from nullbody.typing import FloatArray
from nullbody.verify.constraint_rows import constraint_rows, load_terms
from nullbody.verify.engine import Terms
from nullbody.verify.kkt import AbstractTermsEngine
from nullbody.verify.taylor import Moving, cosine, sine
from nullbody.verify.taylor_motion import BodyMotion, TaylorMotion, Variables

__all__ = ["MultiplierEngine"]


class MultiplierEngine(AbstractTermsEngine):
    """Multipliers in full coordinates from the joints' poses alone; needs nothing installed."""

    name = "multipliers"
    version = ""

    def __init__(self, mechanism: Mechanism, values: Mapping[str, float], labels: tuple[str, ...]) -> None:
        super().__init__(mechanism, values, labels)
        self._mechanism, self._values = mechanism, dict(values)
        self._gravity = triple(mechanism.gravity, values)
        self._masses = {body.name: mass_properties(body, values) for body in mechanism.bodies}

    def terms(self, q: FloatArray, q_dot: FloatArray, t: float = 0.0) -> Terms:
        """M, h, A, c at one state."""
        size = len(q)
        variables = Variables.at(self._mechanism.coordinates, q, q_dot, t)
        bodies = self._poses(variables)
        motion = TaylorMotion(self._mechanism, self._values, variables, bodies)
        M, h = load_terms(motion)
        for name, (mass, centre, inertia) in self._masses.items():
            R, p = bodies[name].rotation, bodies[name].position + bodies[name].rotation @ centre
            back = R.value.T
            J, W, omega = p.first[:size], _axial(R.first[:size] @ back), _axial(R.first[-1] @ back)
            turn = _axial(R.second[-1] @ back + R.first[-1] @ R.first[-1].T)
            moment = R.value @ inertia @ back
            M += mass * J @ J.T + W @ moment @ W.T
            h += mass * J @ (p.second[-1] - self._gravity)
            h += W @ (moment @ turn + np.cross(omega, moment @ omega))
        return M, h, *constraint_rows(motion)

    def _poses(self, variables: Variables) -> dict[str, BodyMotion]:
        """The poses of all bodies: that of the parent, to the joint, along its motion, and back by `on`."""
        directions = variables.directions
        fixed = Moving.fixed(np.eye(3), directions), Moving.fixed(np.zeros(3), directions)
        poses = {GROUND: BodyMotion(*fixed)}
        for joint in self._mechanism.tree_order():
            at, back = frame(joint.at, self._values), frame(joint.on, self._values).inverse()
            held = poses[joint.parent].frame(at.rotation, at.position)
            pose = joint.motion([variables.q[name] for name in joint.coordinates], sine, cosine).pose
            rotation = held.rotation @ Moving.of(pose.rotation, directions)
            position = held.position + held.rotation @ Moving.of(pose.position, directions)
            poses[joint.child] = BodyMotion(rotation, position).frame(back.rotation, back.position)
        return poses


def _axial(skew: FloatArray) -> FloatArray:
    """w with [w x] = the skew part of a matrix, or of each of a stack."""
    x, y, z = (skew[..., k, j] - skew[..., j, k] for j, k in ((1, 2), (2, 0), (0, 1)))
    return np.stack([x, y, z], -1) / 2
