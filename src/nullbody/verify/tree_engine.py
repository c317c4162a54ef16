"""An engine that knows the tree: M and h in its own velocities, and the Jacobians of body frames.

Rows of constraints and forces of loads are the mechanism's residuals and efforts on the engine's poses, Jacobians and
their rates. M = E^T M_nu E and h = E^T h_nu in our coordinates, since q'' = 0 leaves nu' = E' q' = 0.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping

import numpy as np

from nullbody.formats import loop_points
from nullbody.mechanism import GROUND, Mechanism
from nullbody.typing import FloatArray
from nullbody.verify.constraint_rows import constraint_rows, load_terms
from nullbody.verify.engine import Terms, only_points
from nullbody.verify.engine_motion import FrameMotion, VelocityMap, body_motion, point_motions
from nullbody.verify.kkt import AbstractTermsEngine
from nullbody.verify.taylor_motion import TaylorMotion, Variables

__all__ = ["AbstractTreeEngine"]


class AbstractTreeEngine(AbstractTermsEngine):
    """M, h, A, c from an engine's tree. A subclass sets `_map` when it has built it."""

    _map: VelocityMap

    def __init__(self, mechanism: Mechanism, values: Mapping[str, float], labels: tuple[str, ...]) -> None:
        super().__init__(mechanism, values, labels)
        self._mechanism, self._values = mechanism, dict(values)
        self._only_points = only_points(mechanism)
        self._sides = [body for loop in mechanism.loops for body in (loop.parent, loop.child)]
        asked = self._sides if self._only_points else [body.name for body in mechanism.bodies]
        self._asked = sorted(set(asked) - {GROUND})
        self._local = np.zeros((0, 3))
        if self._only_points and mechanism.loops:
            self._local = np.vstack([loop_points(loop, values) for loop in mechanism.loops])

    @abstractmethod
    def _tree_terms(self, q: FloatArray, nu: FloatArray) -> tuple[FloatArray, FloatArray]:
        """M and h in the engine's velocities; leaves the engine's data ready for `_frame`."""

    @abstractmethod
    def _frame(self, body: str, nu: FloatArray) -> FrameMotion:
        """The frame of a body and its Jacobians."""

    def terms(self, q: FloatArray, q_dot: FloatArray, t: float = 0.0) -> Terms:
        """M, h, A, c at one state."""
        E, E_rate = self._map.matrix(q), self._map.rate(q_dot)
        nu = E @ q_dot
        M, h = self._tree_terms(q, nu)
        M, h = E.T @ M @ E, E.T @ h
        frames = {body: self._frame(body, nu) for body in self._asked}
        if self._only_points:
            A, c = self._point_rows(frames, nu)
            return M, h, A @ E, c
        bodies = {body: body_motion(found, E, E_rate, q_dot) for body, found in frames.items()}
        variables = Variables.at(self._mechanism.coordinates, q, q_dot, t)
        motion = TaylorMotion(self._mechanism, self._values, variables, bodies)
        added_M, added_h = load_terms(motion)
        return M + added_M, h + added_h, *constraint_rows(motion)

    def _point_rows(self, frames: Mapping[str, FrameMotion], nu: FloatArray) -> tuple[FloatArray, FloatArray]:
        """A = J_a - J_b and c = p_a'' - p_b'' of points that are held together: `Spherical` for all loops at once."""
        if not self._sides:
            return np.zeros((0, len(nu))), np.zeros(0)
        held = {GROUND: FrameMotion.fixed(len(nu)), **frames}
        J, bias = point_motions([held[body] for body in self._sides], self._local, nu)
        return (J[::2] - J[1::2]).reshape(-1, len(nu)), (bias[::2] - bias[1::2]).ravel()
