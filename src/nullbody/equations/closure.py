"""The constraints and what follows from them by differentiation (theory 2, [26]).

Phi(q, t) = 0                    loops, couplings, drivers, Euler parameters: holonomic
r = A q' + b = 0                 A = dPhi/dq, b = dPhi/dt; rows of rolling contacts are r(q, q', t) themselves
A q'' + c = 0                    c = dr/dt with q'' = 0
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from nullbody.equations.motion import MotionExpressions
from nullbody.errors import MechanismError
from nullbody.expr import Expr, directional, jacobian, substitute
from nullbody.mechanism import Mechanism

__all__ = ["Closures", "closures"]


@dataclass(frozen=True)
class Closures:
    """Phi = 0, A q' + b = 0, A q'' + c = 0.

    Attributes:
        labels: where each row comes from, e.g. "leg1 x"; the first len(Phi) rows are those of Phi.
        Phi: residuals of the holonomic equations.
        A: all rows, nc x nq.
        b: nc; zero without drivers.
        c: nc.
        facing: cosines that are positive where loops are closed the right way round, with the loops' names.
        holonomic: whether every row is one of Phi.
    """

    labels: tuple[str, ...]
    Phi: list[Expr]
    A: list[list[Expr]]
    b: list[Expr]
    c: list[Expr]
    facing: tuple[tuple[str, Expr], ...]
    holonomic: bool

    def kept(self, rows: Sequence[int]) -> Closures:
        """Some rows, each one with its entries of Phi, A, b and c; Phi is 0 where a row is nonholonomic."""
        return replace(
            self,
            labels=tuple(self.labels[i] for i in rows),
            Phi=[self.Phi[i] if i < len(self.Phi) else 0 * self.c[i] for i in rows],
            A=[self.A[i] for i in rows],
            b=[self.b[i] for i in rows],
            c=[self.c[i] for i in rows],
            holonomic=all(i < len(self.Phi) for i in rows),
        )


def closures(mechanism: Mechanism, motion: MotionExpressions) -> Closures:
    """All constraints of a mechanism.

    Raises:
        MechanismError: a nonholonomic equation is not linear in the rates.
    """
    zero = motion.scalar(0)
    Phi, facing = _holonomic(mechanism, motion)
    q, rates = list(motion.q.values()), list(motion.rates.values())
    one = zero + 1
    along = {**dict(zip(q, rates, strict=True)), motion.time: one}
    rows = directional(Phi, along)
    c = directional(rows, along)
    A = jacobian(Phi, q) if Phi else []
    b = directional(Phi, {motion.time: one})
    slips = [zero + slip for c in mechanism.constraints for slip in c.nonholonomic(motion)]
    slip_A = jacobian(slips, rates) if slips else []
    _check_linear(mechanism, slip_A, rates)
    _check_moving(mechanism, slips, slip_A)
    slip_b = substitute(slips, dict.fromkeys(rates, zero))
    return Closures(
        labels=tuple(label for label, _ in (*mechanism.holonomic_rows, *mechanism.nonholonomic_rows)),
        Phi=Phi,
        A=[*A, *slip_A],
        b=[*b, *slip_b],
        c=[*c, *directional(slips, along)],
        facing=facing,
        holonomic=not slips,
    )


def _holonomic(mechanism: Mechanism, motion: MotionExpressions) -> tuple[list[Expr], tuple[tuple[str, Expr], ...]]:
    """Phi and the facing cosines, in the order of `Mechanism.holonomic_rows`."""
    zero = motion.scalar(0)
    Phi: list[Expr] = []
    facing: list[tuple[str, Expr]] = []
    for loop in mechanism.loops:
        a, b = motion.frame(loop.parent, loop.at), motion.frame(loop.child, loop.on)
        Phi += [zero + residual for residual in loop.closure(a, b, motion.scalar)]
        facing += [(loop.name, zero + cosine) for cosine in loop.facing(a, b)]
    for constraint in mechanism.constraints:
        Phi += [zero + residual for residual in constraint.holonomic(motion)]
    for joint in mechanism.joints:
        Phi += [zero + residual for residual in joint.own_closure([motion.q[name] for name in joint.coordinates])]
    return Phi, tuple(facing)


def _check_moving(mechanism: Mechanism, slips: Sequence[Expr], slip_A: Sequence[Sequence[Expr]]) -> None:
    for (label, _), slip, row in zip(mechanism.nonholonomic_rows, slips, slip_A, strict=True):
        if slip != 0 and all(entry == 0 for entry in row):
            raise MechanismError(
                f"the nonholonomic constraint {label!r} has no rate in it, so it keeps no motion from anything. "
                "An equation in coordinates and the time is a holonomic one"
            )


def _check_linear(mechanism: Mechanism, slip_A: Sequence[Sequence[Expr]], rates: Sequence[Expr]) -> None:
    mask = 0
    for rate in rates:
        mask |= rate.graph.depends[rate.ref >> 1]
    for (label, _), row in zip(mechanism.nonholonomic_rows, slip_A, strict=True):
        if any(entry.graph.depends[entry.ref >> 1] & mask for entry in row):
            raise MechanismError(
                f"the constraint {label!r} is not linear in the rates: only equations a(q, t) . q' + b(q, t) = 0 can "
                "be fulfilled by forces that do no work"
            )
