"""Equations: the symbolic model of a mechanism, with named outputs and operation counts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from nullbody.equations.mobility import Mobility
from nullbody.equations.presentation import flat, latex_definition, summary
from nullbody.errors import UnknownName
from nullbody.expr import Expr, Graph, Operations, operations
from nullbody.mechanism import Mechanism
from nullbody.nullspace import SymbolicNullSpace

__all__ = ["Equations", "Routine"]


@dataclass(frozen=True)
class Routine:
    """A set of outputs that are evaluated together: what becomes one kernel.

    Attributes:
        inputs: groups among "q", "v", "q_dot", "u", "v_dot", "q_ddot"; the time t, where it enters at all, and the
            parameters always come last.
        outputs: named scalars, vectors or matrices.
    """

    inputs: tuple[str, ...]
    outputs: Mapping[str, Any]

    @property
    def expressions(self) -> list[Expr]:
        """The entries of all outputs in their order; all are in one graph."""
        return [f for output in self.outputs.values() for f in flat(output)]


@dataclass(frozen=True)
class Equations:
    """The equations of motion of a mechanism in redundant and in independent coordinates.

        Phi(q, t) = 0,    A q' + b = 0,   A q'' + c = 0,   M q'' + h + A^T lambda = Q
        q' = N v + beta,  q'' = N v' + gamma,              Mr v' + hr = N^T Q

    b and beta are zero where nothing depends on the time. h holds all loads; Q the inputs.

    `equations["Mr"]` is an output: a scalar, a tuple of expressions, or a tuple of rows. `outputs` lists the names.

    Attributes:
        mechanism: where they come from.
        graph: holds all expressions.
        coordinates: names of q.
        independent: names of the independent coordinates; v holds their rates.
        basis: names of the coordinates in whose rates forward and inverse dynamics are written inside. Where they are
            others than the independent ones, the expressions of these two routines are in a graph of their own.
        labels: where every row of A comes from ("leg1 x"), in the order of lambda.
        closure_labels: the same for Phi: rows that others repeat only where the loops are closed are in Phi, not in A;
            rows of rolling contacts are in A, not in Phi.
        redundant: labels of rows that repeat others and were left out of A.
        facing: loops that could also close with an axis reversed; routine "facing" tells.
        mobility: how many degrees of freedom there are, and why.
        outputs: the named outputs, in (q, q', u, parameters).
        routines: what is compiled: mostly in (q, v, u, parameters), with q' = N v put in.
        groups: names of the symbols in each group of inputs.
        null_space: the null space of A with its factors.
    """

    mechanism: Mechanism
    graph: Graph
    coordinates: tuple[str, ...]
    independent: tuple[str, ...]
    basis: tuple[str, ...]
    labels: tuple[str, ...]
    closure_labels: tuple[str, ...]
    redundant: tuple[str, ...]
    facing: tuple[str, ...]
    mobility: Mobility
    outputs: Mapping[str, Any]
    routines: Mapping[str, Routine]
    groups: Mapping[str, tuple[str, ...]]
    null_space: SymbolicNullSpace

    @property
    def dependent(self) -> tuple[str, ...]:
        """Names of the dependent coordinates, in the order of q."""
        return tuple(name for name in self.coordinates if name not in self.independent)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs u."""
        return self.mechanism.inputs

    def __getitem__(self, name: str) -> Any:
        if name not in self.outputs:
            raise UnknownName("output", name, self.outputs)
        return self.outputs[name]

    def operations(self, *names: str) -> Operations:
        """Operation counts of some outputs evaluated together; of all outputs by default."""
        return operations([f for name in names or self.outputs for f in flat(self[name])])

    def routine_operations(self, name: str, *outputs: str) -> Operations:
        """Operation counts of a routine as it is compiled, or of some of its outputs alone.

        Raises:
            UnknownName: there is no such routine, or no such output of it.
        """
        if name not in self.routines:
            raise UnknownName("routine", name, self.routines)
        found = self.routines[name].outputs
        for output in outputs:
            if output not in found:
                raise UnknownName(f"output of {name}", output, found)
        return operations([f for output in outputs or found for f in flat(found[output])])

    def latex(self, name: str) -> str:
        """An output as LaTeX (amsmath), with the sub-expressions it shares named z_1, z_2, ..."""
        return latex_definition(name, self[name])

    def to_casadi(self) -> dict[str, Any]:
        """CasADi functions (SX) of all routines by name, with named inputs q, v, u, ..., t, p and named outputs.

        t is an input only where something depends on the time; p takes `mechanism.values()` in their order. CasADi
        differentiates them, calls them in its solvers and writes C code.

        Raises:
            InputError: CasADi is not installed.
        """
        from nullbody.equations.programs import programs
        from nullbody.expr.casadi_writer import casadi_function

        return {p.name: casadi_function(p.name, p.tape, p.inputs, p.outputs) for p in programs(self)}

    def __str__(self) -> str:
        return summary(self)

    def __repr__(self) -> str:
        nq, nv = len(self.coordinates), len(self.independent)
        return f"<Equations of {self.mechanism.name!r}: nq = {nq}, nc = {len(self.labels)}, nv = {nv}>"
