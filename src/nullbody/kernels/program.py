"""A program: a tape whose inputs and outputs are grouped into named vectors and arrays."""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import prod

from nullbody.errors import InputError
from nullbody.expr.tape import Tape

__all__ = ["Program"]


@dataclass(frozen=True)
class Program:
    """A straight-line program with a signature, e.g. forward(q[11], v[3], p[9]) -> (a[11], M[11, 11]).

    Attributes:
        name: a C identifier; the native function is called nb_<name>.
        inputs: (group name, size) of every input vector; the tape's inputs are these groups one after the other.
        outputs: (group name, shape) of every result; the tape's outputs are these arrays one after the other,
            each row by row.
        tape: the operations.

    Raises:
        InputError: the name is no identifier, a group name is used twice, or the sizes do not fit the tape.
    """

    name: str
    inputs: tuple[tuple[str, int], ...]
    outputs: tuple[tuple[str, tuple[int, ...]], ...]
    tape: Tape

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", self.name):
            raise InputError(
                f"a program cannot be named {self.name!r}: use letters, digits and _ (it names a C function)"
            )
        for kind, groups in (("input", [g for g, _ in self.inputs]), ("output", [g for g, _ in self.outputs])):
            if twice := sorted({g for g in groups if groups.count(g) > 1}):
                raise InputError(
                    f"program {self.name!r} has the {kind} group {twice[0]!r} twice; group names are unique"
                )
        self._match("input", dict(self.inputs), len(self.tape.inputs))
        self._match("output", {g: prod(shape) for g, shape in self.outputs}, len(self.tape.outputs))

    def _match(self, kind: str, sizes: dict[str, int], available: int) -> None:
        if sum(sizes.values()) != available or min(sizes.values(), default=0) < 0:
            listed = " + ".join(f"{g}[{size}]" for g, size in sizes.items()) or "none"
            needed = sum(sizes.values())
            raise InputError(
                f"program {self.name!r}: the {kind} groups {listed} need {needed} {kind}s, the tape has {available}"
            )
