"""documentation/index.html of a unit: what it is, its variables in order, and what it refuses."""

from __future__ import annotations

from html import escape

from nullbody import __version__
from nullbody.export.fmu.variables import Unit

__all__ = ["page"]

_STYLE = (
    "body{font-family:sans-serif;max-width:60em;margin:2em auto;padding:0 1em}"
    "td,th{text-align:left;padding:.1em 1em .1em 0}pre{overflow:auto}"
)

_NOTES = """
<p>The states are all coordinates q and the rates v of the independent coordinates:
q' = N v + beta, v' from Mr v' + hr = Br u. All loops are closed at the start.</p>
<h2>Model exchange</h2>
<p>An integrator keeps q' and not the loops: they drift open, by about its tolerance. Once |Phi| exceeds
<code>solver.drift</code> the unit asks for an event, which closes them with the independent coordinates held.
<code>loops.gap</code> is |Phi|.</p>
<h2>Co-simulation</h2>
<p>Dormand and Prince's Runge-Kutta pair of orders 5 and 4 with steps of its own; loops are closed after each step.
The tolerance is <code>solver.tolerance</code> where it is set, else that of the host. Inputs are held over a
communication step.</p>
<h2>Parameters and start values</h2>
<p>They can be set before the simulation. Parameters that are formulas of others follow them. For other parameters or
independent coordinates the loops are closed at initialization, along the branch of the exported start; with start
values of dependent coordinates, near those. Signs of parameters are checked, moments of inertia against each other are
not.</p>
<h2>What is refused</h2>
<p>Where a result would not be right the unit logs the reason by name and stops: <code>SINGULAR_INDEPENDENT_SET</code>,
<code>SINGULAR_MASS_MATRIX</code>, <code>NOT_FINITE</code>, <code>LOOPS_OPEN</code>, <code>STEP_TOO_SMALL</code>,
<code>TOO_MANY_STEPS</code>, and at initialization <code>BAD_PARAMETER</code>, <code>BRANCH_ENDS</code>,
<code>CLOSED_WRONG_WAY</code>, <code>NEVER_CLOSED</code>. Model exchange keeps its independent coordinates on the way;
co-simulation changes to others where the unit was exported with some (charts).</p>
"""


def page(unit: Unit) -> str:
    """The page as HTML."""
    name = escape(unit.model.mechanism.name)
    rows = [
        f"<tr><td>{escape(v.name)}</td><td>{v.causality}</td><td>{escape(v.unit or '-')}</td>"
        f"<td>{'' if v.start is None else format(v.start, '.9g')}</td><td>{escape(v.meaning)}</td></tr>"
        for v in unit.variables
    ]
    charts = "; ".join(escape(", ".join(equations.independent)) for equations in unit.charts)
    states = ", ".join(escape(v.name) for v in unit.states)
    return "\n".join(
        [
            f'<!doctype html>\n<html lang="en">\n<head><meta charset="utf-8"><title>{name}</title>',
            f"<style>{_STYLE}</style></head>\n<body>\n<h1>{name}</h1>",
            f"<p>Made by nullbody {__version__}.</p>",
            _NOTES.strip(),
            f"<h2>States, in order</h2>\n<p>{states}</p>",
            f"<h2>Charts</h2>\n<p>{charts}</p>",
            "<h2>Variables, in order</h2>\n<table>",
            "<tr><th>name</th><th>kind</th><th>unit</th><th>start</th><th>meaning</th></tr>",
            *rows,
            f"</table>\n<h2>Equations</h2>\n<pre>{escape(str(unit.equations))}</pre>\n</body>\n</html>\n",
        ]
    )
