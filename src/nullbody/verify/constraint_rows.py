"""Rows of all constraints and terms of all loads, from a mechanism in motion.

Phi(q, t) = 0        A = dPhi/dq,    c = Phi''  for q'' = 0       loops, constraints, Euler parameters
r(q, q', t) = 0      A = dr/dq',     c = r'     for q'' = 0       rolling, blades, nonholonomic expressions
h_j = dU/dq_j - sum effort dflow/dq'_j + (dT/dq'_j)' - dT/dq_j,   M_ij = d^2T/dq'_i dq'_j
"""

from __future__ import annotations

from typing import Any

import numpy as np

from nullbody.typing import FloatArray
from nullbody.verify.taylor import Taylor
from nullbody.verify.taylor_motion import TaylorMotion

__all__ = ["constraint_rows", "load_terms"]


def constraint_rows(motion: TaylorMotion) -> tuple[FloatArray, FloatArray]:
    """A and c, in the order of `Mechanism.holonomic_rows` and `Mechanism.nonholonomic_rows`."""
    size = len(motion.variables.q)
    Phi, slips = _residuals(motion)
    A = [x.first[:size] for x in Phi] + [x.first[size : 2 * size] for x in slips]
    c = [x.second[-1] for x in Phi] + [x.first[-1] for x in slips]
    return np.array(A).reshape(len(A), size), np.array(c)


def _residuals(motion: TaylorMotion) -> tuple[list[Taylor], list[Taylor]]:
    """Phi, and the residuals in rates."""
    mechanism, Phi = motion.mechanism, []
    for loop in mechanism.loops:
        Phi += loop.closure(motion.frame(loop.parent, loop.at), motion.frame(loop.child, loop.on), motion.scalar)
    for constraint in mechanism.constraints:
        Phi += constraint.holonomic(motion)
    for joint in mechanism.joints:
        Phi += joint.own_closure([motion.coordinate(name) for name in joint.coordinates])
    slips = [slip for constraint in mechanism.constraints for slip in constraint.nonholonomic(motion)]
    return [_moving(x, motion) for x in Phi], [_moving(x, motion) for x in slips]


def load_terms(motion: TaylorMotion) -> tuple[FloatArray, FloatArray]:
    """What all loads add to M and h."""
    size = len(motion.variables.q)
    M, h = np.zeros((size, size)), np.zeros(size)
    for load in motion.mechanism.loads:
        h += _moving(load.potential(motion), motion).first[:size]
        for effort, flow in load.efforts(motion):
            h -= _moving(effort, motion).value * _moving(flow, motion).first[size : 2 * size]
        kinetic = load.kinetic(motion)
        if isinstance(kinetic, Taylor):
            h += kinetic.second[size : 2 * size] - kinetic.first[:size]
            for j, unit in enumerate(np.eye(size)):
                M[j] += _moving(load.kinetic(motion.with_rates(unit)), motion).first[size : 2 * size]
    return M, h


def _moving(value: Any, motion: TaylorMotion) -> Taylor:
    """A number that does not move as one with derivatives."""
    if isinstance(value, Taylor):
        return value
    none = np.zeros(motion.variables.directions)
    return Taylor(float(value), none, none)
