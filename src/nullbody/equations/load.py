"""Loads as generalized forces (theory 3).

h_j += dU/dq_j - sum_k effort_k dflow_k/dq'_j                springs; dampers, friction, wrenches
M_ij += d^2T/dq'_i dq'_j,   h_i += (d/dt dT/dq'_i)|q''=0 - dT/dq_i        kinetic energies of your own
power = sum_k effort_k flow_k                                of all that has no potential [W]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.equations.inertia import Inertia
from nullbody.equations.motion import MotionExpressions
from nullbody.errors import MechanismError
from nullbody.expr import Expr, derivative, directional, jacobian
from nullbody.expr.matrix import add, total
from nullbody.mechanism import AbstractLoad, Mechanism

__all__ = ["Loaded", "loaded"]


@dataclass(frozen=True)
class Loaded:
    """Inertia with the loads in it, and the power of those that have no potential [W]."""

    inertia: Inertia
    power: Expr


def loaded(mechanism: Mechanism, bodies: Inertia, motion: MotionExpressions) -> Loaded:
    """Add all loads to M, h, T and U.

    Raises:
        MechanismError: a kinetic energy that is not quadratic in the rates, a potential that depends on them.
    """
    zero = motion.scalar(0)
    q, rates = list(motion.q.values()), list(motion.rates.values())
    M, h = [[zero for _ in q] for _ in q], [zero for _ in q]
    T, U = bodies.T, bodies.U
    power: list[Expr] = []
    for load in mechanism.loads:
        potential = zero + load.potential(motion)
        _check_free_of(potential, rates, load, "potential energy depends on rates")
        U = U + potential
        for j, slope in enumerate(jacobian([potential], q)[0]):
            h[j] = h[j] + slope
        _add_kinetic(M, h, zero + load.kinetic(motion), motion, load)
        T = T + load.kinetic(motion)
        for effort, flow in _efforts(load, motion):
            effort, flow = zero + effort, zero + flow
            for j, rate in enumerate(rates):
                h[j] = h[j] - effort * derivative(flow, rate)
            power.append(effort * flow)
    whole_M, rest_M = ([add(*rows) for rows in zip(m, M, strict=True)] for m in (bodies.M, bodies.rest_M))
    whole_h, rest_h = add(bodies.h, h), add(bodies.rest_h, h)
    return Loaded(Inertia(whole_M, whole_h, T, U, rest_M, rest_h, bodies.spins), zero + total(power))


def _efforts(load: AbstractLoad, motion: MotionExpressions) -> Sequence[tuple[Expr, Expr]]:
    try:
        return list(load.efforts(motion))
    except ZeroDivisionError:
        raise MechanismError(
            f"the load {load.name!r} divides by what is zero in every configuration: do its two points coincide?"
        ) from None


def _add_kinetic(M: list[list[Any]], h: list[Any], T: Expr, motion: MotionExpressions, load: AbstractLoad) -> None:
    if T == 0:
        return
    q, rates = list(motion.q.values()), list(motion.rates.values())
    momenta = jacobian([T], rates)[0]
    added = jacobian(momenta, rates)
    for row in added:
        for entry in row:
            _check_free_of(entry, rates, load, "kinetic energy is not quadratic in the rates")
    changes = directional(momenta, {**dict(zip(q, rates, strict=True)), motion.time: motion.scalar(1)})
    slopes = jacobian([T], q)[0]
    for i in range(len(q)):
        h[i] = h[i] + changes[i] - slopes[i]
        for j in range(len(q)):
            M[i][j] = M[i][j] + added[i][j]


def _check_free_of(value: Expr, symbols: list[Expr], load: AbstractLoad, what: str) -> None:
    mask = 0
    for symbol in symbols:
        mask |= symbol.graph.depends[symbol.ref >> 1]
    if value.graph.depends[value.ref >> 1] & mask:
        raise MechanismError(f"the load {load.name!r} makes no sense: its {what}")
