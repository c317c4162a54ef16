"""nullbody derive"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nullbody.cli.options import Independent, Json, MechanismName, Out, mechanism_of, names
from nullbody.cli.output import note, print_json, print_table

if TYPE_CHECKING:
    from nullbody.equations import Equations

__all__ = ["EXAMPLES", "derive"]

EXAMPLES = (
    "nullbody derive three_prs",
    "nullbody derive three_prs --independent y,psi,phi --ops",
    "nullbody derive three_prs --latex N_scaled",
    "nullbody derive three_prs -o equations.tex",
)

#: What routines are called for; their other outputs are rates, power and what tells whether a result is sound.
_RESULTS = (("forward_dynamics", "q_ddot"), ("inverse_dynamics", "u"), ("kinematics", "N"))

Latex = Annotated[str | None, typer.Option(metavar="OUTPUT", help="Print one output as LaTeX, such as N_scaled.")]
Ops = Annotated[bool, typer.Option("--ops", help="Print a table of operation counts.")]


def derive(
    mechanism: MechanismName,
    independent: Independent = None,
    latex: Latex = None,
    ops: Ops = False,
    out: Out = None,
    as_json: Json = False,
) -> None:
    """Derive the equations of motion, with their cost.

    The file of --out ends in .tex; it holds the output of --latex, or all of them.
    """
    from nullbody import equations
    from nullbody.export import check_target, write_latex

    if out is not None:
        check_target(out, ".tex")
    chosen = mechanism_of(mechanism)
    began = time.perf_counter()
    derived = equations.derive(chosen, names(independent) or None)
    seconds = time.perf_counter() - began
    shown = "" if latex is None else derived.latex(latex)
    if out is not None:
        write_latex(derived, out, None if latex is None else [latex])
    if as_json:
        print_json({**_entries(derived), "latex": shown or None, "file": out, "seconds": seconds})
        return
    if ops:
        _print_operations(derived)
    if shown:
        print(shown)
    if not (ops or shown):
        print(derived)
    note(f"derived in {1e3 * seconds:.0f} ms" + (f", written to {out}" if out else ""))


def _entries(derived: Equations) -> dict[str, Any]:
    from nullbody.equations.presentation import shape

    return {
        "mechanism": derived.mechanism.name,
        "coordinates": derived.coordinates,
        "independent": derived.independent,
        "basis": derived.basis,
        "inputs": derived.inputs,
        "closures": derived.labels,
        "redundant_closures": derived.redundant,
        "outputs": {
            name: {"shape": shape(derived[name]), "operations": vars(derived.operations(name))}
            for name in derived.outputs
        },
        "routines": {name: {"operations": vars(derived.routine_operations(name))} for name in derived.routines},
    }


def _print_operations(derived: Equations) -> None:
    counted = [(name, derived.operations(name)) for name in derived.outputs]
    compiled = [(name, derived.routine_operations(name)) for name in derived.routines]
    compiled += [(f"{name}: {output}", derived.routine_operations(name, output)) for name, output in _RESULTS]
    for kind, counts in (("output", counted), ("routine", compiled)):
        rows = [(name, n.arithmetic, n.add, n.mul, n.div, n.sqrt, n.trig) for name, n in counts]
        print_table((kind, "arithmetic", "+", "*", "/", "sqrt", "sin, cos"), rows)
