"""Loop closures Phi(q) = 0 and what follows from them by differentiation (theory 2, [26])."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from nullbody.equations.frame import Frame
from nullbody.equations.scalar import ParameterScalars
from nullbody.expr import Expr, directional, jacobian
from nullbody.expr.matrix import matvec
from nullbody.mechanism import Mechanism

__all__ = ["Closures", "closures"]


@dataclass(frozen=True)
class Closures:
    """Phi = 0, A q' = 0, A q'' + c = 0.

    Attributes:
        labels: loop and direction of each equation, e.g. "leg1 x".
        Phi: residuals [m], nc.
        A: Jacobian dPhi/dq, nc x nq.
        c: A' q' [m/s^2], nc.
    """

    labels: tuple[str, ...]
    Phi: list[Expr]
    A: list[list[Expr]]
    c: list[Expr]


def closures(
    mechanism: Mechanism,
    found: Mapping[str, Frame],
    scalars: ParameterScalars,
    q: list[Expr],
    rates: list[Expr],
) -> Closures:
    """The closures of all loops, with c_i = sum_jk (d^2 Phi_i / dq_j dq_k) q'_j q'_k."""
    labels: list[str] = []
    Phi: list[Expr] = []
    for loop in mechanism.loops:
        point_a = found[loop.body_a].point(scalars.triple(loop.point_a))
        point_b = found[loop.body_b].point(scalars.triple(loop.point_b))
        zero = scalars(0)
        Phi += [zero + residual for residual in loop.closure(point_a, point_b)]
        labels += [f"{loop.name} {row}" for row in loop.rows]
    A = jacobian(Phi, q)
    Phi_dot = [scalars(0) + term for term in matvec(A, rates)]
    c = directional(Phi_dot, dict(zip(q, rates, strict=True)))
    return Closures(tuple(labels), Phi, A, c)
