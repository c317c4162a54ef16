"""MuJoCo's own mass matrix, bias and Jacobians of a tree of its own joints, in an exact solve.

MuJoCo holds equality constraints only softly (2e-4 relative on accelerations of the 3-PRS), so its solver is
left out; everything that depends on the geometry and the masses is its own.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from nullbody.formats import mass_properties, steps
from nullbody.mechanism import Mechanism
from nullbody.typing import FloatArray
from nullbody.verify.engine import load
from nullbody.verify.engine_motion import FrameMotion, VelocityMap
from nullbody.verify.mujoco_tree import body_name, principal_inertia, step_name, tree_document
from nullbody.verify.tree_engine import AbstractTreeEngine

__all__ = ["MujocoEngine"]

_OLDEST = "3.3.3"  # before, mj_jacDot was wrong for a body with several hinges


class MujocoEngine(AbstractTreeEngine):
    """MuJoCo with slides, hinges and balls for all tree joints; Euler parameters are its ball's quaternion.

    Raises:
        VerificationError: MuJoCo is not installed, or older than 3.3.3.
        MechanismError: a tree joint of a type that is no chain of slides, hinges and balls.
    """

    name = "mujoco"

    def __init__(self, mechanism: Mechanism, values: Mapping[str, float], labels: tuple[str, ...]) -> None:
        super().__init__(mechanism, values, labels)
        self._mujoco = load("mujoco", "mujoco", _OLDEST)
        self.version = str(self._mujoco.__version__)
        self._model = self._mujoco.MjModel.from_xml_string(tree_document(mechanism, values))
        self._ids = {body.name: self._model.body(body_name(body.name)).id for body in mechanism.bodies}
        self._put_masses()
        self._data = self._mujoco.MjData(self._model)
        chain = [step for joint in mechanism.joints for step in steps(joint)]
        joints = [(step, self._model.joint(step_name(step.coordinate))) for step in chain]
        places = {name: joint.qposadr[0] + k for step, joint in joints for k, name in enumerate(step.coordinates)}
        self._q_at = np.array([places[name] for name in mechanism.coordinates], dtype=np.intp)
        at = [(step, int(joint.dofadr[0])) for step, joint in joints]
        self._map = VelocityMap(mechanism.coordinates, at, self._model.nv)

    def _put_masses(self) -> None:
        """The true masses and principal moments; the carriers have none."""
        model = self._model
        model.body_mass[:] = 0
        model.body_inertia[:] = 0
        for body in self._mechanism.bodies:
            mass, _, inertia = mass_properties(body, self._values)
            model.body_mass[self._ids[body.name]] = mass
            model.body_inertia[self._ids[body.name]] = principal_inertia(inertia)[0]

    def _tree_terms(self, q: FloatArray, nu: FloatArray) -> tuple[FloatArray, FloatArray]:
        """M by columns (mj_mulM), h by mj_rne; mj_fwdPosition would factorise M, which may be singular."""
        engine, model, data = self._mujoco, self._model, self._data
        data.qpos[self._q_at] = q
        data.qvel[:] = nu
        for stage in (engine.mj_kinematics, engine.mj_comPos, engine.mj_crb, engine.mj_comVel):
            stage(model, data)
        M, h = np.zeros((model.nv, model.nv)), np.zeros(model.nv)
        for column, unit in zip(M, np.eye(model.nv), strict=True):
            engine.mj_mulM(model, data, column, unit)
        engine.mj_rne(model, data, 0, h)
        return M, h

    def _frame(self, body: str, nu: FloatArray) -> FrameMotion:
        """Pose, mj_jac and mj_jacDot of a body's frame."""
        engine, model, data, at = self._mujoco, self._model, self._data, self._ids[body]
        J, W, J_rate, W_rate = (np.zeros((3, model.nv)) for _ in range(4))
        engine.mj_jac(model, data, J, W, data.xpos[at], at)
        engine.mj_jacDot(model, data, J_rate, W_rate, data.xpos[at], at)
        return FrameMotion(data.xmat[at].reshape(3, 3).copy(), data.xpos[at].copy(), J, W, J_rate, W_rate)
