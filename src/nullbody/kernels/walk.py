"""A tape written operation by operation, in the order and with the signs that every printer of native code shares.

    values[k] = (text, sign):   slot k is (-1)^sign text

Products and reciprocals pass signs on, sums become differences: a negation costs nothing but where a root or a result
needs it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from nullbody.expr.tape import Tape

__all__ = ["LEAVES", "Walk", "Writer", "operands"]

_BINARY = ("add", "sub", "mul")

#: Operations without operands.
LEAVES = ("symbol", "const")


class Writer(Protocol):
    """What a language has to offer: each method gives the text of a value, and writes whatever it takes to have it."""

    def constant(self, value: float) -> str:
        """The text of a constant."""

    def symbol(self, index: int) -> str:
        """The text of input `index`."""

    def add(self, a: str, b: str) -> str:
        """The sum a + b."""

    def sub(self, a: str, b: str) -> str:
        """The difference a - b."""

    def mul(self, a: str, b: str) -> str:
        """The product a b."""

    def negative(self, a: str) -> str:
        """The opposite -a."""

    def inverse(self, a: str) -> str:
        """The reciprocal 1 / a."""

    def sqrt(self, a: str) -> str:
        """The square root."""

    def sin(self, a: str) -> str:
        """The sine."""

    def cos(self, a: str) -> str:
        """The cosine."""


def operands(operation: tuple[str, int, int]) -> tuple[int, ...]:
    """The slots that an operation of a tape reads, the right one first."""
    op, a, b = operation
    return (b >> 1, a >> 1) if op in _BINARY else () if op in LEAVES else (a >> 1,)


class Walk:
    """Writes a tape; `values[k]` is (text, sign bit) of slot k once it is written."""

    def __init__(self, tape: Tape, writer: Writer) -> None:
        self.tape = tape
        self.writer = writer
        self.values: dict[int, tuple[str, int]] = {}

    def missing(self, slot: int) -> Iterator[int]:
        """The slots that a slot needs and that are not written yet, operands first, itself last.

        Asked for output after output, that order (depth first) keeps few values alive at a time. The caller writes
        every slot that it is given before it asks for the next one.
        """
        code, values = self.tape.code, self.values
        stack = [slot]
        while stack:
            top = stack[-1]
            if top in values:
                stack.pop()
                continue
            if waiting := [k for k in operands(code[top]) if k not in values]:
                stack += waiting
            else:
                stack.pop()
                yield top

    def write(self, slot: int) -> None:
        """Write the operation of a slot whose operands are written."""
        self.values[slot] = self._operation(slot)

    def plain(self, ref: int) -> str:
        """The text of a reference, its sign carried out."""
        text, sign = self._read(ref)
        return self.writer.negative(text) if sign else text

    def _operation(self, slot: int) -> tuple[str, int]:
        op, a, b = self.tape.code[slot]
        if op == "const":
            return self.writer.constant(self.tape.constants[a]), 0
        if op == "symbol":
            return self.writer.symbol(a), 0
        if op in _BINARY:
            return self._binary(op, a, b)
        if op == "sqrt":
            return self.writer.sqrt(self.plain(a)), 0
        text, sign = self._read(a)
        if op == "inv":
            return self.writer.inverse(text), sign
        return (self.writer.cos(text), 0) if op == "cos" else (self.writer.sin(text), sign)

    def _binary(self, op: str, a: int, b: int) -> tuple[str, int]:
        left, s = self._read(a)
        right, t = self._read(b ^ (op == "sub"))
        if op == "mul":
            return self.writer.mul(left, right), s ^ t
        if s and not t:
            left, right = right, left
        return (self.writer.add if s == t else self.writer.sub)(left, right), s & t

    def _read(self, ref: int) -> tuple[str, int]:
        text, sign = self.values[ref >> 1]
        return text, sign ^ ref & 1
