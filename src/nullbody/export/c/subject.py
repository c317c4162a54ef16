"""What is printed as C: a model, the name that everything begins with, the type of numbers; and what groups mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import prod

from nullbody.kernels import Program
from nullbody.kernels.c99 import Real, call_text
from nullbody.kernels.c_name import identifiers
from nullbody.mechanism import Parameter
from nullbody.model import Model

__all__ = ["Subject", "all_of"]


def all_of(conditions: Sequence[str]) -> str:
    """Conditions that must all hold, one a line where they are many."""
    return (" && " if len(conditions) < 3 else " &&\n        ").join(conditions)


@dataclass(frozen=True, eq=False)
class Subject:
    """A model on its way to C.

    Attributes:
        model: what is printed, with its parameter values.
        prefix: what every name begins with.
        real: type of all numbers.
    """

    model: Model
    prefix: str
    real: Real

    @property
    def macro(self) -> str:
        """What the names of macros begin with."""
        return self.prefix.upper()

    @property
    def kernel_prefix(self) -> str:
        """What the names of the plain functions begin with."""
        return f"{self.prefix}_kernel"

    @cached_property
    def programs(self) -> dict[str, Program]:
        """The routines by name, and `residual`: the closures without their derivatives."""
        found = {name: kernel.program for name, kernel in self.model.library.kernels.items()}
        closure = found["closure"]
        name, shape = closure.outputs[0]
        tape = replace(closure.tape, outputs=closure.tape.outputs[: prod(shape)])
        found["residual"] = Program("residual", closure.inputs, ((name, shape),), tape)
        return found

    @cached_property
    def parameters(self) -> list[tuple[str, Parameter, float]]:
        """(field of the structure, parameter, value) in the order of p."""
        known = self.model.mechanism.parameters
        names = [parameter.name for parameter in known]
        macros = [name for name in names if name.startswith(f"{self.macro}_")]  # the header may define them
        fields = identifiers(names, macros)
        return list(zip(fields, known, self.model.values, strict=True))

    def size(self, group: str) -> int:
        """Length of an input group."""
        return next(size for program in self.programs.values() for name, size in program.inputs if name == group)

    def head(self, name: str, inputs: Sequence[str], outputs: Sequence[str]) -> str:
        """The head of a safe function: parameters, the time where it enters, inputs that are not empty, outputs."""
        arguments = [f"const {self.prefix}_params *params"]
        arguments += [f"{self.real} t"] if self.model.rheonomic else []
        arguments += [f"const {self.real} *{group}" for group in inputs if self.size(group)]
        return call_text(f"{self.prefix}_status {self.prefix}_{name}", [*arguments, *outputs])

    def call(self, routine: str, given: Sequence[str]) -> str:
        """A call of a kernel whose inputs are arguments, p, or arrays found before, and whose results are found_*."""
        program = self.programs[routine]
        known = {**{group: group for group in given}, "p": "p", "t": "&t"}
        arguments = [known.get(group, f"found_{group}") if size else "NULL" for group, size in program.inputs]
        arguments += [f"found_{key}" if prod(shape) else "NULL" for key, shape in program.outputs]
        return call_text(f"{self.kernel_prefix}_{routine}", arguments, "        ") + ";"

    def arrays(self, found: Mapping[str, int]) -> list[str]:
        """Declarations of local arrays for what kernels find."""
        return [f"{self.real} found_{key}[{size}];" for key, size in found.items() if size]

    def finite(self, groups: Sequence[str]) -> str:
        """The condition that inputs, parameters and the time are finite."""
        checks = [(group, self.size(group)) for group in (*groups, "p")]
        checks += [("&t", 1)] if self.model.rheonomic else []
        return all_of([f"({self.prefix}_finite({name}, {size}) != 0)" for name, size in checks if size]) or "1"

    def entries(self, group: str) -> list[tuple[str, str]]:
        """(name, unit) of every entry of q, v or u, in order."""
        model, units = self.model, self.model.mechanism.units
        if group == "q":
            return [(name, units[name] or "1") for name in model.coordinates]
        if group == "v":
            return [(f"{name}_dot", f"{units[name] or '1'}/s") for name in model.independent]
        forces = {"m": "N", "rad": "N m"}
        acting = zip(model.inputs, model.mechanism.actuated, strict=True)
        return [(name, forces.get(units[along], "N m")) for name, along in acting]
