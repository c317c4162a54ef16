"""What a value of the printed code is: a double, or a vector whose lanes hold one state each; and lines of LLVM IR.

The printers of programs and of sine and cosine speak of numbers only, so that one text serves both kinds of code.
"""

from __future__ import annotations

import ctypes
import struct
from dataclasses import dataclass

__all__ = ["BLOCK", "DOUBLE", "Lines", "Number"]

#: States of one block: input k of lane j of block b is in[(b * inputs + k) * BLOCK + j].
BLOCK = 8


@dataclass(frozen=True)
class Number:
    """A type of LLVM.

    Attributes:
        lanes: 1, or the length of the vector: a power of two up to BLOCK.
        bits: 64 for double, 32 for float.
    """

    lanes: int = 1
    bits: int = 64

    @property
    def element(self) -> str:
        """One lane: double or float."""
        return "double" if self.bits == 64 else "float"

    @property
    def text(self) -> str:
        """The type itself, e.g. <4 x double>."""
        return self._of(self.element)

    @property
    def integer(self) -> str:
        """Integers with as many lanes and bits."""
        return self._of(f"i{self.bits}")

    @property
    def truth(self) -> str:
        """What a comparison gives."""
        return self._of("i1")

    @property
    def pair(self) -> str:
        """Two of these numbers."""
        return f"{{ {self.text}, {self.text} }}"

    @property
    def suffix(self) -> str:
        """What LLVM appends to the name of an intrinsic function, e.g. v4f64."""
        return f"{'' if self.lanes == 1 else f'v{self.lanes}'}f{self.bits}"

    @property
    def wide(self) -> bool:
        """Whether it is a vector."""
        return self.lanes > 1

    @property
    def doubles(self) -> Number:
        """As many lanes of doubles."""
        return Number(self.lanes)

    def constant(self, value: float) -> str:
        """The value, exactly (rounded to float where that is the element), in all lanes."""
        rounded = value if self.bits == 64 else ctypes.c_float(value).value
        return self._all(f"0x{struct.unpack('<Q', struct.pack('<d', rounded))[0]:016X}", self.element)

    def whole(self, value: int) -> str:
        """An integer in all lanes."""
        return self._all(str(value), f"i{self.bits}")

    def _of(self, scalar: str) -> str:
        return scalar if self.lanes == 1 else f"<{self.lanes} x {scalar}>"

    def _all(self, text: str, scalar: str) -> str:
        return text if self.lanes == 1 else f"<{', '.join([f'{scalar} {text}'] * self.lanes)}>"


DOUBLE = Number()


class Lines:
    """Lines of LLVM IR with fresh names; arithmetic carries the flag `contract`: products may fuse into sums."""

    def __init__(self, number: Number) -> None:
        self.number = number
        self.lines: list[str] = []

    def __str__(self) -> str:
        return "\n".join(self.lines)

    def emit(self, text: str) -> str:
        """A new name for the value of an instruction."""
        name = f"%t{len(self.lines)}"
        self.lines.append(f"  {name} = {text}")
        return name

    def op(self, operation: str, a: str | float, b: str | float) -> str:
        """A floating-point operation of operands or constants."""
        left, right = (x if isinstance(x, str) else self.number.constant(x) for x in (a, b))
        return self.emit(f"{operation} contract {self.number.text} {left}, {right}")

    def add(self, a: str | float, b: str | float) -> str:
        """The sum a + b."""
        return self.op("fadd", a, b)

    def sub(self, a: str | float, b: str | float) -> str:
        """The difference a - b."""
        return self.op("fsub", a, b)

    def mul(self, a: str | float, b: str | float) -> str:
        """The product a b."""
        return self.op("fmul", a, b)

    def bits(self, operation: str, a: str, b: str | int) -> str:
        """An operation on integers."""
        right = b if isinstance(b, str) else self.number.whole(b)
        return self.emit(f"{operation} {self.number.integer} {a}, {right}")

    def intrinsic(self, function: str, x: str) -> str:
        """One of LLVM's own functions, lane by lane."""
        number = self.number
        return self.emit(f"call {number.text} @llvm.{function}.{number.suffix}({number.text} {x})")

    def choose(self, condition: str, a: str, b: str) -> str:
        """Lane by lane: a where the condition holds, else b."""
        number = self.number
        return self.emit(f"select {number.truth} {condition}, {number.text} {a}, {number.text} {b}")

    def integers(self, x: str) -> str:
        """The bits of a number."""
        return self.emit(f"bitcast {self.number.text} {x} to {self.number.integer}")

    def floats(self, x: str) -> str:
        """The number with these bits."""
        return self.emit(f"bitcast {self.number.integer} {x} to {self.number.text}")

    def both(self, a: str, b: str) -> str:
        """The pair (a, b)."""
        number = self.number
        half = self.emit(f"insertvalue {number.pair} poison, {number.text} {a}, 0")
        return self.emit(f"insertvalue {number.pair} {half}, {number.text} {b}, 1")

    def part(self, pair: str, index: int) -> str:
        """Element 0 or 1 of a pair."""
        return self.emit(f"extractvalue {self.number.pair} {pair}, {index}")
