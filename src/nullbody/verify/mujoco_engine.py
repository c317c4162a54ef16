"""MuJoCo's own mass matrix, bias and point Jacobians from our MJCF, in an exact solve.

MuJoCo holds equality constraints only softly (2e-4 relative on accelerations of the 3-PRS), so its solver is
left out; everything that depends on the geometry and the masses is its own.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from nullbody.formats import write_mjcf
from nullbody.mechanism import Mechanism
from nullbody.typing import FloatArray
from nullbody.verify.engine import Terms, load
from nullbody.verify.kkt import AbstractTermsEngine

__all__ = ["MujocoEngine"]

_OLDEST = "3.3.3"  # before, mj_jacDot was wrong for a body with several hinges


class MujocoEngine(AbstractTermsEngine):
    """MuJoCo on the document that `write_mjcf` makes of the mechanism.

    Raises:
        VerificationError: MuJoCo is not installed, or older than 3.3.3.
        MechanismError: a mechanism that MuJoCo cannot have, such as a massless body in a loop.
    """

    name = "mujoco"

    def __init__(self, mechanism: Mechanism, values: Mapping[str, float], labels: tuple[str, ...]) -> None:
        super().__init__(mechanism, labels)
        self._mujoco = load("mujoco", "mujoco", _OLDEST)
        self.version = str(self._mujoco.__version__)
        self._model = self._mujoco.MjModel.from_xml_string(write_mjcf(mechanism, values))
        self._data = self._mujoco.MjData(self._model)
        joints = [self._model.joint(name) for name in mechanism.coordinates]
        self._q_at = np.array([joint.qposadr[0] for joint in joints])
        self._v_at = np.array([joint.dofadr[0] for joint in joints])
        self._sites = [
            (self._model.site(f"{loop.name}_a").id, self._model.site(f"{loop.name}_b").id) for loop in mechanism.loops
        ]

    def terms(self, q: FloatArray, q_dot: FloatArray) -> Terms:
        """M by columns (mj_mulM), h = qfrc_bias, A by mj_jac and c = J' q' by mj_jacDot at both points of each loop."""
        engine, model, data = self._mujoco, self._model, self._data
        data.qpos[self._q_at] = q
        data.qvel[self._v_at] = q_dot
        engine.mj_fwdPosition(model, data)
        engine.mj_fwdVelocity(model, data)
        size = model.nv
        M = np.zeros((size, size))
        for column, unit in zip(M, np.eye(size), strict=True):
            engine.mj_mulM(model, data, column, unit)
        A, c = np.zeros((3 * len(self._sites), size)), np.zeros(3 * len(self._sites))
        for loop, (site_a, site_b) in enumerate(self._sites):
            rows = slice(3 * loop, 3 * loop + 3)
            for site, sign in ((site_a, 1), (site_b, -1)):
                point, body = data.site_xpos[site], model.site_bodyid[site]
                jacobian, rate = np.zeros((3, size)), np.zeros((3, size))
                engine.mj_jac(model, data, jacobian, None, point, body)
                engine.mj_jacDot(model, data, rate, None, point, body)
                A[rows] += sign * jacobian
                c[rows] += sign * (rate @ data.qvel)
        at = self._v_at
        return M[np.ix_(at, at)], data.qfrc_bias[at].copy(), A[:, at], c
