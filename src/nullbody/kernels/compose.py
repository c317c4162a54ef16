"""A program made of others: chosen outputs, several programs in one, one program's outputs as inputs of another.

Slots that compute the same from the same are merged: parts of one graph share what they have in common, as if they had
been written together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod

from nullbody.errors import UnknownName
from nullbody.expr.tape import Tape
from nullbody.kernels.program import Program

__all__ = ["Composer", "part"]

_COMMUTATIVE = ("add", "mul")
_BINARY = ("add", "sub", "mul")
_LEAVES = ("symbol", "const")


def part(program: Program, outputs: Sequence[str], name: str = "") -> Program:
    """The same program with some of its output groups, in the given order.

    Raises:
        UnknownName: an output group does not exist.
    """
    composer = Composer(name or program.name, program.inputs)
    results, shapes = composer.call(program), dict(program.outputs)
    for output in outputs:
        if output not in shapes:
            raise UnknownName("output", output, shapes, f"program {program.name!r}")
    return composer.program({output: (shapes[output], results[output]) for output in outputs})


class Composer:
    """Puts programs together; values are references 2 slot + sign, as in a tape.

    Args:
        name: of the program that is made.
        inputs: its groups (name, size), one after the other.
    """

    def __init__(self, name: str, inputs: Sequence[tuple[str, int]]) -> None:
        self.name = name
        self.inputs = tuple(inputs)
        self._names = tuple(f"{group}[{k}]" for group, size in inputs for k in range(size))
        self._code: list[tuple[str, int, int]] = []
        self._constants: list[float] = []
        self._slots: dict[tuple[object, ...], int] = {}
        self._groups: dict[str, list[int]] = {}
        start = 0
        for group, size in inputs:
            self._groups[group] = [2 * self._slot("symbol", start + k, 0) for k in range(size)]
            start += size

    def group(self, name: str) -> list[int]:
        """The references of an input group.

        Raises:
            UnknownName: there is no such group.
        """
        if name not in self._groups:
            raise UnknownName("input group", name, self._groups, f"program {self.name!r}")
        return self._groups[name]

    def call(self, program: Program, given: Mapping[str, Sequence[int]] | None = None) -> dict[str, list[int]]:
        """Evaluate a program.

        Args:
            program: the program.
            given: references for some of its input groups; the others are the groups of this program by that name.

        Returns:
            For every output group the references of its entries, row by row.

        Raises:
            UnknownName: an input group is neither given nor one of this program.
        """
        values = dict(given or {})
        arguments = [
            r for group, _ in program.inputs for r in (values[group] if group in values else self.group(group))
        ]
        refs: list[int] = []  # of the program's slots

        def moved(ref: int) -> int:
            return refs[ref >> 1] ^ (ref & 1)

        for op, a, b in program.tape.code:
            if op == "symbol":
                refs.append(arguments[a])
            elif op == "const":
                refs.append(2 * self._constant(program.tape.constants[a]))
            else:
                refs.append(2 * self._slot(op, moved(a), moved(b) if op in _BINARY else 0))
        results, start = {}, 0
        for group, shape in program.outputs:
            results[group] = [moved(ref) for ref in program.tape.outputs[start : start + prod(shape)]]
            start += prod(shape)
        return results

    def program(self, outputs: Mapping[str, tuple[tuple[int, ...], Sequence[int]]]) -> Program:
        """The program of some outputs {group: (shape, references)}, without what they do not need."""
        wanted = [ref for _, refs in outputs.values() for ref in refs]
        needed = self._needed(wanted)
        place = {slot: k for k, slot in enumerate(needed)}

        def moved(ref: int) -> int:
            return 2 * place[ref >> 1] | ref & 1

        code = tuple(
            (op, a, b) if op in _LEAVES else (op, moved(a), moved(b) if op in _BINARY else 0)
            for op, a, b in (self._code[slot] for slot in needed)
        )
        shapes = tuple((group, shape) for group, (shape, _) in outputs.items())
        return Program(
            self.name, self.inputs, shapes, Tape(self._names, tuple(self._constants), code, tuple(map(moved, wanted)))
        )

    def _needed(self, refs: Sequence[int]) -> list[int]:
        """The slots that references need, in order."""
        seen: set[int] = set()
        stack = [ref >> 1 for ref in refs]
        while stack:
            slot = stack.pop()
            if slot in seen:
                continue
            seen.add(slot)
            op, a, b = self._code[slot]
            if op not in _LEAVES:
                stack += [a >> 1, b >> 1] if op in _BINARY else [a >> 1]
        return sorted(seen)

    def _slot(self, op: str, a: int, b: int) -> int:
        key = (op, min(a, b), max(a, b)) if op in _COMMUTATIVE else (op, a, b)
        if key not in self._slots:
            self._slots[key] = len(self._code)
            self._code.append((op, a, b))
        return self._slots[key]

    def _constant(self, value: float) -> int:
        key = ("value", value.hex())  # 0.0 and -0.0 differ
        if key not in self._slots:
            self._slots[key] = len(self._constants)
            self._constants.append(value)
        return self._slot("const", self._slots[key], 0)
