"""Lines of LLVM IR for vectors in memory: loops, loads and stores, one vector of 8 lanes after the other."""

from __future__ import annotations

from collections.abc import Callable

from nullbody.kernels.number import BLOCK, Lines, Number

__all__ = ["LANES", "VECTOR", "Loops"]

#: A vector of doubles, one for each lane of a block.
LANES = Number(BLOCK)

#: Its type.
VECTOR = LANES.text

_WHOLE = LANES.integer


class Loops(Lines):
    """Lines with loops and memory of vectors; names of blocks are fresh as well."""

    def __init__(self) -> None:
        super().__init__(LANES)

    def write(self, text: str) -> None:
        """An instruction without a value."""
        self.lines.append(f"  {text}")

    def loop(self, count: str, body: Callable[[str], object]) -> None:
        """body(k) for k = 0 ... count - 1."""
        name = f"loop{len(self.lines)}"
        self.lines.append(f"  br label %{name}.from\n{name}.from:\n  br label %{name}\n{name}:")
        self.lines.append(f"  %{name}.k = phi i64 [0, %{name}.from], [%{name}.next, %{name}.back]")
        self.lines.append(f"  %{name}.more = icmp slt i64 %{name}.k, {count}")
        self.lines.append(f"  br i1 %{name}.more, label %{name}.body, label %{name}.end\n{name}.body:")
        body(f"%{name}.k")
        self.lines.append(f"  br label %{name}.back\n{name}.back:\n  %{name}.next = add i64 %{name}.k, 1")
        self.lines.append(f"  br label %{name}\n{name}.end:")

    def where(self, condition: str, body: Callable[[], None]) -> None:
        """The body where a truth value i1 holds."""
        name = f"if{len(self.lines)}"
        self.lines.append(f"  br i1 {condition}, label %{name}, label %{name}.end\n{name}:")
        body()
        self.lines.append(f"  br label %{name}.end\n{name}.end:")

    def place(self, base: str, index: str | int, kind: str = VECTOR) -> str:
        """Where element `index` of an array is."""
        return self.emit(f"getelementptr {kind}, ptr {base}, i64 {index}")

    def load(self, base: str, index: str | int = 0, kind: str = VECTOR) -> str:
        """Element `index` of an array."""
        return self.emit(f"load {kind}, ptr {self.place(base, index, kind)}, align 8")

    def store(self, value: str, base: str, index: str | int = 0, kind: str = VECTOR) -> None:
        """Put element `index` of an array."""
        self.write(f"store {kind} {value}, ptr {self.place(base, index, kind)}, align 8")

    def load_whole(self, base: str, index: str | int = 0) -> str:
        """A vector of integers."""
        return self.load(base, index, _WHOLE)

    def store_whole(self, value: str, base: str, index: str | int = 0) -> None:
        """Put a vector of integers."""
        self.store(value, base, index, _WHOLE)

    def spread(self, scalar: str) -> str:
        """A double in all lanes."""
        one = self.emit(f"insertelement {VECTOR} poison, double {scalar}, i32 0")
        return self.emit(f"shufflevector {VECTOR} {one}, {VECTOR} poison, <{BLOCK} x i32> zeroinitializer")

    def compare(self, relation: str, a: str | float, b: str | float) -> str:
        """Lane by lane whether a relation holds; ordered ones never hold for NaN."""
        left, right = (x if isinstance(x, str) else LANES.constant(x) for x in (a, b))
        return self.emit(f"fcmp {relation} {VECTOR} {left}, {right}")

    def both_true(self, a: str, b: str) -> str:
        """Lane by lane a and b."""
        return self.emit(f"and {LANES.truth} {a}, {b}")

    def untrue(self, a: str) -> str:
        """Lane by lane not a."""
        return self.emit(f"xor {LANES.truth} {a}, {LANES._all('true', 'i1')}")

    def any_lane(self, a: str) -> str:
        """Whether it is true in some lane, as i1."""
        mask = self.emit(f"bitcast {LANES.truth} {a} to i{BLOCK}")
        return self.emit(f"icmp ne i{BLOCK} {mask}, 0")

    def zero_whole(self, a: str) -> str:
        """Lane by lane whether an integer is 0."""
        return self.emit(f"icmp eq {_WHOLE} {a}, zeroinitializer")

    def choose_whole(self, condition: str, a: str, b: str) -> str:
        """Lane by lane an integer a where the condition holds, else b."""
        return self.emit(f"select {LANES.truth} {condition}, {_WHOLE} {a}, {_WHOLE} {b}")

    def whole_sum(self, a: str, b: str) -> str:
        """Lane by lane the sum of integers."""
        return self.emit(f"add {_WHOLE} {a}, {b}")

    def counted(self, condition: str) -> str:
        """1 in the lanes where the condition holds, else 0."""
        return self.emit(f"zext {LANES.truth} {condition} to {_WHOLE}")

    def spread_whole(self, scalar: str) -> str:
        """An integer i64 in all lanes."""
        one = self.emit(f"insertelement {_WHOLE} poison, i64 {scalar}, i32 0")
        return self.emit(f"shufflevector {_WHOLE} {one}, {_WHOLE} poison, <{BLOCK} x i32> zeroinitializer")

    def two(self, function: str, a: str, b: str) -> str:
        """One of LLVM's functions of two numbers, lane by lane."""
        return self.emit(f"call {VECTOR} @llvm.{function}.{LANES.suffix}({VECTOR} {a}, {VECTOR} {b})")
