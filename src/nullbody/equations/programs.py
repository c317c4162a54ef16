"""The routines of some equations as programs: what native code, C and CasADi functions are made of."""

from __future__ import annotations

from nullbody.equations.equations import Equations
from nullbody.equations.presentation import shape
from nullbody.expr import Tape
from nullbody.kernels import Program

__all__ = ["programs"]


def programs(equations: Equations) -> list[Program]:
    """The routines of some equations as programs; the time, where it enters, and parameters p come last in each."""
    made = []
    for name, routine in equations.routines.items():
        groups = [*routine.inputs, *(["t"] if equations.groups["t"] else []), "p"]
        inputs = [symbol for group in groups for symbol in equations.groups[group]]
        made.append(
            Program(
                name=name,
                inputs=tuple((group, len(equations.groups[group])) for group in groups),
                outputs=tuple((key, shape(output)) for key, output in routine.outputs.items()),
                tape=Tape.of(routine.expressions, inputs),
            )
        )
    return made
