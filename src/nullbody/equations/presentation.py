"""How equations are shown: a summary for the terminal, LaTeX for print."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from nullbody.expr.display import flat, latex_equation
from nullbody.expr.text import latex_symbol
from nullbody.mechanism import AbstractConstraint, AbstractLoopJoint

if TYPE_CHECKING:
    from nullbody.equations.equations import Equations

__all__ = ["flat", "latex_definition", "shape", "summary"]

_LATEX_NAMES = {
    "Phi": r"\Phi",
    "N_scaled": r"\tilde{N}",
    "gamma_scaled": r"\tilde{\gamma}",
    "delta": r"\Delta",
    "beta": r"\beta",
    "gamma": r"\gamma",
    "Mr": r"M_r",
    "hr": r"h_r",
    "Br": r"B_r",
}

_MEANINGS = {
    "Phi": "loop closures, Phi(q) = 0",
    "A": "constraint Jacobian, A q' + b = 0",
    "b": "rates of the closures by the time alone",
    "c": "A q'' + c = 0",
    "M": "mass matrix in redundant coordinates",
    "h": "Coriolis, gravity and loads, M q'' + h + A^T lambda = Q",
    "Q": "generalized forces of the inputs",
    "T": "kinetic energy",
    "U": "potential energy",
    "delta": "|B|, determinant of A's dependent columns",
    "N": "null-space basis, q' = N v + beta",
    "N_scaled": "delta N, without any division",
    "beta": "q' = N v + beta, zero without drivers",
    "gamma": "q'' = N v' + gamma",
    "gamma_scaled": "delta gamma, without any division",
    "Mr": "reduced mass matrix, Mr v' + hr = Br u",
    "hr": "reduced bias forces",
    "Br": "reduced input matrix",
}


def summary(equations: Equations) -> str:
    """Sizes, closures in words, and what each output is and costs."""
    nq, nc, nv = len(equations.coordinates), len(equations.labels), len(equations.independent)
    mechanism = equations.mechanism
    lines = [
        f"Equations of {mechanism.name!r}: nq = {nq} coordinates, nc = {nc} closures, nv = {nv} degrees of freedom",
        f"  q = {' '.join(equations.coordinates)}",
        f"  v = rates of {' '.join(equations.independent)}",
        f"  u = {' '.join(equations.inputs) or 'none'}",
    ]
    lines.append(
        "  outputs are in q, q', u and the parameters; with q' = N v put in they depend on (q, v), as the routines do"
    )
    parts: tuple[AbstractLoopJoint | AbstractConstraint, ...] = (*mechanism.loops, *mechanism.constraints)
    for part in parts:
        kept, dropped = _directions(equations.labels, part.name), _directions(equations.redundant, part.name)
        note = f"; {' '.join(dropped)} repeats other equations" if dropped else ""
        lines.append(f"  {_described(part)} ({' '.join(kept) or 'no equation'}{note})")
    lines += [f"  {line}" for line in str(equations.mobility).splitlines()]
    lines.append(f"  {'output':<13}{'size':>8}  {'operations':<40}meaning")
    for name in equations.outputs:
        if name in ("b", "beta") and not mechanism.rheonomic:
            continue
        size = " x ".join(str(n) for n in shape(equations[name])) or "1"
        lines.append(f"  {name:<13}{size:>8}  {equations.operations(name)!s:<40}{_MEANINGS[name]}")
    return "\n".join(lines)


def _described(part: AbstractLoopJoint | AbstractConstraint) -> str:
    kind = type(part).__name__.lower()
    if isinstance(part, AbstractLoopJoint):
        return f"loop {part.name}: {kind} joint between {part.parent} and {part.child}"
    return f"constraint {part.name}: {kind}"


def _directions(labels: Sequence[str], loop: str) -> list[str]:
    """The directions of one loop among labels such as "leg1 x"."""
    return [direction for name, _, direction in (label.rpartition(" ") for label in labels) if name == loop]


def shape(output: Any) -> tuple[int, ...]:
    """The shape of a scalar, vector or matrix."""
    if not isinstance(output, Sequence):
        return ()
    inner = shape(output[0]) if output else ()
    return (len(output), *inner)


def latex_definition(name: str, output: Any) -> str:
    """`name = ...` in an aligned environment, shared sub-expressions first."""
    return latex_equation(_LATEX_NAMES.get(name) or latex_symbol(name), output)
