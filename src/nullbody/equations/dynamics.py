"""Forward and inverse dynamics in independent velocities, written in the rates w of a basis of coordinates.

    q'  = N w + beta,   v = P w + beta_v      with N, beta of the basis;  P: the rows v of N,  w = P^-1 (v - beta_v)
    q'' = N w' + gamma                        gamma = [-B^-1 c; 0] of the basis
    Mr w' + hr = Br u                         Mr = N^T M N,  hr = N^T (h + M gamma),  Br u = N^T Q
    u:   Br u = Qr_w = N^T (M q'' + h),       Qr = P^-T Qr_w    for given v', w' = P^-1 (v' - gamma_v)
    |B_v| = +-|B| |P|,   |N_v|^2 <= |N|^2 (1 + |P^-1|^2)  (Frobenius; |N| itself counts: gamma loses as much of q'')

The basis may be v itself: then P = 1. Another one can be much cheaper: a platform's coordinates against the lengths of
its legs, where N follows leg by leg and only P, nv x nv, couples them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from nullbody.equations.closure import Closures
from nullbody.equations.equations import Routine
from nullbody.equations.inertia import Spin
from nullbody.equations.load import Loaded
from nullbody.equations.reduction import (
    Reduced,
    acceleration,
    forward,
    gross,
    input_matrix,
    inverse,
    reduce,
    required_inputs,
    solve_symmetric,
)
from nullbody.equations.sizes import Sizes
from nullbody.equations.symbols import Symbols
from nullbody.expr import Expr, LinearForm, directional, substitute
from nullbody.expr.matrix import add, dot, matmul, matvec, scale, total
from nullbody.nullspace import SymbolicNullSpace
from nullbody.nullspace.elimination import Elimination, eliminate
from nullbody.nullspace.plan import Plan
from nullbody.nullspace.steps import sparse_rows

__all__ = ["Dynamics"]

#: The largest P solved by minors, larger ones by pivots, which may vanish where P is regular. `doubt` sees that.
_SMALL = 3


@dataclass(frozen=True, eq=False)
class Dynamics:
    """The equations of motion of a mechanism, reduced with the null space of a basis.

    Attributes:
        loads: M, h and the power of the loads.
        kept: the rows of A that the null space is of.
        space: the null space, its independent columns the basis.
        symbols: of q, v and so on.
        sizes: absolute values of expressions at points that matter: where P's pivots must not be small.
        witness: |B_v| at the random point where the graph compares values; tells the sign of |B| |P|.
    """

    loads: Loaded
    kept: Closures
    space: SymbolicNullSpace
    symbols: Symbols
    sizes: Sizes | None = None
    witness: int | None = None

    @cached_property
    def driven(self) -> bool:
        """Whether A q' + b = 0 has a b."""
        return any(entry != 0 for entry in self.kept.b)

    @cached_property
    def c(self) -> list[Expr]:
        """c of A q'' + c = 0 in (q, q'), of the simplified rows where nothing is driven: B^-1 c is the same for both.

        The closures are simplified like the rows, by the same constant row operations, and differentiated twice; where
        rows are nonholonomic, the simplified rows are.
        """
        if self.driven:
            return self.kept.c
        symbols = self.symbols
        along = dict(zip(symbols.q, symbols.rates, strict=True))
        if self.kept.holonomic:
            forms = self.space.simplify([LinearForm.of(symbols.zero + gap) for gap in self.kept.Phi])
            velocities = directional([form.expression() for form in forms], along)
        else:
            velocities = [symbols.zero + rate for rate in matvec(self.space.simplified, symbols.rates)]
        return directional(velocities, along)

    def offset(self, c: list[Expr]) -> Sequence[Any]:
        """gamma of c in the form in which it is kept here."""
        return self.space.offset(c, of_simplified=not self.driven)

    @cached_property
    def beta(self) -> Sequence[Any]:
        """q' = N w + beta."""
        return self.space.offset(self.kept.b)

    @cached_property
    def transfer(self) -> Elimination | None:
        """The factors of P; None where the basis is v. Its determinant is 0 where v cannot be found from w."""
        places = self.symbols.places(self.symbols.independent)
        if places == list(self.space.independent):
            return None
        plan = Plan(largest=_SMALL, simplify=False, offsets=True, sizes=self.sizes)
        return eliminate(sparse_rows([self.space.reduced[k] for k in places]), plan=plan)

    def in_basis(self, v: Sequence[Any], offset: Sequence[Any]) -> list[Any]:
        """w of v = P w + offset_v."""
        if self.transfer is None:
            return list(v)
        places = self.symbols.places(self.symbols.independent)
        return self.transfer.solve([total((e, -offset[k])) for e, k in zip(v, places, strict=True)])

    @cached_property
    def q_dot(self) -> list[Expr]:
        """q' = N w + beta, v where it is given."""
        symbols = self.symbols
        found = add(matvec(self.space.reduced, self.in_basis(symbols.v, self.beta)), self.beta)
        for k, rate in zip(symbols.places(symbols.independent), symbols.v, strict=True):
            found[k] = rate
        return [symbols.zero + rate for rate in found]

    def onto(self, expressions: list[Expr]) -> list[Expr]:
        """Expressions in q' with q'(v) put in."""
        free = self.symbols.places(self.symbols.independent)
        pairs = zip(self.symbols.rates, self.q_dot, strict=True)
        rates = {rate: q_dot for k, (rate, q_dot) in enumerate(pairs) if k not in free}
        return substitute(expressions, rates)

    @cached_property
    def h(self) -> list[Expr]:
        """h in (q, v), without what `spins` adds."""
        return self.onto(self.loads.inertia.rest_h)

    @cached_property
    def gamma(self) -> Sequence[Any]:
        """gamma in (q, v)."""
        return self.offset(self.onto(self.c))

    def multipliers(self, h: Sequence[Any], q_ddot: Sequence[Any]) -> list[Any]:
        """lambda with A^T lambda = Q - M q'' - h."""
        moved = add(matvec(self.loads.inertia.M, q_ddot), h)
        return list(self.space.multipliers(add(self.symbols.Q, scale(-1, moved))))

    @cached_property
    def check(self) -> dict[str, Any]:
        """delta, and what tells how much of N is rounding."""
        spread = total(e * e for row in self.space.reduced for e in row if isinstance(e, Expr))
        delta, doubt = self.space.delta, self.space.doubt
        if self.transfer is None:
            return {"delta": delta, "spread": spread, "doubt": doubt}
        P, n = self.transfer, len(self.symbols.v)
        units = [[int(i == k) for i in range(n)] for k in range(n)]
        if P.eliminated:
            size = total(e * e for unit in units for e in P.solve(unit))
        else:
            inverse = 1 / (self.symbols.zero + P.delta)
            size = total(e * e for unit in units for e in P.solve_scaled(unit)) * (inverse * inverse)
        delta = self.symbols.zero + delta * P.delta
        return {
            "delta": delta if delta.graph.value(delta.ref) == self.witness else -delta,
            "spread": total((spread, (n + spread) * size)),
            "doubt": total((doubt, P.doubt)),
        }

    def routines(self) -> dict[str, Routine]:
        """forward_dynamics and inverse_dynamics.

        Raises:
            MechanismError: a motion moves no mass in any configuration.
        """
        return {"forward_dynamics": self._forward(), "inverse_dynamics": self._inverse()}

    @cached_property
    def spins(self) -> list[tuple[Spin, list[list[Any]], list[Any]]]:
        """Bodies that turn in space, with W N and their torques in (q, v)."""
        zero = self.symbols.zero
        spins = self.loads.inertia.spins
        return [(s, matmul(s.W, self.space.reduced), self.onto([zero + e for e in s.torque])) for s in spins]

    @cached_property
    def reduced(self) -> Reduced:
        """Mr and hr."""
        bodies = self.loads.inertia
        found = reduce(bodies.rest_M, self.h, self.space.reduced, self.gamma)
        for spin, WN, torque in self.spins:
            found = found.plus(reduce(spin.I_C, torque, WN, matvec(spin.W, self.gamma)))
        return found

    def forces(self, q_ddot: Sequence[Any]) -> list[Any]:
        """Qr = N^T (M q'' + h)"""
        bodies = self.loads.inertia
        Qr = inverse(bodies.rest_M, self.h, self.space.reduced, q_ddot)
        for spin, WN, torque in self.spins:
            Qr = add(Qr, inverse(spin.I_C, torque, WN, matvec(spin.W, q_ddot)))
        return Qr

    def _forward(self) -> Routine:
        symbols, N, M = self.symbols, self.space.reduced, self.loads.inertia.M
        w_dot, loss = forward(self.reduced, input_matrix(N, symbols.input_columns), symbols.u, gross(M, N))
        q_ddot = acceleration(N, w_dot, self.gamma)
        power = [self.onto([self.loads.power])[0], dot(symbols.Q, self.q_dot)]
        if self.driven:  # the constraint forces -A^T lambda do the work lambda . b at the drives
            power.append(dot(self.multipliers(self.onto(self.loads.inertia.h), q_ddot), self.kept.b))
        outputs = {"q_ddot": q_ddot, "q_dot": self.q_dot, **self.check, "loss": loss}
        return Routine(("q", "v", "u"), {**outputs, "power": symbols.zero + total(power)})

    def _inverse(self) -> Routine:
        symbols, N, M = self.symbols, self.space.reduced, self.loads.inertia.M
        w_dot = self.in_basis(symbols.group("v_dot"), self.gamma)
        Qr = self.forces(acceleration(N, w_dot, self.gamma))
        Br = input_matrix(N, symbols.input_columns)
        Mr = self.reduced.Mr
        if self.transfer is None:
            pivots = [1 / Mr[j][j] for j in range(len(Mr))]
        else:  # Qr = P^-T Mr P^-1 v' + ...: digits are lost where Mr in the rates of the basis is nearly singular
            _, pivots = solve_symmetric(Mr, [0] * len(Mr))
        loss = dot(gross(M, N), pivots)
        measures = self.check
        found = self._along_v(Qr, Br)  # written before u, which divides by |Br|: forms that are in use by then stay
        u = required_inputs(Br, Qr)
        return Routine(("q", "v", "v_dot"), {"Qr": found[0], "u": u, "Br": found[1], **measures, "loss": loss})

    def _along_v(self, Qr: list[Any], Br: list[list[Any]]) -> tuple[list[Any], list[list[Any]]]:
        """P^-T Qr and P^-T Br."""
        if self.transfer is None:
            return Qr, Br
        columns = [self.transfer.solve_transposed([row[k] for row in Br]) for k in range(len(self.symbols.u))]
        return self.transfer.solve_transposed(Qr), [[column[i] for column in columns] for i in range(len(Qr))]
