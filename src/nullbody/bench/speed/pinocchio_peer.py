"""Pinocchio as its users run it: constraintDynamics on prepared vectors, and DOP853 of SciPy around it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from nullbody.bench.speed.peer import Missing, Stopped
from nullbody.errors import VerificationError
from nullbody.formats import RigidFrame, loop_points
from nullbody.mechanism import Mechanism
from nullbody.typing import FloatArray
from nullbody.verify import PinocchioEngine

__all__ = ["PinocchioDirect", "pinocchio_direct"]

_MU, _ITERATIONS = 1e-10, 50  # proximal damping and iterations, as in `verify`


def pinocchio_direct(mechanism: Mechanism, values: Mapping[str, float], labels: tuple[str, ...]) -> PinocchioDirect:
    """Pinocchio's model of a mechanism whose loops hold points together.

    Raises:
        Missing: Pinocchio is not installed, or too old.
        Stopped: something else than points is held together.
    """
    try:
        made = PinocchioDirect(mechanism, values, labels)
    except VerificationError as error:
        raise Missing(str(error)) from None
    if made._contacts is None:
        raise Stopped("its closures hold points together only")
    return made


class PinocchioDirect(PinocchioEngine):
    """The engine with the way to its native calls as short as Python allows."""

    _frames: list[tuple[int, int]] | None = None

    def prepared(
        self, q: FloatArray, q_dot: FloatArray, u: FloatArray, accuracy: float = 1e-12
    ) -> Callable[[], FloatArray]:
        """A call of constraintDynamics at a state; vectors and settings are made beforehand.

        Args:
            q, q_dot, u: the state.
            accuracy: of the proximal iteration on the closures [m/s^2].
        """
        pin, E = self._pin, self._map.matrix(q)
        settings = pin.ProximalSettings(accuracy, _MU, _ITERATIONS)
        call, model, data = pin.constraintDynamics, self._model, self._data
        state = self._position(q), E @ q_dot, E @ (self._S @ u)
        contacts, contact_data = self._contacts, self._contact_data

        def run() -> FloatArray:
            found: FloatArray = call(model, data, *state, contacts, contact_data, settings)
            return found

        return run

    def inverse(self, q: FloatArray, q_dot: FloatArray, q_ddot: FloatArray) -> Callable[[], FloatArray]:
        """A call that gives the inputs for accelerations: rnea, Jacobians of the points, a dense solve of NumPy.

        S u - A^T lambda = M q'' + h
        """
        pin, E, inputs = self._pin, self._map.matrix(q), self._S.shape[1]
        model, pairs = self._model, self._pairs()
        data = model.createData()
        position, rate, acceleration = self._position(q), E @ q_dot, E @ q_ddot
        matrix = np.zeros((model.nv, inputs + 3 * len(pairs)))
        matrix[:, :inputs] = E @ self._S
        axes = pin.LOCAL_WORLD_ALIGNED

        def run() -> FloatArray:
            tau = pin.rnea(model, data, position, rate, acceleration)
            pin.computeJointJacobians(model, data, position)
            column = inputs
            for a, b in pairs:
                J = pin.getFrameJacobian(model, data, a, axes)[:3] - pin.getFrameJacobian(model, data, b, axes)[:3]
                matrix[:, column : column + 3] = -J.T
                column += 3
            found: FloatArray = np.linalg.solve(matrix, tau)[:inputs]
            return found

        return run

    def _pairs(self) -> list[tuple[int, int]]:
        """Frames of the model at the two points of each loop, made when they are first asked for."""
        if self._frames is None:
            pin, kind = self._pin, self._pin.FrameType.OP_FRAME
            self._frames = []
            for loop in self._mechanism.loops:
                sides = []
                for body, point in zip((loop.parent, loop.child), loop_points(loop, self._values), strict=True):
                    joint, place = self._holders[body]
                    at = self._se3(place @ RigidFrame(np.eye(3), point))
                    sides.append(int(self._model.addFrame(pin.Frame(f"{loop.name} {body}", joint, 0, at, kind))))
                self._frames.append((sides[0], sides[1]))
        return self._frames

    def accelerations(self, q: FloatArray, found: FloatArray) -> FloatArray:
        """What `prepared` returned in our order."""
        back: FloatArray = self._map.matrix(q).T @ np.array(found)
        return back

    def overhead(self) -> Callable[[], object]:
        """A call that does next to nothing: the part of a figure that is Python's."""
        pin, model = self._pin, self._model
        return lambda: pin.computeTotalMass(model)

    def motion(self, q: FloatArray, q_dot: FloatArray, t1: float, rtol: float) -> FloatArray:
        """q at t1 without inputs, by DOP853 in all coordinates; closures are not stabilised, they drift."""
        from scipy.integrate import solve_ivp

        pin, n = self._pin, len(q)
        call, model, data = pin.constraintDynamics, self._model, self._data
        contacts, contact_data = self._contacts, self._contact_data
        settings = pin.ProximalSettings(max(1e-3 * rtol, 1e-14), _MU, _ITERATIONS)
        at, none = self._q_at, np.zeros(n)

        def rates(_: float, y: FloatArray) -> FloatArray:
            return np.concatenate([y[n:], call(model, data, y[:n], y[n:], none, contacts, contact_data, settings)])

        start = np.concatenate([self._position(q), self._map.matrix(q) @ q_dot])
        found = solve_ivp(rates, (0.0, t1), start, "DOP853", rtol=rtol, atol=0.01 * rtol, t_eval=[t1])
        end: FloatArray = found.y[:n, -1][at]
        return end
