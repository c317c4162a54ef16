"""MuJoCo as its users run it: its own model with soft closures, mj_forward and mj_step, from Python and natively."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from nullbody.bench.speed.peer import Missing
from nullbody.bench.timing import native_function
from nullbody.errors import VerificationError
from nullbody.formats import write_mjcf
from nullbody.mechanism import Mechanism
from nullbody.typing import FloatArray
from nullbody.verify.engine import load

__all__ = ["MujocoSoft"]

_OLDEST = "3.3.3"
_STIFF = (2.0, 1.0), (0.9999, 0.9999, 0.001, 0.5, 2.0)  # time constant in steps, damping ratio; impedance


class MujocoSoft:
    """A mechanism as MuJoCo's own model, written by `write_mjcf`. Closures are soft: it has no other.

    Args:
        mechanism: what it is of; MuJoCo has its own words for all of it.
        values: parameters that differ from the mechanism's own.

    Raises:
        Missing: MuJoCo is not installed, or too old.
        MechanismError: MuJoCo has no word for a part of the mechanism.
    """

    def __init__(self, mechanism: Mechanism, values: Mapping[str, float] | None = None) -> None:
        try:
            self._mujoco: Any = load("mujoco", "mujoco", _OLDEST)
        except VerificationError as error:
            raise Missing(str(error)) from None
        self.version = str(self._mujoco.__version__)
        self.model = self._mujoco.MjModel.from_xml_string(write_mjcf(mechanism, values))
        self._q_at = [int(self.model.joint(name).qposadr[0]) for name in mechanism.coordinates]
        self._u_at = [int(self.model.actuator(name).id) for name in mechanism.inputs]

    def data(self, q: FloatArray, q_dot: FloatArray, u: FloatArray) -> Any:
        """A state with inputs; every state has memory of its own."""
        data = self._mujoco.MjData(self.model)
        data.qpos[self._q_at], data.qvel[self._q_at] = q, q_dot
        data.ctrl[self._u_at] = u
        return data

    def accelerations(self, data: Any) -> FloatArray:
        """q'' by mj_forward, in our order."""
        self._mujoco.mj_forward(self.model, data)
        return np.array(data.qacc[self._q_at])

    def coordinates(self, data: Any) -> FloatArray:
        """q, in our order."""
        return np.array(data.qpos[self._q_at])

    def inverse(self, data: Any, q_ddot: FloatArray) -> Callable[[], FloatArray]:
        """A call that gives the inputs for accelerations: mj_rne, the closures' Jacobian, a dense solve of NumPy.

        S u - A^T lambda = M q'' + h; exact, for softness does not enter.
        """
        engine, model = self._mujoco, self.model
        tau, acceleration, inputs = np.zeros(model.nv), np.zeros(model.nv), len(self._u_at)
        acceleration[self._q_at] = q_ddot
        matrix = np.zeros((model.nv, model.nv))
        matrix[model.actuator_trnid[self._u_at, 0], range(inputs)] = 1

        def run() -> FloatArray:
            engine.mj_fwdPosition(model, data)
            engine.mj_fwdVelocity(model, data)
            data.qacc[:] = acceleration
            engine.mj_rne(model, data, 1, tau)
            matrix[:, inputs:] = -data.efc_J.reshape(-1, model.nv).T
            found: FloatArray = np.linalg.solve(matrix, tau)[:inputs]
            return found

        return run

    def forward(self, data: Any) -> None:
        """mj_forward from Python."""
        self._mujoco.mj_forward(self.model, data)

    def native_forward(self, data: Any) -> Callable[[int], None]:
        """mj_forward called a number of times by a native loop, without Python between the calls."""
        folder = Path(str(import_module("mujoco").__file__)).parent
        (file, *_) = sorted(path for path in folder.iterdir() if path.name.startswith(("libmujoco.", "mujoco.dll")))
        library = ctypes.CDLL(str(file))
        address = ctypes.cast(library.mj_forward, ctypes.c_void_p).value
        return native_function(address or 0, self.model._address, data._address, (library, self.model, data))

    def timestep(self, seconds: float, integrator: str, stiff: bool) -> None:
        """Set how `advance` goes.

        Args:
            seconds: of a step.
            integrator: of MuJoCo: "RK4", "implicitfast", ...
            stiff: closures as stiff as the step allows (time constant of two steps, impedance 0.9999), not as exported.
        """
        self.model.opt.timestep = seconds
        self.model.opt.integrator = int(getattr(self._mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}"))
        if stiff:
            (constant, damping), impedance = _STIFF
            self.model.eq_solref[:] = constant * seconds, damping
            self.model.eq_solimp[:] = impedance

    def advance(self, data: Any, steps: int) -> None:
        """mj_step, a number of times in one call. A motion that blows up is no news here: nothing is logged."""
        self._mujoco.set_mju_user_warning(lambda message: None)
        try:
            self._mujoco.mj_step(self.model, data, nstep=steps)
        finally:
            self._mujoco.set_mju_user_warning(None)
