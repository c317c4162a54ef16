"""derive: Mechanism -> Equations, step by step as in theory 1 to 3.

frames [20-25] -> Phi, A, c [26, 6, 7] -> M, h, T, U [27-35] -> N, delta [9-13] -> gamma [40, 41] -> Mr, hr, Br [39, 42]
-> routines [42-46]
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from nullbody.equations.closure import Closures, closures
from nullbody.equations.equations import Equations, Routine
from nullbody.equations.frame import frames
from nullbody.equations.inertia import Inertia, inertia
from nullbody.equations.reduction import acceleration, forward, gross, input_matrix, inverse, reduce, required_inputs
from nullbody.equations.scalar import ParameterScalars
from nullbody.errors import InputError, SingularityError, UnknownName
from nullbody.expr import Expr, Graph, directional, substitute
from nullbody.expr.matrix import add, dot, matvec, scale, total
from nullbody.mechanism import Mechanism
from nullbody.nullspace import SymbolicNullSpace, echelon
from nullbody.nullspace.call import symbolic_null_space
from nullbody.nullspace.given import Given
from nullbody.nullspace.plan import Plan
from nullbody.nullspace.steps import sparse_rows

__all__ = ["derive"]


def derive(mechanism: Mechanism, independent: Sequence[str] | None = None) -> Equations:
    """The equations of motion of a mechanism, closed form, without multipliers.

    Args:
        mechanism: any mechanism of rigid bodies with loops.
        independent: names of the coordinates whose rates are v, nq - rank A of them; the actuated ones by
            default where they are as many and regular, otherwise chosen so that |B| is not identically zero.

    Raises:
        UnknownName: a name is no coordinate.
        InputError: too few or too many names.
        ParameterError: a body is not physical.
        MechanismError: a degree of freedom moves no mass.
        SingularityError: |B| is identically zero for this choice; the message names one that would do.
    """
    if not isinstance(mechanism, Mechanism):
        raise InputError(f"derive takes a Mechanism, such as nullbody.catalog.three_prs(), not {mechanism!r}")
    mechanism.values()
    graph = Graph()
    scalars = ParameterScalars(graph, tuple(p.name for p in mechanism.parameters))
    names = mechanism.coordinates
    q = {name: graph.symbol(name) for name in names}
    rates = {name: graph.symbol(f"{name}_dot") for name in names}
    found = frames(mechanism, scalars, q)
    loops = closures(mechanism, found, scalars, list(q.values()), list(rates.values()))
    bodies = inertia(mechanism, found, scalars, q, rates)
    chosen = _independent(mechanism, loops, independent)
    space = _null_space(loops.A, names, chosen)
    symbols = _Symbols(graph, mechanism, chosen)
    c = _simplified_c(space, symbols)
    outputs = _outputs(loops, bodies, space, symbols, c)
    routines = _routines(loops, bodies, space, symbols, c)
    graph.verify()
    return Equations(
        mechanism=mechanism,
        graph=graph,
        coordinates=names,
        independent=chosen,
        labels=tuple(loops.labels[i] for i in space.rows),
        redundant=tuple(loops.labels[i] for i in space.redundant),
        outputs=outputs,
        routines=routines,
        groups=symbols.groups,
        null_space=space,
    )


class _Symbols:
    """The symbols of the inputs: v, u, v_dot, q_ddot."""

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


def _independent(mechanism: Mechanism, loops: Closures, wanted: Sequence[str] | None) -> tuple[str, ...]:
    names = mechanism.coordinates
    form = echelon(loops.A, _preferred_order(mechanism)) if loops.A else None
    nv = len(names) - (form.rank if form else 0)
    if wanted is None:
        pivots = form.columns if form else ()
        free = [name for j, name in enumerate(names) if j not in pivots]
        actuated = [name for name in dict.fromkeys(mechanism.actuated) if name in free]
        return tuple(actuated + [name for name in free if name not in actuated])
    try:
        wanted = (wanted,) if isinstance(wanted, str) else tuple(wanted)
    except TypeError:
        raise InputError(f"independent must be a list of coordinate names, not {wanted!r}") from None
    for name in wanted:
        if name not in names:
            raise UnknownName("coordinate", name, names)
    if len(set(wanted)) != len(wanted) or len(wanted) != nv:
        raise InputError(f"{mechanism.name!r} has {nv} degrees of freedom: name {nv} coordinates, not {list(wanted)}")
    return wanted


def _preferred_order(mechanism: Mechanism) -> list[int]:
    """Columns in the order in which they should become dependent: actuated coordinates last."""
    names = mechanism.coordinates
    return sorted(range(len(names)), key=lambda j: names[j] in mechanism.actuated)


def _null_space(A: list[list[Expr]], names: tuple[str, ...], chosen: tuple[str, ...]) -> SymbolicNullSpace:
    independent = [names.index(name) for name in chosen]
    given = Given("expressions", sparse_rows(A), len(names))
    try:
        return symbolic_null_space(given, independent, plan=Plan(offsets=True))
    except SingularityError:
        form = echelon(A, [j for j in range(len(names)) if j not in independent] + independent)
        would_do = [name for j, name in enumerate(names) if j not in form.columns]
        raise SingularityError(
            f"{', '.join(chosen)} cannot be the independent coordinates in any configuration: they depend on each "
            f"other, |B| is identically zero. {', '.join(would_do)} would do"
        ) from None


def _outputs(
    loops: Closures, bodies: Inertia, space: SymbolicNullSpace, symbols: _Symbols, c: list[Expr]
) -> dict[str, Any]:
    zero = symbols.zero
    N = space.reduced
    gamma = space.offset(c, of_simplified=True)
    reduced = reduce(bodies.M, bodies.h, N, gamma)
    outputs = {
        "Phi": [loops.Phi[i] for i in space.rows],
        "A": [loops.A[i] for i in space.rows],
        "c": [loops.c[i] for i in space.rows],
        "M": bodies.M,
        "h": bodies.h,
        "Q": symbols.Q,
        "T": bodies.T,
        "U": bodies.U,
        "delta": space.delta,
        "N": N,
        "N_scaled": space.scaled,
        "gamma": gamma,
        "gamma_scaled": space.offset_scaled(c, of_simplified=True),
        "Mr": reduced.Mr,
        "hr": reduced.hr,
        "Br": input_matrix(N, symbols.input_columns),
    }
    return {name: _expressions(output, zero) for name, output in outputs.items()}


def _simplified_c(space: SymbolicNullSpace, symbols: _Symbols) -> list[Expr]:
    """c = A' q' [7] of the simplified rows: B^-1 c is the same for both, and this one costs less."""
    products = [symbols.zero + rate for rate in matvec(space.simplified, symbols.rates)]
    return directional(products, dict(zip(symbols.q, symbols.rates, strict=True)))


def _routines(
    loops: Closures, bodies: Inertia, space: SymbolicNullSpace, symbols: _Symbols, simplified_c: list[Expr]
) -> dict[str, Routine]:
    """The same equations with q' = N v put in, grouped by what is evaluated together."""
    zero, N, v = symbols.zero, space.reduced, symbols.v
    qd = [zero + rate for rate in matvec(N, v)]
    onto = {symbols.rates[j]: qd[j] for j in space.dependent}
    h, c = substitute(bodies.h, onto), substitute(simplified_c, onto)
    gamma = space.offset(c, of_simplified=True)
    reduced = reduce(bodies.M, h, N, gamma)
    spread = total(e * e for row in N for e in row if isinstance(e, Expr))
    check = {"delta": space.delta, "spread": spread, "doubt": space.doubt}
    Br = input_matrix(N, symbols.input_columns)
    size = gross(bodies.M, N)
    v_dot, loss = forward(reduced, Br, symbols.u, size)
    cancelled = dot(size, [1 / reduced.Mr[j][j] for j in range(len(size))])
    Qr = inverse(bodies.M, h, N, acceleration(N, symbols.group("v_dot"), gamma))
    unbalanced = add(symbols.Q, scale(-1, add(matvec(bodies.M, symbols.group("q_ddot")), bodies.h)))
    lam = space.multipliers(unbalanced)
    routines = {
        "closure": Routine(("q",), {"Phi": [loops.Phi[i] for i in space.rows], "A": [loops.A[i] for i in space.rows]}),
        "redundant": Routine(("q",), {"Phi": [loops.Phi[i] for i in space.redundant]}),
        "kinematics": Routine(("q", "v"), {"N": N, "gamma": gamma, "q_dot": qd, **check}),
        "forward_dynamics": Routine(
            ("q", "v", "u"), {"q_ddot": acceleration(N, v_dot, gamma), "q_dot": qd, **check, "loss": loss}
        ),
        "inverse_dynamics": Routine(
            ("q", "v", "v_dot"), {"Qr": Qr, "u": required_inputs(Br, Qr), **check, "loss": cancelled}
        ),
        "reactions": Routine(("q", "q_dot", "u", "q_ddot"), {"lam": [lam[i] for i in space.rows]}),
        "energy": Routine(("q", "q_dot"), {"T": bodies.T, "U": bodies.U}),
    }
    return {
        name: Routine(r.inputs, {key: _expressions(value, zero) for key, value in r.outputs.items()})
        for name, r in routines.items()
    }


def _expressions(output: Any, zero: Expr) -> Any:
    """Plain zeros and ones as expressions of the graph."""
    if isinstance(output, list | tuple):
        return tuple(_expressions(part, zero) for part in output)
    return zero + output
