"""Programs as C99: straight-line functions, one declaration a value, no allocation, no globals; libm: sin, cos, sqrt.

    void <prefix>_<program>(const double *q, const double *v, ..., double *q_ddot, ...)

A long program becomes static functions, called one after the other, so that the compiler's time stays linear. Values
that later parts need are handed on in an array of the function, whose places are used again.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import prod
from typing import Literal, cast

from nullbody.errors import InputError
from nullbody.kernels.c_name import check_prefix, identifiers
from nullbody.kernels.program import Program
from nullbody.kernels.walk import LEAVES, Walk, operands

__all__ = ["Real", "c_constant", "c_functions", "call_text", "checked_real", "comment_text"]

Real = Literal["double", "float"]

#: Operations and results of one function: gcc -O1 takes 0.1 to 0.2 ms for each, in longer functions ever more.
_PART = 1500

#: Columns of the printed text.
_WIDTH = 110

_WORK = "w"


def checked_real(real: str) -> Real:
    """The type of numbers, if C code is printed for it.

    Raises:
        InputError: it is neither "double" nor "float".
    """
    if real not in ("double", "float"):
        raise InputError(f"C code is printed for double or float, not for {real!r}")
    return cast(Real, real)


def c_constant(value: float, real: Real = "double") -> str:
    """A finite number as a C constant with all its digits; of floats the shortest text that rounds to it, with f.

    Raises:
        InputError: the number is not finite, or too large for a float.
    """
    rounded = value if real == "double" else ctypes.c_float(value).value
    if not math.isfinite(rounded):
        raise InputError(f"the number {value!r} has no value as a {real} of C")
    if real == "double":
        text = repr(float(value))
    else:
        text = next(
            t for digits in range(1, 10) if ctypes.c_float(float(t := f"{rounded:.{digits}g}")).value == rounded
        )
    return (text if set(text) & set(".e") else f"{text}.0") + ("" if real == "double" else "f")


def c_functions(programs: Sequence[Program], prefix: str, real: Real = "double") -> tuple[str, str]:
    """Programs as functions of C99, `void <prefix>_<program>(inputs, outputs)`.

    Every input group is a pointer to const, every output group a pointer, in the order of the program; matrices lie row
    by row. Groups of size 0 keep their place, and may be NULL. Outputs must not overlap inputs.

    Args:
        programs: what to print; their names differ.
        prefix: what every name begins with.
        real: type of all numbers.

    Returns:
        The declarations, and the definitions, which need <math.h>.

    Raises:
        InputError: a bad prefix or type, two programs of one name, or a constant that the type cannot hold.
    """
    check_prefix(prefix)
    checked_real(real)
    names = [program.name for program in programs]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise InputError(f"two programs are named {twice[0]!r}; the names of programs printed together differ")
    functions = [_Function(program, prefix, real, names) for program in programs]
    return "\n".join(f"{f.head};\n" for f in functions), "\n".join(f.text() for f in functions)


@dataclass
class _Part:
    """Some lines that become one function, and the names of the arguments that they use."""

    lines: list[str] = field(default_factory=list)
    used: set[str] = field(default_factory=set)
    known: set[int] = field(default_factory=set)


class _Function:
    """Prints one program: events are slots and results in the order of the walk, cut into parts."""

    def __init__(self, program: Program, prefix: str, real: Real, names: Sequence[str]) -> None:
        self.program, self.real = program, real
        self.walk = Walk(program.tape, self)
        self.name = f"{prefix}_{program.name}"
        self.stem = f"{self.name}_part"
        while any(f"{prefix}_{name}".startswith(self.stem) for name in names):
            self.stem += "_"
        groups = [name for name, _ in program.inputs] + [name for name, _ in program.outputs]
        locals_ = {f"t{k}" for k in range(len(program.tape.code) + 1)} | {_WORK}
        self.groups = identifiers(groups, locals_)
        self.reads = self._places(self.groups, [size for _, size in program.inputs])
        self.writes = self._places(self.groups[len(program.inputs) :], [prod(shape) for _, shape in program.outputs])
        inputs = [f"const {real} *{group}" for group in self.groups[: len(program.inputs)]]
        outputs = [f"{real} *{group}" for group in self.groups[len(program.inputs) :]]
        self.arguments = dict(zip(self.groups, inputs + outputs, strict=True))
        self.head = call_text(f"void {self.name}", list(self.arguments.values()) or ["void"])
        self.part = _Part()

    @staticmethod
    def _places(groups: Sequence[str], sizes: Sequence[int]) -> list[tuple[str, int]]:
        return [(group, k) for group, size in zip(groups, sizes, strict=False) for k in range(size)]

    # -- what the walk asks for: the text of values; every operation becomes a declaration ---------------------

    def _emit(self, text: str) -> str:
        name = f"t{len(self.walk.values)}"
        self.part.lines.append(f"const {self.real} {name} = {text};")
        return name

    def constant(self, value: float) -> str:
        """A constant stands where it is used."""
        return c_constant(value, self.real)

    def symbol(self, index: int) -> str:
        """An input is read where a part first needs it."""
        return f"t{len(self.walk.values)}"

    def add(self, a: str, b: str) -> str:
        """A sum."""
        return self._emit(f"{a} + {b}")

    def sub(self, a: str, b: str) -> str:
        """A difference."""
        return self._emit(f"{a} - {b}")

    def mul(self, a: str, b: str) -> str:
        """A product."""
        return self._emit(f"{a} * {b}")

    def negative(self, a: str) -> str:
        """The opposite."""
        return f"-{a}"

    def inverse(self, a: str) -> str:
        """A reciprocal."""
        return self._emit(f"{c_constant(1.0, self.real)} / {a}")

    def sqrt(self, a: str) -> str:
        """A root."""
        return self._emit(f"{self._libm('sqrt')}({a})")

    def sin(self, a: str) -> str:
        """A sine."""
        return self._emit(f"{self._libm('sin')}({a})")

    def cos(self, a: str) -> str:
        """A cosine."""
        return self._emit(f"{self._libm('cos')}({a})")

    def _libm(self, function: str) -> str:
        return function if self.real == "double" else f"{function}f"

    # -- the function ------------------------------------------------------------------------------------------

    def text(self) -> str:
        """The definition, its parts before it."""
        parts, size = self._parts()
        if len(parts) == 1:
            return self._body(self.head, parts[0], self.arguments)
        shared = {**self.arguments, _WORK: f"{self.real} *{_WORK}"}
        texts, calls = [], [f"{self.real} {_WORK}[{max(1, size)}];"]
        for k, part in enumerate(parts, 1):
            arguments = {name: text for name, text in shared.items() if name in part.used}
            head = call_text(f"static void {self.stem}{k}", list(arguments.values()) or ["void"])
            texts.append(self._body(head, part, arguments))
            calls.append(call_text(f"{self.stem}{k}", list(arguments), "    ") + ";")
        used = set().union(*(part.used for part in parts))
        texts.append(self._body(self.head, _Part(calls, used), self.arguments))
        return "\n".join(texts)

    def _body(self, head: str, part: _Part, arguments: dict[str, str]) -> str:
        unused = [f"(void){name};" for name in arguments if name not in part.used]
        return "\n".join([head, "{", *(f"    {line}" for line in [*unused, *part.lines]), "}", ""])

    def _parts(self) -> tuple[list[_Part], int]:
        """The parts, and the places of the array that hands values on."""
        events = self._events()
        pieces = [events[k : k + _PART] for k in range(0, len(events), _PART)] or [[]]
        last = {slot: k for k, piece in enumerate(pieces) for event in piece for slot in self._needs(event)}
        places, free, size = dict[int, int](), list[int](), 0
        self.walk.values.clear()
        parts = []
        for k, piece in enumerate(pieces):
            self.part = _Part()
            parts.append(self.part)
            for slot, result in piece:
                for needed in self._needs((slot, result)):
                    self._declare(needed, places)
                if result >= 0:
                    self._store(result)
                    continue
                self.walk.write(slot)
                if self._op(slot) in LEAVES:
                    continue
                self.part.known.add(slot)
                if last[slot] > k:
                    places[slot] = free.pop() if free else size
                    size = max(size, places[slot] + 1)
                    self.part.lines.append(f"{_WORK}[{places[slot]}] = {self.walk.values[slot][0]};")
                    self.part.used.add(_WORK)
            free += [place for slot, place in places.items() if last[slot] == k]
        return parts, size

    def _events(self) -> list[tuple[int, int]]:
        """(slot, -1) for an operation, (-1, k) for result k."""
        events = []
        for k, ref in enumerate(self.program.tape.outputs):
            for slot in self.walk.missing(ref >> 1):
                self.walk.values[slot] = ("", 0)
                events.append((slot, -1))
            events.append((-1, k))
        return events

    def _op(self, slot: int) -> str:
        return self.program.tape.code[slot][0]

    def _needs(self, event: tuple[int, int]) -> list[int]:
        """The slots that an event reads."""
        slot, result = event
        read = (self.program.tape.outputs[result] >> 1,) if result >= 0 else operands(self.program.tape.code[slot])
        return [k for k in read if self._op(k) != "const"]

    def _declare(self, slot: int, places: dict[int, int]) -> None:
        """Read an input or a handed-on value that this part does not know yet."""
        if slot in self.part.known:
            return
        self.part.known.add(slot)
        name, note = self.walk.values[slot][0], ""
        if slot in places:
            group, index = _WORK, places[slot]
        else:
            source = self.program.tape.code[slot][1]
            group, index = self.reads[source]
            note = f" /* {comment_text(self.program.tape.inputs[source])} */"
        self.part.used.add(group)
        self.part.lines.append(f"const {self.real} {name} = {group}[{index}];{note}")

    def _store(self, result: int) -> None:
        group, index = self.writes[result]
        self.part.used.add(group)
        self.part.lines.append(f"{group}[{index}] = {self.walk.plain(self.program.tape.outputs[result])};")


def comment_text(text: str) -> str:
    """A text that cannot end a comment of C."""
    return (
        text.encode("ascii", "backslashreplace").decode().replace("*/", "* /").replace("/*", "/ *").replace("\n", " ")
    )


def call_text(name: str, arguments: Sequence[str], indent: str = "") -> str:
    """`name(arguments)`, in as many lines as it takes."""
    if not arguments:
        return f"{name}()"
    lines, line = [], f"{name}("
    for k, argument in enumerate(arguments):
        piece = argument + (")" if k + 1 == len(arguments) else ",")
        if len(line) + len(piece) + 1 > _WIDTH and not line.endswith("("):
            lines.append(line)
            line = f"{indent}    {piece}"
        else:
            line += piece if line.endswith("(") else f" {piece}"
    return "\n".join([*lines, line])
