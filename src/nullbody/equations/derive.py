"""derive: Mechanism -> Equations, step by step as in theory 1 to 3.

frames [20-25] -> Phi, A, b, c [26, 6, 7] -> M, h, T, U [27-35] and loads -> rows and independent coordinates
-> N, delta [9-13] -> beta, gamma [40, 41] -> Mr, hr, Br [39, 42] -> routines [42-46]
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from nullbody.equations.choice import Choice, choose, dependent
from nullbody.equations.closure import Closures, closures
from nullbody.equations.equations import Equations, Routine
from nullbody.equations.inertia import inertia
from nullbody.equations.load import Loaded, loaded
from nullbody.equations.manifold import Manifold
from nullbody.equations.motion import MotionExpressions
from nullbody.equations.reduction import acceleration, forward, gross, input_matrix, inverse, reduce, required_inputs
from nullbody.equations.sizes import Sizes, sizes_at
from nullbody.errors import InputError, SingularityError
from nullbody.expr import Expr, Graph, directional, substitute
from nullbody.expr.matrix import add, dot, matvec, scale, total
from nullbody.mechanism import Mechanism
from nullbody.nullspace import SymbolicNullSpace, echelon
from nullbody.nullspace.call import symbolic_null_space
from nullbody.nullspace.given import Given
from nullbody.nullspace.plan import Plan
from nullbody.nullspace.steps import sparse_rows

__all__ = ["derive"]


def derive(
    mechanism: Mechanism, independent: Sequence[str] | None = None, *, rows: Sequence[str] | None = None
) -> Equations:
    """The equations of motion of a mechanism, closed form, without multipliers.

    Args:
        mechanism: any mechanism of rigid bodies with loops.
        independent: names of the coordinates whose rates are v, nq - rank A of them; the actuated ones by
            default where they are as many and regular, otherwise those for which |B| is large at the home.
        rows: labels of the rows of A to keep, rank A of them; chosen by default.

    Raises:
        UnknownName: a name is no coordinate, a label no row.
        InputError: too few or too many names.
        ParameterError: a body is not physical.
        MechanismError: a degree of freedom moves no mass, or a constraint or load makes no sense.
        SingularityError: |B| is identically zero for this choice; the message names one that would do.
    """
    if not isinstance(mechanism, Mechanism):
        raise InputError(f"derive takes a Mechanism, such as nullbody.catalog.three_prs(), not {mechanism!r}")
    values = mechanism.values()
    graph = Graph()
    motion = MotionExpressions.of(mechanism, graph)
    names, q = mechanism.coordinates, motion.q
    loops = closures(mechanism, motion)
    loads = loaded(mechanism, inertia(mechanism, motion.frames, motion.scalar, q, motion.rates), motion)
    home = mechanism.home_values(values)
    manifold = Manifold(loops, (list(q.values()), motion.time), values, home)
    chart = choose(mechanism, loops, manifold, independent, rows)
    symbols = _Symbols(graph, mechanism, chart.independent)
    kept = loops.kept(chart.rows)
    sizes = sizes_at(names, [sample.q for sample in manifold.samples], values)
    space = _null_space(kept.A, names, chart.independent, sizes)
    reduction = _Reduction(loads, kept, space, symbols)
    outputs = {"Phi": [loops.Phi[i] for i in chart.closures], **reduction.outputs()}
    routines = {**_closure_routines(loops, kept, chart), **reduction.routines()}
    graph.verify()
    return Equations(
        mechanism=mechanism,
        graph=graph,
        coordinates=names,
        independent=chart.independent,
        labels=tuple(loops.labels[i] for i in chart.rows),
        closure_labels=tuple(loops.labels[i] for i in chart.closures),
        redundant=tuple(label for i, label in enumerate(loops.labels) if i not in chart.rows),
        facing=tuple(loop for loop, _ in loops.facing),
        mobility=chart.mobility,
        outputs={name: _expressions(output, symbols.zero) for name, output in outputs.items()},
        routines={
            name: Routine(r.inputs, {key: _expressions(value, symbols.zero) for key, value in r.outputs.items()})
            for name, r in routines.items()
        },
        groups=symbols.groups,
        null_space=space,
    )


class _Symbols:
    """The symbols of the inputs: q, v, u, v_dot, q_ddot, t."""

    def __init__(self, graph: Graph, mechanism: Mechanism, independent: tuple[str, ...]) -> None:
        names = mechanism.coordinates
        self.graph = graph
        self.groups = {
            "q": names,
            "v": tuple(f"{name}_dot" for name in independent),
            "q_dot": tuple(f"{name}_dot" for name in names),
            "u": mechanism.inputs,
            "v_dot": tuple(f"{name}_ddot" for name in independent),
            "q_ddot": tuple(f"{name}_ddot" for name in names),
            "t": ("t",) if mechanism.rheonomic else (),
            "p": tuple(p.name for p in mechanism.parameters),
        }
        self.q = [graph.symbol(name) for name in names]
        self.rates = [graph.symbol(f"{name}_dot") for name in names]
        self.v, self.u = self.group("v"), self.group("u")
        acting = [(actuator.coordinate, graph.symbol(actuator.name)) for actuator in mechanism.actuators]
        self.Q = [self.zero + total(u for coordinate, u in acting if coordinate == name) for name in names]
        self.input_columns = [[1 if a.coordinate == name else 0 for name in names] for a in mechanism.actuators]

    @property
    def zero(self) -> Expr:
        """The expression 0."""
        return self.graph.constant(0)

    def group(self, name: str) -> list[Expr]:
        """The symbols of a group of inputs."""
        return [self.graph.symbol(symbol) for symbol in self.groups[name]]


def _null_space(
    A: list[list[Expr]], names: tuple[str, ...], chosen: tuple[str, ...], sizes: Sizes | None
) -> SymbolicNullSpace:
    independent = [names.index(name) for name in chosen]
    given = Given("expressions", sparse_rows(A), len(names))
    try:
        return symbolic_null_space(given, independent, plan=Plan(offsets=True, sizes=sizes))
    except SingularityError:
        form = echelon(A, [j for j in range(len(names)) if j not in independent] + independent)
        would_do = [name for j, name in enumerate(names) if j not in form.columns]
        raise dependent(chosen, would_do) from None


def _closure_routines(loops: Closures, kept: Closures, chart: Choice) -> dict[str, Routine]:
    """Positions: what closes the loops, what cannot be closed by any motion, and the rows for rates."""
    never = [i for i in range(len(loops.Phi)) if i not in chart.closures]
    return {
        "closure": Routine(
            ("q",), {"Phi": [loops.Phi[i] for i in chart.closures], "A": [loops.A[i] for i in chart.closures]}
        ),
        "redundant": Routine(("q",), {"Phi": [loops.Phi[i] for i in never]}),
        "facing": Routine(("q",), {"cosines": [cosine for _, cosine in loops.facing]}),
        "rows": Routine(("q",), {"A": kept.A, "b": kept.b}),
    }


class _Reduction:
    """Everything after the null space is there: outputs as equations, routines as what is evaluated together."""

    def __init__(self, loads: Loaded, kept: Closures, space: SymbolicNullSpace, symbols: _Symbols) -> None:
        self.bodies, self.power = loads.inertia, loads.power
        self.kept, self.space, self.symbols = kept, space, symbols
        self.N = space.reduced
        self.driven = any(entry != 0 for entry in kept.b)
        self.c = kept.c if self.driven else _simplified_c(space, symbols)

    def offset(self, c: list[Expr]) -> Sequence[Any]:
        """gamma of c in the form in which it is kept here."""
        return self.space.offset(c, of_simplified=not self.driven)

    def outputs(self) -> dict[str, Any]:
        """The named outputs in (q, q', u, t, parameters)."""
        bodies, space, N = self.bodies, self.space, self.N
        gamma = self.offset(self.c)
        reduced = reduce(bodies.M, bodies.h, N, gamma)
        return {
            "A": self.kept.A,
            "b": self.kept.b,
            "c": self.kept.c,
            "M": bodies.M,
            "h": bodies.h,
            "Q": self.symbols.Q,
            "T": bodies.T,
            "U": bodies.U,
            "delta": space.delta,
            "N": N,
            "N_scaled": space.scaled,
            "beta": space.offset(self.kept.b),
            "gamma": gamma,
            "gamma_scaled": space.offset_scaled(self.c, of_simplified=not self.driven),
            "Mr": reduced.Mr,
            "hr": reduced.hr,
            "Br": input_matrix(N, self.symbols.input_columns),
        }

    def routines(self) -> dict[str, Routine]:
        """The same equations with q' = N v + beta put in, grouped by what is evaluated together."""
        bodies, space, symbols, N, zero = self.bodies, self.space, self.symbols, self.N, self.symbols.zero
        qd = [zero + rate for rate in add(matvec(N, symbols.v), space.offset(self.kept.b))]
        onto = {symbols.rates[j]: qd[j] for j in space.dependent}
        h, c = substitute(bodies.h, onto), substitute(self.c, onto)
        gamma = self.offset(c)
        reduced = reduce(bodies.M, h, N, gamma)
        spread = total(e * e for row in N for e in row if isinstance(e, Expr))
        check = {"delta": space.delta, "spread": spread, "doubt": space.doubt}
        Br = input_matrix(N, symbols.input_columns)
        size = gross(bodies.M, N)
        v_dot, loss = forward(reduced, Br, symbols.u, size)
        q_ddot = acceleration(N, v_dot, gamma)
        cancelled = dot(size, [1 / reduced.Mr[j][j] for j in range(len(size))])
        Qr = inverse(bodies.M, h, N, acceleration(N, symbols.group("v_dot"), gamma))
        power = [substitute([self.power], onto)[0], dot(symbols.Q, qd)]
        if self.driven:  # the constraint forces -A^T lambda do the work lambda . b at the drives
            power.append(dot(self._multipliers(h, q_ddot), self.kept.b))
        lam = self._multipliers(bodies.h, symbols.group("q_ddot"))
        return {
            "kinematics": Routine(("q", "v"), {"N": N, "gamma": gamma, "q_dot": qd, **check}),
            "forward_dynamics": Routine(
                ("q", "v", "u"), {"q_ddot": q_ddot, "q_dot": qd, **check, "loss": loss, "power": zero + total(power)}
            ),
            "inverse_dynamics": Routine(
                ("q", "v", "v_dot"), {"Qr": Qr, "u": required_inputs(Br, Qr), "Br": Br, **check, "loss": cancelled}
            ),
            "closing": Routine(("q",), {"correction": space.offset(self.kept.Phi), **check}),
            "reactions": Routine(("q", "q_dot", "u", "q_ddot"), {"lam": lam}),
            "energy": Routine(("q", "q_dot"), {"T": bodies.T, "U": bodies.U}),
        }

    def _multipliers(self, h: Sequence[Any], q_ddot: Sequence[Any]) -> list[Any]:
        """lambda with A^T lambda = Q - M q'' - h."""
        moved = add(matvec(self.bodies.M, q_ddot), h)
        return list(self.space.multipliers(add(self.symbols.Q, scale(-1, moved))))


def _simplified_c(space: SymbolicNullSpace, symbols: _Symbols) -> list[Expr]:
    """c = A' q' [7] of the simplified rows: B^-1 c is the same for both, and this one costs less."""
    products = [symbols.zero + rate for rate in matvec(space.simplified, symbols.rates)]
    return directional(products, dict(zip(symbols.q, symbols.rates, strict=True)))


def _expressions(output: Any, zero: Expr) -> Any:
    """Plain zeros and ones as expressions of the graph."""
    if isinstance(output, list | tuple):
        return tuple(_expressions(part, zero) for part in output)
    return zero + output
