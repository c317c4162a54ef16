"""Pinocchio's tree algorithms and its exact contact dynamics on the same robot."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from nullbody.formats import RigidFrame, frame, loop_points, mass_properties, steps, triple
from nullbody.mechanism import GROUND, Mechanism
from nullbody.typing import FloatArray
from nullbody.verify.engine import AbstractEngine, Terms, input_matrix, kept_rows, load
from nullbody.verify.kkt import forces, multipliers

__all__ = ["PinocchioEngine"]

_OLDEST = "4.0.0"  # before, initConstraintDynamics took other arguments

_ACCURACY = 1e-15  # of the proximal iteration on the closures [m/s^2]
_MU = 1e-10  # proximal damping: regularises redundant closures, and its effect is iterated away
_ITERATIONS = 50


class PinocchioEngine(AbstractEngine):
    """One Pinocchio joint for each coordinate, one three-dimensional contact for each loop.

    Raises:
        VerificationError: Pinocchio is not installed, or older than 4.0.
    """

    name = "pinocchio"

    def __init__(self, mechanism: Mechanism, values: Mapping[str, float], labels: tuple[str, ...]) -> None:
        self._pin = load("pinocchio", "pin", _OLDEST)
        self.version = str(self._pin.__version__)
        self.labels = labels
        self._kept = kept_rows(mechanism, labels)
        self._redundant = len(labels) < sum(len(loop.rows) for loop in mechanism.loops)
        self._model = self._pin.Model()
        self._model.gravity.linear = triple(mechanism.gravity, values)
        holders = self._tree(mechanism, values)
        self._data = self._model.createData()
        ids = [self._model.getJointId(name) for name in mechanism.coordinates]
        self._at = np.array([self._model.joints[joint].idx_v for joint in ids])
        self._contacts = self._loops(mechanism, values, holders)
        self._contact_data = self._pin.StdVec_RigidConstraintData()
        for contact in self._contacts:
            self._contact_data.append(contact.createData())
        self._pin.initConstraintDynamics(self._model, self._data, self._contacts, self._contact_data)
        self._S = input_matrix(mechanism)

    def forward_dynamics(self, q: FloatArray, q_dot: FloatArray, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """q'' by constraintDynamics; lambda from its contact forces, turned into the ground frame."""
        pin = self._pin
        settings = pin.ProximalSettings(_ACCURACY, _MU, _ITERATIONS)
        state = self._sorted(q), self._sorted(q_dot), self._sorted(self._S @ u)
        found = pin.constraintDynamics(self._model, self._data, *state, self._contacts, self._contact_data, settings)
        q_ddot = np.array(found)[self._at]
        if self._redundant:
            M, h, A, _ = self.terms(q, q_dot)
            return q_ddot, multipliers(A[self._kept], self._S @ u - M @ q_ddot - h)
        turned = [contact.oMc1.rotation @ contact.contact_force.linear for contact in self._contact_data]
        return q_ddot, -np.concatenate([*turned, np.zeros(0)])

    def inverse_dynamics(self, q: FloatArray, q_dot: FloatArray, q_ddot: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(u, lambda) with S u - A^T lambda = M q'' + h."""
        return forces(self.terms(q, q_dot), self._S, q_ddot, self._kept)

    def terms(self, q: FloatArray, q_dot: FloatArray) -> Terms:
        """M by crba, h by rnea, A by the joints' Jacobians; c is left to constraintDynamics."""
        pin, model, data, at = self._pin, self._model, self._data, self._at
        position, rate = self._sorted(q), self._sorted(q_dot)
        M = np.array(pin.crba(model, data, position))
        M = np.triu(M) + np.triu(M, 1).T
        h = np.array(pin.rnea(model, data, position, rate, np.zeros(model.nv)))
        pin.computeJointJacobians(model, data, position)
        rows = [np.zeros((0, model.nv))]
        for contact in self._contacts:
            sides = ((contact.joint1_id, contact.joint1_placement), (contact.joint2_id, contact.joint2_placement))
            rows.append(np.subtract(*(self._point_jacobian(joint, place) for joint, place in sides)))
        A = np.vstack(rows)
        return M[np.ix_(at, at)], h[at], A[:, at], np.zeros(len(A))

    def _point_jacobian(self, joint: int, place: Any) -> FloatArray:
        """Velocity of a point of a joint's body per unit rate, in the ground frame (3 x nv)."""
        if joint == 0:
            return np.zeros((3, self._model.nv))
        at_origin = self._pin.getJointJacobian(self._model, self._data, joint, self._pin.LOCAL_WORLD_ALIGNED)
        arm = self._data.oMi[joint].rotation @ place.translation
        found: FloatArray = at_origin[:3] - self._pin.skew(arm) @ at_origin[3:]
        return found

    def _sorted(self, values: FloatArray) -> FloatArray:
        """A vector in the order of Pinocchio's joints."""
        found = np.zeros(self._model.nv)
        found[self._at] = values
        return found

    def _tree(self, mechanism: Mechanism, values: Mapping[str, float]) -> dict[str, int]:
        """Add all joints and bodies; for each body the joint that carries it. Massless bodies are fine.

        Depth first: Pinocchio takes the coordinates of a subtree to be contiguous, without checking it.
        """
        pin = self._pin
        holders = {GROUND: 0}
        bodies = {body.name: body for body in mechanism.bodies}
        waiting = [joint for joint in mechanism.joints if joint.parent == GROUND]
        while waiting:
            joint = waiting.pop()
            held, place = holders[joint.parent], self._se3(frame(joint.at, values))
            for step in steps(joint):
                axis = np.array(step.axis, dtype=float)
                kind = pin.JointModelPrismaticUnaligned if step.kind == "slide" else pin.JointModelRevoluteUnaligned
                held = self._model.addJoint(held, kind(axis), place, step.coordinate)
                place = pin.SE3.Identity()
            mass, centre, inertia = mass_properties(bodies[joint.child], values)
            self._model.appendBodyToJoint(held, pin.Inertia(mass, centre, inertia), pin.SE3.Identity())
            holders[joint.child] = held
            waiting += [other for other in mechanism.joints if other.parent == joint.child]
        return holders

    def _loops(self, mechanism: Mechanism, values: Mapping[str, float], holders: Mapping[str, int]) -> Any:
        """A contact between the two points of each loop, in the axes of the first."""
        pin = self._pin
        contacts = pin.StdVec_RigidConstraintModel()
        for loop in mechanism.loops:
            place_a, place_b = (self._se3(RigidFrame(np.eye(3), point)) for point in loop_points(loop, values))
            sides = holders[loop.body_a], place_a, holders[loop.body_b], place_b
            contacts.append(pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, self._model, *sides, pin.LOCAL))
        return contacts

    def _se3(self, place: RigidFrame) -> Any:
        return self._pin.SE3(place.rotation, place.position)
