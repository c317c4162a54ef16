"""derive: Mechanism -> Equations, step by step as in theory 1 to 3.

frames [20-25] -> Phi, A, b, c [26, 6, 7] -> M, h, T, U [27-35] and loads -> rows and independent coordinates
-> N, delta [9-13] -> beta, gamma [40, 41] -> Mr, hr, Br [39, 42] -> routines [42-46]
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from nullbody.equations.basis import Terms, other_bases, written_in
from nullbody.equations.choice import Choice, choose
from nullbody.equations.closure import Closures, closures
from nullbody.equations.dynamics import Dynamics
from nullbody.equations.equations import Equations, Routine
from nullbody.equations.inertia import inertia
from nullbody.equations.load import loaded
from nullbody.equations.manifold import Manifold
from nullbody.equations.motion import MotionExpressions
from nullbody.equations.presentation import flat
from nullbody.equations.reduction import input_matrix, reduce
from nullbody.equations.symbols import Symbols
from nullbody.equations.turning import write_turning
from nullbody.errors import InputError
from nullbody.expr import Expr, Graph
from nullbody.mechanism import Mechanism

__all__ = ["derive"]


def derive(
    mechanism: Mechanism,
    independent: Sequence[str] | None = None,
    *,
    rows: Sequence[str] | None = None,
    basis: Sequence[str] | None = None,
) -> Equations:
    """The equations of motion of a mechanism, closed form, without multipliers.

    Args:
        mechanism: any mechanism of rigid bodies with loops.
        independent: names of the coordinates whose rates are v, nq - rank A of them; the actuated ones by
            default where they are as many and regular, otherwise those for which |B| is large at the home.
        rows: labels of the rows of A to keep, rank A of them; chosen by default.
        basis: names of the coordinates in whose rates forward and inverse dynamics are written inside, as many; by
            default those with which forward dynamics take the fewest operations. v stays what it is.

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
    write_turning(motion)
    loops = closures(mechanism, motion)
    loads = loaded(mechanism, inertia(mechanism, motion.frames, motion.scalar, q, motion.rates), motion)
    manifold = Manifold(loops, (list(q.values()), motion.time), values, mechanism.home_values(values))
    chart = choose(mechanism, loops, manifold, independent, rows)
    symbols = Symbols(graph, mechanism, chart.independent)
    terms = Terms(loads, loops.kept(chart.rows), symbols, values, manifold.samples)
    others = {names: terms.of(graph.copy()) for names in other_bases(terms, basis)}
    direct = terms.dynamics(chart.independent)
    outputs = {"Phi": [loops.Phi[i] for i in chart.closures], **_outputs(direct)}
    routines = {**_closure_routines(loops, terms.kept, chart), **_routines(direct)}
    chosen, written = written_in(direct, others, wanted=basis is not None)
    graph.verify()
    return Equations(
        mechanism=mechanism,
        graph=graph,
        coordinates=names,
        independent=chart.independent,
        basis=chosen,
        labels=tuple(loops.labels[i] for i in chart.rows),
        closure_labels=tuple(loops.labels[i] for i in chart.closures),
        redundant=tuple(label for i, label in enumerate(loops.labels) if i not in chart.rows),
        facing=tuple(loop for loop, _ in loops.facing),
        mobility=chart.mobility,
        outputs={name: _expressions(output, symbols.zero) for name, output in outputs.items()},
        routines={name: _expressed(routine, symbols.zero) for name, routine in {**routines, **written}.items()},
        groups=symbols.groups,
        null_space=direct.space,
    )


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


def _outputs(dynamics: Dynamics) -> dict[str, Any]:
    """The named outputs in (q, q', u, t, parameters)."""
    bodies, kept, space, N = dynamics.loads.inertia, dynamics.kept, dynamics.space, dynamics.space.reduced
    c = dynamics.c
    gamma = dynamics.offset(c)
    reduced = reduce(bodies.M, bodies.h, N, gamma)
    return {
        "A": kept.A,
        "b": kept.b,
        "c": kept.c,
        "M": bodies.M,
        "h": bodies.h,
        "Q": dynamics.symbols.Q,
        "T": bodies.T,
        "U": bodies.U,
        "delta": space.delta,
        "N": N,
        "N_scaled": space.scaled,
        "beta": space.offset(kept.b),
        "gamma": gamma,
        "gamma_scaled": space.offset_scaled(c, of_simplified=not dynamics.driven),
        "Mr": reduced.Mr,
        "hr": reduced.hr,
        "Br": input_matrix(N, dynamics.symbols.input_columns),
    }


def _routines(dynamics: Dynamics) -> dict[str, Routine]:
    """What is evaluated together beside the dynamics, with q' = N v + beta put in where a state is asked for."""
    bodies, space, symbols, check = dynamics.loads.inertia, dynamics.space, dynamics.symbols, dynamics.check
    kinematics = {"N": space.reduced, "gamma": dynamics.gamma, "q_dot": dynamics.q_dot, **check}
    lam = dynamics.multipliers(bodies.h, symbols.group("q_ddot"))
    return {
        "kinematics": Routine(("q", "v"), kinematics),
        "closing": Routine(("q",), {"correction": space.offset(dynamics.kept.Phi), **check}),
        "reactions": Routine(("q", "q_dot", "u", "q_ddot"), {"lam": lam}),
        "energy": Routine(("q", "q_dot"), {"T": bodies.T, "U": bodies.U}),
    }


def _expressed(routine: Routine, zero: Expr) -> Routine:
    """A routine with plain zeros and ones as expressions of its graph."""
    first = next((f for output in routine.outputs.values() for f in flat(output) if isinstance(f, Expr)), zero)
    zero = first.graph.constant(0)
    return Routine(routine.inputs, {name: _expressions(output, zero) for name, output in routine.outputs.items()})


def _expressions(output: Any, zero: Expr) -> Any:
    """Plain zeros and ones as expressions of the graph."""
    if isinstance(output, list | tuple):
        return tuple(_expressions(part, zero) for part in output)
    return zero + output
