"""Pinocchio's tree algorithms on the same robot, and its exact contact dynamics where loops hold points only."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from nullbody.formats import RigidFrame, Step, frame, loop_points, mass_properties, steps, triple
from nullbody.mechanism import GROUND, Mechanism
from nullbody.typing import FloatArray
from nullbody.verify.engine import load
from nullbody.verify.engine_motion import FrameMotion, VelocityMap
from nullbody.verify.kkt import multipliers
from nullbody.verify.tree_engine import AbstractTreeEngine

__all__ = ["PinocchioEngine"]

_OLDEST = "4.0.0"  # before, initConstraintDynamics took other arguments

_ACCURACY = 1e-15  # of the proximal iteration on the closures [m/s^2]
_MU = 1e-10  # proximal damping: regularises redundant closures, and its effect is iterated away
_ITERATIONS = 50


class PinocchioEngine(AbstractTreeEngine):
    """One Pinocchio joint for each slide, hinge and ball; Euler parameters are its quaternion.

    Where loops hold points together and there is nothing else, accelerations and multipliers are those of
    constraintDynamics, with one three-dimensional contact for each loop. Otherwise rows of constraints and forces of
    loads are the mechanism's residuals and efforts on Pinocchio's poses, Jacobians and their rates, in a dense solve.

    Raises:
        VerificationError: Pinocchio is not installed, or older than 4.0.
        MechanismError: a tree joint of a type that is no chain of slides, hinges and balls.
    """

    name = "pinocchio"

    def __init__(self, mechanism: Mechanism, values: Mapping[str, float], labels: tuple[str, ...]) -> None:
        super().__init__(mechanism, values, labels)
        self._pin = load("pinocchio", "pin", _OLDEST)
        self.version = str(self._pin.__version__)
        self._redundant = len(labels) < sum(len(loop.rows) for loop in mechanism.loops)
        self._model = self._pin.Model()
        self._model.gravity.linear = triple(mechanism.gravity, values)
        self._holders: dict[str, tuple[int, RigidFrame]] = {GROUND: (0, RigidFrame(np.eye(3), np.zeros(3)))}
        found = self._tree()
        self._data = self._model.createData()
        joints = [(step, self._model.joints[joint]) for step, joint in found]
        places = {name: joint.idx_q + k for step, joint in joints for k, name in enumerate(_quaternion_order(step))}
        self._q_at = np.array([places[name] for name in mechanism.coordinates], dtype=np.intp)
        at = [(step, int(joint.idx_v)) for step, joint in joints]
        self._map = VelocityMap(mechanism.coordinates, at, self._model.nv)
        self._contacts = None
        if self._only_points:
            self._contacts = self._loops()
            self._contact_data = self._pin.StdVec_RigidConstraintData()
            for contact in self._contacts:
                self._contact_data.append(contact.createData())
            self._pin.initConstraintDynamics(self._model, self._data, self._contacts, self._contact_data)

    def forward_dynamics(
        self, q: FloatArray, q_dot: FloatArray, u: FloatArray, t: float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """q'' by constraintDynamics; lambda from its contact forces, turned into the ground frame.

        Its iteration may not settle beside singular configurations: a dense solve is taken there.
        """
        if self._contacts is None:
            return super().forward_dynamics(q, q_dot, u, t)
        pin, E, force = self._pin, self._map.matrix(q), self._S @ u
        settings = pin.ProximalSettings(_ACCURACY, _MU, _ITERATIONS)
        state = self._position(q), E @ q_dot, E @ force
        found = pin.constraintDynamics(self._model, self._data, *state, self._contacts, self._contact_data, settings)
        if settings.iter >= _ITERATIONS:
            return super().forward_dynamics(q, q_dot, u, t)
        q_ddot: FloatArray = E.T @ np.array(found)
        if self._redundant:
            M, h, A, _ = self.terms(q, q_dot)
            return q_ddot, multipliers(A[self._kept], force - M @ q_ddot - h)
        turned = [contact.oMc1.rotation @ contact.contact_force.linear for contact in self._contact_data]
        return q_ddot, -np.concatenate([*turned, np.zeros(0)])

    def _tree_terms(self, q: FloatArray, nu: FloatArray) -> tuple[FloatArray, FloatArray]:
        """M by crba, h by rnea."""
        pin, model, data, position = self._pin, self._model, self._data, self._position(q)
        M = np.array(pin.crba(model, data, position))
        h = np.array(pin.rnea(model, data, position, nu, np.zeros(model.nv)))
        pin.computeJointJacobiansTimeVariation(model, data, position, nu)
        return np.triu(M) + np.triu(M, 1).T, h

    def _frame(self, body: str, nu: FloatArray) -> FrameMotion:
        """From the Jacobian of the velocity at the ground's origin: p' = v_O + omega x p."""
        pin, size = self._pin, self._model.nv
        joint, place = self._holders[body]
        if joint == 0:
            return FrameMotion.fixed(size)._replace(rotation=place.rotation, position=place.position)
        held = self._data.oMi[joint]
        rotation, p = held.rotation @ place.rotation, held.rotation @ place.position + held.translation
        asked = self._model, self._data, joint, pin.WORLD  # answers of a single column come as vectors
        J = pin.getJointJacobian(*asked).reshape(6, size)
        J_rate = pin.getJointJacobianTimeVariation(*asked).reshape(6, size)
        at_p = J[:3] - pin.skew(p) @ J[3:]
        rate = J_rate[:3] - pin.skew(p) @ J_rate[3:] - pin.skew(at_p @ nu) @ J[3:]
        return FrameMotion(rotation, p, at_p, J[3:], rate, J_rate[3:])

    def _position(self, q: FloatArray) -> FloatArray:
        """The coordinates in the order of Pinocchio's joints."""
        found = np.zeros(self._model.nq)
        found[self._q_at] = q
        return found

    def _tree(self) -> list[tuple[Step, int]]:
        """Add all joints and bodies; every step with its joint. Massless bodies are fine.

        Depth first: Pinocchio takes the coordinates of a subtree to be contiguous, without checking it.
        """
        pin, mechanism, values = self._pin, self._mechanism, self._values
        found: list[tuple[Step, int]] = []
        bodies = {body.name: body for body in mechanism.bodies}
        waiting = [joint for joint in mechanism.joints if joint.parent == GROUND]
        while waiting:
            joint = waiting.pop()
            held, place = self._holders[joint.parent]
            place = place @ frame(joint.at, values)
            for step in steps(joint):
                held = self._model.addJoint(held, _joint_model(pin, step), self._se3(place), step.coordinate)
                place = RigidFrame(np.eye(3), np.zeros(3))
                found.append((step, held))
            place = place @ frame(joint.on, values).inverse()
            mass, centre, inertia = mass_properties(bodies[joint.child], values)
            self._model.appendBodyToJoint(held, pin.Inertia(mass, centre, inertia), self._se3(place))
            self._holders[joint.child] = held, place
            waiting += [other for other in mechanism.joints if other.parent == joint.child]
        return found

    def _loops(self) -> Any:
        """A contact between the two points of each loop, in the axes of the first."""
        pin = self._pin
        contacts = pin.StdVec_RigidConstraintModel()
        for loop in self._mechanism.loops:
            sides: list[Any] = []
            for body, point in zip((loop.parent, loop.child), loop_points(loop, self._values), strict=True):
                joint, place = self._holders[body]
                sides += [joint, self._se3(place @ RigidFrame(np.eye(3), point))]
            contacts.append(pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, self._model, *sides, pin.LOCAL))
        return contacts

    def _se3(self, place: RigidFrame) -> Any:
        return self._pin.SE3(place.rotation, place.position)


def _quaternion_order(step: Step) -> tuple[str, ...]:
    """The coordinates of a step as Pinocchio lists them: of a quaternion x, y, z, w."""
    return (*step.coordinates[1:], step.coordinates[0]) if step.kind == "ball" else step.coordinates


def _joint_model(pin: Any, step: Step) -> Any:
    """Pinocchio's joint of one step."""
    if step.kind == "ball":
        return pin.JointModelSpherical()
    kind = pin.JointModelPrismaticUnaligned if step.kind == "slide" else pin.JointModelRevoluteUnaligned
    return kind(np.array(step.axis, dtype=float))
