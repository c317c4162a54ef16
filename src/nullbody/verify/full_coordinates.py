"""A second road inside: multipliers in all redundant coordinates, by differentiating poses in time exactly.

Nothing is symbolic and nothing is eliminated. Of the mechanism only the joints' poses are used: neither the
velocities that joints state, nor M, h, A, N, c or gamma of the derivation. Each body's pose along the curve
q(t) = q + q' t is a Taylor polynomial of second order in t, evaluated in exact rules (no differences):

    p(t) -> velocity p', acceleration p'';   R(t) -> [omega x] = R' R^T,  [omega' x] = R'' R^T + R' R'^T
    J, W: the same with q' = unit vectors
    M = sum m J^T J + W^T I W                                      I in the ground frame, about the centre
    h = sum m J^T (p'' - g) + W^T (I omega' + omega x I omega)     for q'' = 0
    A = dPhi/dt for unit vectors,  c = d^2 Phi/dt^2 for q'' = 0
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from nullbody.formats import frame, mass_properties, triple
from nullbody.mechanism import GROUND, Mechanism
from nullbody.typing import FloatArray
from nullbody.verify.engine import Terms
from nullbody.verify.kkt import AbstractTermsEngine

__all__ = ["MultiplierEngine", "Taylor", "cosine", "sine"]


class Taylor:
    """x(t) = value + first t + second t^2 / 2 for several curves through the same value at once.

    Attributes:
        value: x(0).
        first: x'(0), one entry for each curve.
        second: x''(0), one entry for each curve.
    """

    __array_ufunc__ = None  # numbers of NumPy leave the arithmetic to this class
    __slots__ = ("first", "second", "value")

    def __init__(self, value: float, first: Any = 0.0, second: Any = 0.0) -> None:
        self.value, self.first, self.second = value, first, second

    def __add__(self, other: Any) -> Taylor:
        o = _taylor(other)
        return Taylor(self.value + o.value, self.first + o.first, self.second + o.second)

    def __mul__(self, other: Any) -> Taylor:
        o = _taylor(other)
        second = self.second * o.value + 2 * self.first * o.first + self.value * o.second
        return Taylor(self.value * o.value, self.first * o.value + self.value * o.first, second)

    def __neg__(self) -> Taylor:
        return self * -1.0

    def __sub__(self, other: Any) -> Taylor:
        return self + -_taylor(other)

    def __rsub__(self, other: Any) -> Taylor:
        return _taylor(other) - self

    __radd__ = __add__
    __rmul__ = __mul__


def _taylor(value: Any) -> Taylor:
    return value if isinstance(value, Taylor) else Taylor(float(value))


def sine(x: Taylor) -> Taylor:
    """sin x: (sin x)'' = x'' cos x - x'^2 sin x"""
    s, c = np.sin(x.value), np.cos(x.value)
    return Taylor(s, c * x.first, c * x.second - s * x.first * x.first)


def cosine(x: Taylor) -> Taylor:
    """cos x: (cos x)'' = -x'' sin x - x'^2 cos x"""
    s, c = np.sin(x.value), np.cos(x.value)
    return Taylor(c, -s * x.first, -s * x.second - c * x.first * x.first)


class MultiplierEngine(AbstractTermsEngine):
    """Multipliers in full coordinates from the joints' poses alone; needs nothing installed."""

    name = "multipliers"
    version = ""

    def __init__(self, mechanism: Mechanism, values: Mapping[str, float], labels: tuple[str, ...]) -> None:
        super().__init__(mechanism, labels)
        self._mechanism, self._values = mechanism, dict(values)
        self._gravity = triple(mechanism.gravity, values)

    def terms(self, q: FloatArray, q_dot: FloatArray) -> Terms:
        """M, h, A, c at one state."""
        size = len(q)
        poses = self._poses(q, q_dot)
        M, h = np.zeros((size, size)), np.zeros(size)
        for body in self._mechanism.bodies:
            mass, centre, inertia = mass_properties(body, self._values)
            R, p = poses[body.name]
            rotation, first, second = _derivatives(R, size + 1)
            _, velocity, acceleration = _derivatives(p + R @ centre, size + 1)
            spin = _axial(first @ rotation.T)
            turn = _axial((second @ rotation.T + first @ first.transpose(0, 2, 1))[-1:])[0]
            J, W, omega = velocity[:size], spin[:size], spin[-1]
            inertia = rotation @ inertia @ rotation.T
            M += mass * J @ J.T + W @ inertia @ W.T
            h += mass * J @ (acceleration[-1] - self._gravity)
            h += W @ (inertia @ turn + np.cross(omega, inertia @ omega))
        A, c = [np.zeros((0, size))], [np.zeros(0)]
        for loop in self._mechanism.loops:
            (R_a, p_a), (R_b, p_b) = poses[loop.body_a], poses[loop.body_b]
            a, b = p_a + R_a @ triple(loop.point_a, self._values), p_b + R_b @ triple(loop.point_b, self._values)
            _, first, second = _derivatives(np.array(loop.closure(a, b), dtype=object), size + 1)
            A.append(first[:size].T)
            c.append(second[-1])
        return M, h, np.vstack(A), np.concatenate(c)

    def _poses(self, q: FloatArray, q_dot: FloatArray) -> dict[str, tuple[Any, Any]]:
        """(R, p) of all bodies as arrays of Taylor; curves: the unit vectors, then q'."""
        curves = np.vstack([np.eye(len(q)), q_dot])
        names = self._mechanism.coordinates
        along = {name: Taylor(float(q[i]), curves[:, i], np.zeros(len(curves))) for i, name in enumerate(names)}
        poses: dict[str, tuple[Any, Any]] = {GROUND: (np.eye(3), np.zeros(3))}
        for joint in self._mechanism.tree_order():
            R, p = poses[joint.parent]
            at = frame(joint.at, self._values)
            pose = joint.motion([along[name] for name in joint.coordinates], sine, cosine).pose
            held = R @ at.rotation
            position = p + R @ at.position + held @ np.array(pose.position, dtype=object)
            poses[joint.child] = (held @ np.array(pose.rotation, dtype=object), position)
        return poses


def _derivatives(array: Any, curves: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Values (shape of the array), first and second derivatives (one such array for each curve)."""
    flat = [_taylor(entry) for entry in np.ravel(array)]
    value = np.array([entry.value for entry in flat]).reshape(np.shape(array))
    first, second = (
        np.array([np.broadcast_to(derivative, curves) for derivative in column]).T.reshape(curves, *np.shape(array))
        for column in ([entry.first for entry in flat], [entry.second for entry in flat])
    )
    return value, first, second


def _axial(skew: FloatArray) -> FloatArray:
    """w with [w x] = skew, for a stack of matrices."""
    return (
        np.stack([skew[:, 2, 1] - skew[:, 1, 2], skew[:, 0, 2] - skew[:, 2, 0], skew[:, 1, 0] - skew[:, 0, 1]], 1) / 2
    )
