"""The first and second time derivatives of rotation matrices, in the form that costs least.

    R' = R [omega]x,   R'' = R ([omega]x [omega]x + [omega'_0]x),     omega'_0 = (d/dt W) q',   omega = W q'

An expression keeps the form in which it was first written. Written before anything is differentiated, these are what
velocities and accelerations of the closures consist of; derivatives of products of sines and cosines cost more.
"""

from __future__ import annotations

from nullbody.equations.motion import MotionExpressions
from nullbody.expr import directional
from nullbody.expr.matrix import add, matmul, skew

__all__ = ["write_turning"]


def write_turning(motion: MotionExpressions) -> None:
    """Write R' and R'' of all bodies that several coordinates turn."""
    zero, seeds = motion.scalar(0), {motion.q[name]: rate for name, rate in motion.rates.items()}
    for frame in motion.frames.values():
        columns = [(motion.rates[name], W) for name, (W, _) in frame.columns.items() if any(e != 0 for e in W)]
        if len(columns) < 2:
            continue
        omega = [zero + sum((rate * W[k] for rate, W in columns), 0) for k in range(3)]
        spin, change = skew(omega), skew(directional(omega, seeds))
        x, y, z = (w * w for w in omega)
        xy, yz, zx = omega[0] * omega[1], omega[1] * omega[2], omega[2] * omega[0]
        squared = [[-(y + z), xy, zx], [xy, -(x + z), yz], [zx, yz, -(x + y)]]
        matmul(frame.pose.rotation, spin)
        matmul(frame.pose.rotation, [add(a, b) for a, b in zip(squared, change, strict=True)])
