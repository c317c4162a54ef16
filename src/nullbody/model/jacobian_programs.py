"""Programs of exact Jacobians: what `Derivatives` compiles, made from the equations of a model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any, Literal

from nullbody.equations import Equations, derive, flat
from nullbody.expr import Tape, gradient
from nullbody.kernels import Kernel, Program, compile_programs
from nullbody.model.chart import Key
from nullbody.model.sensitivity import Rows, Sensitivity

__all__ = ["Kind", "jacobian_kernel", "jacobian_program"]

Kind = Literal["rate", "rate_power", "forward_dynamics", "inverse_dynamics"]

_KEPT = 64  # kernels in memory
_MEASURES = ("delta", "spread", "doubt", "loss")

Blocks = dict[str, tuple[Sequence[Any], tuple[int, ...]]]


@lru_cache(maxsize=_KEPT)
def jacobian_kernel(
    key: Key, independent: tuple[str, ...], labels: tuple[str, ...], kind: Kind, parameters: bool
) -> Kernel:
    """The kernel of `jacobian_program` for a mechanism in a chart."""
    written = derive(key.mechanism, independent, rows=labels, basis=independent)  # all routines in one graph
    program = jacobian_program(written, kind, parameters)
    return compile_programs([program]).kernels[program.name]


def jacobian_program(equations: Equations, kind: Kind, parameters: bool) -> Program:
    """Values and Jacobians of a routine as one program.

    Args:
        equations: theirs, written in the rates of the independent coordinates; their graph grows.
        kind: "rate" of q and v; "forward_dynamics", all q''; "inverse_dynamics", u or Qr; or "rate_power", the rate
            with the power of inputs and loads as a last row, in one matrix.
        parameters: whether to differentiate with respect to them too.

    Returns:
        Outputs named as y, or as y_x for dy/dx, those of "rate" A and B; the measures delta, spread, doubt and loss of
        the routine last.
    """
    groups = ["q", *(["t"] if equations.groups["t"] else []), *(["p"] if parameters else [])]
    blocks = {
        "rate": _rate,
        "rate_power": _rate_power,
        "forward_dynamics": _forward_dynamics,
        "inverse_dynamics": _inverse_dynamics,
    }[kind](equations, groups)
    equations.graph.verify()
    name = f"{kind}_jacobian" + ("_p" if parameters else "")
    return _program(name, "v_dot" if kind == "inverse_dynamics" else "u", equations, blocks)


def _rate(equations: Equations, groups: list[str]) -> Blocks:
    """x' of x = (q, v) with its derivatives by x, u, t, p."""
    routine = equations.routines["forward_dynamics"].outputs
    at = _forward(equations, groups)
    v_dot_v = _negative(at.accelerated(at.R_v))
    by_q = _split("x", [*at.q_dot_x, *_v_dot_x(at)], equations, groups)
    (first, _), n, nu = by_q.pop("x_q"), len(at.N) + len(at.Mr), len(equations.inputs)
    return {
        "rate": ([*routine["q_dot"], *_independent(equations, routine["q_ddot"])], (n,)),
        "A": ([[*q, *v] for q, v in zip(first, [*at.N, *v_dot_v], strict=True)], (n, n)),
        "B": ([*([0] * nu for _ in at.N), *at.accelerated(at.Br)], (n, nu)),
        **by_q,
        **_measures(routine),
    }


def _rate_power(equations: Equations, groups: list[str]) -> Blocks:
    """d(q', v', power)/d(q, v); the power, one function of many symbols, by reverse mode."""
    power = equations.routines["forward_dynamics"].outputs["power"]
    symbols = _symbols(equations, ("q", "v"))
    rows, (n, _) = _rate(equations, groups)["A"]
    return {"J": ([*rows, gradient(power, symbols)], (n + 1, n))}


def _forward_dynamics(equations: Equations, groups: list[str]) -> Blocks:
    """q'' with its derivatives by q, v, u, t, p."""
    routine = equations.routines["forward_dynamics"].outputs
    at = _forward(equations, groups)
    nq, nv = len(equations.coordinates), len(equations.independent)
    driven = at.accelerated(at.Br)
    return {
        "q_ddot": (routine["q_ddot"], (nq,)),
        **_split("q_ddot", at.q_ddot_x(_v_dot_x(at)), equations, groups),
        "q_ddot_v": (at.q_ddot_v(_negative(at.accelerated(at.R_v))), (nq, nv)),
        "q_ddot_u": (at.q_ddot_u(driven), (nq, len(equations.inputs))),
        **_measures(routine),
    }


def _inverse_dynamics(equations: Equations, groups: list[str]) -> Blocks:
    """u, or Qr where inputs and degrees of freedom are not as many, with derivatives by q, v, v', t, p."""
    routine, kinematics = (equations.routines[name].outputs for name in ("inverse_dynamics", "kinematics"))
    graph = equations.graph
    nv, nu = len(equations.independent), len(equations.inputs)
    solved = len(routine["u"]) == nv
    v_dot = [graph.symbol(name) for name in equations.groups["v_dot"]]
    N, gamma = kinematics["N"], kinematics["gamma"]
    q_ddot = [sum((n * a for n, a in zip(row, v_dot, strict=True)), g) for row, g in zip(N, gamma, strict=True)]
    u = routine["u"] if solved else [graph.constant(0)] * nu
    at = Sensitivity(equations, _symbols(equations, groups), q_ddot, u)
    forces = [(at.R_x, groups), (at.R_v, ["v"]), (at.Mr, ["v_dot"])]
    blocks: Blocks = {}
    for rows, by in forces:
        blocks |= _split("u", at.driven(rows) if solved else rows, equations, by)
    return {
        "Qr": (routine["Qr"], (nv,)),
        "u": (routine["u"], (len(routine["u"]),)),
        "Br": (routine["Br"], (nv, nu)),
        **blocks,
        **_measures(routine),
    }


def _forward(equations: Equations, groups: list[str]) -> Sensitivity:
    """The differentials where the inputs cause the motion."""
    u = [equations.graph.symbol(name) for name in equations.groups["u"]]
    q_ddot = equations.routines["forward_dynamics"].outputs["q_ddot"]
    return Sensitivity(equations, _symbols(equations, groups), q_ddot, u)


def _v_dot_x(at: Sensitivity) -> Rows:
    return _negative(at.accelerated(at.R_x))


def _negative(rows: Rows) -> Rows:
    return [[-entry for entry in row] for row in rows]


def _symbols(equations: Equations, groups: Sequence[str]) -> list[Any]:
    return [equations.graph.symbol(name) for group in groups for name in equations.groups[group]]


def _independent(equations: Equations, rows: Sequence[Any]) -> list[Any]:
    return [rows[equations.coordinates.index(name)] for name in equations.independent]


def _measures(routine: Mapping[str, Any]) -> Blocks:
    return {name: ([routine[name]], ()) for name in _MEASURES}


def _split(name: str, rows: Rows, equations: Equations, groups: Sequence[str]) -> Blocks:
    """The columns of dy/dx, a block for each group."""
    blocks: Blocks = {}
    start = 0
    for group in groups:
        stop = start + len(equations.groups[group])
        blocks[f"{name}_{group}"] = ([row[start:stop] for row in rows], (len(rows), stop - start))
        start = stop
    return blocks


def _program(name: str, third: str, equations: Equations, blocks: Blocks) -> Program:
    groups = ["q", "v", third, *(["t"] if equations.groups["t"] else []), "p"]
    zero = equations.graph.constant(0)
    return Program(
        name=name,
        inputs=tuple((group, len(equations.groups[group])) for group in groups),
        outputs=tuple((key, shape) for key, (_, shape) in blocks.items()),
        tape=Tape.of(
            [zero + entry for rows, _ in blocks.values() for entry in flat(rows)],
            [symbol for group in groups for symbol in equations.groups[group]],
        ),
    )
