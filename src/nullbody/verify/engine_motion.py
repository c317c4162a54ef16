"""What an engine's own Jacobians say about the motion of frames, as numbers with derivatives in our coordinates.

Engines have velocities nu of their own; those of Euler parameters are angular velocities in the joint's moving axes:

    nu = E q',   omega = 2 G(e) e' for a ball, the rate itself for slides and hinges;   E' q' = 2 G(e') e' = 0
    p' = J nu,   [omega x] = R' R^T with omega = W nu
    dp/dq = J E,         its rate J' E + J E'
    dR/dq_j = [w_j x] R with w = W E,    its rate [w_j' x] R + [w_j x] R'

M = E^T M_nu E and h = E^T h_nu, since q'' = 0 leaves nu' = 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from nullbody.formats import Step
from nullbody.typing import FloatArray
from nullbody.verify.taylor import Moving
from nullbody.verify.taylor_motion import BodyMotion

__all__ = ["FrameMotion", "VelocityMap", "body_motion", "point_motions"]


class VelocityMap:
    """nu = E(q) q' for one engine.

    Args:
        names: the mechanism's coordinates.
        places: every step of every joint with the place of its first velocity among those of the engine.
        size: number of velocities of the engine.
    """

    def __init__(self, names: Sequence[str], places: Sequence[tuple[Step, int]], size: int) -> None:
        self._shape = size, len(names)
        index = {name: column for column, name in enumerate(names)}
        self._simple = [(at, index[step.coordinate]) for step, at in places if step.kind != "ball"]
        self._balls = [(at, [index[name] for name in step.coordinates]) for step, at in places if step.kind == "ball"]

    def matrix(self, q: FloatArray) -> FloatArray:
        """E at q."""
        return self._linear(q, 1.0)

    def rate(self, q_dot: FloatArray) -> FloatArray:
        """E' along q', which is linear in Euler parameters."""
        return self._linear(q_dot, 0.0)

    def _linear(self, q: FloatArray, one: float) -> FloatArray:
        E = np.zeros(self._shape)
        for row, column in self._simple:
            E[row, column] = one
        for row, columns in self._balls:
            e0, e1, e2, e3 = q[columns]
            E[row : row + 3, columns] = [
                [-2 * e1, 2 * e0, 2 * e3, -2 * e2],
                [-2 * e2, -2 * e3, 2 * e0, 2 * e1],
                [-2 * e3, 2 * e2, -2 * e1, 2 * e0],
            ]
        return E


class FrameMotion(NamedTuple):
    """A frame of an engine: its pose, the Jacobians of its origin and its rotation, and their rates (3 x size)."""

    rotation: FloatArray
    position: FloatArray
    J: FloatArray
    W: FloatArray
    J_rate: FloatArray
    W_rate: FloatArray

    @staticmethod
    def fixed(size: int) -> FrameMotion:
        """The ground."""
        none = np.zeros((3, size))
        return FrameMotion(np.eye(3), np.zeros(3), none, none, none, none)


def point_motions(frames: Sequence[FrameMotion], local: FloatArray, nu: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Jacobians J - [r x] W of points, r = R local, and their accelerations where nu' = 0; one frame for each point."""
    R, _, J, W, J_rate, W_rate = (np.array(part) for part in zip(*frames, strict=True))
    r = (R @ local[:, :, None])[:, :, 0]
    omega = W @ nu
    products = (omega * r).sum(1, keepdims=True), (omega * omega).sum(1, keepdims=True)
    centripetal = omega * products[0] - r * products[1]
    turning = _across((W_rate @ nu)[:, :, None], r)[:, :, 0]
    return J + _across(W, r), J_rate @ nu + turning + centripetal


def body_motion(frame: FrameMotion, E: FloatArray, E_rate: FloatArray, q_dot: FloatArray) -> BodyMotion:
    """The frame with derivatives along coordinates, rates (none) and the motion."""
    R = frame.rotation
    J, J_rate = frame.J @ E, frame.J_rate @ E + frame.J @ E_rate
    W, W_rate = frame.W @ E, frame.W_rate @ E + frame.W @ E_rate
    spin = _skew(W @ q_dot)
    turned, turned_rate = _skew(W.T) @ R, _skew(W_rate.T) @ R + _skew(W.T) @ (spin @ R)
    position = Moving(frame.position, *(_directions(columns.T, q_dot) for columns in (J, J_rate)))
    return BodyMotion(Moving(R, *(_directions(columns, q_dot) for columns in (turned, turned_rate))), position)


def _directions(columns: FloatArray, q_dot: FloatArray) -> FloatArray:
    """One array for each coordinate, zeros for each rate, and their combination by q' for the motion."""
    return np.concatenate([columns, np.zeros_like(columns), np.tensordot(q_dot, columns, 1)[None]])


def _across(w: FloatArray, r: FloatArray) -> FloatArray:
    """w x r of the columns of a stack of matrices w, with one r for each matrix."""
    x, y, z = (r[:, k, None] for k in range(3))
    return np.stack([w[:, 1] * z - w[:, 2] * y, w[:, 2] * x - w[:, 0] * z, w[:, 0] * y - w[:, 1] * x], 1)


def _skew(w: FloatArray) -> FloatArray:
    """[w x], or one for each of a stack of vectors."""
    found = np.zeros((*w.shape, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        found[..., k, j], found[..., j, k] = w[..., i], -w[..., i]
    return found
