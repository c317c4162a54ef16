"""Tapes as LLVM IR text, for one state (double) or for blocks of them (vectors).

Every program becomes `void nb_<name>(double* in, double* out)`, and where asked a function over blocks of 8 states,
`void nb_<name>_wide(in, out, int64 blocks)` for doubles or `nb_<name>_wide32` for floats: the same body with vectors
for numbers, called once for every vector of a block. Additions and multiplications carry the flag `contract`, so that
the code generator forms fused multiply-adds. Signs cost nothing where IEEE allows: a printed value is an operand with
a sign, products and reciprocals pass signs on, sums become differences.
"""

from __future__ import annotations

from collections.abc import Sequence

from nullbody.kernels.number import BLOCK, Lines, Number
from nullbody.kernels.program import Program
from nullbody.kernels.trigonometry import WEIGHTS, sincos_ir, sincos_name
from nullbody.kernels.walk import Walk

__all__ = ["function_name", "module_ir"]

#: Slots in one basic block. LLVM takes 0.1 to 0.2 ms for each up to there, and ever longer beyond.
_PIECE = 1000

#: Results in one basic block: LLVM looks at them in pairs, constants too. A matrix of 80 x 121 costs 1.6 s, not 23.
_RESULTS = 300


def function_name(program: Program, number: Number) -> str:
    """Name of the native function of a program for one state, or over blocks where the number is a vector."""
    return f"nb_{program.name}" + (("_wide" if number.bits == 64 else "_wide32") if number.wide else "")


def module_ir(functions: Sequence[tuple[Program, Number]], triple: str, layout: str) -> str:
    """One LLVM module of native functions.

    Args:
        functions: programs and the numbers that they are printed for; no pair twice, and no two programs of one name.
        triple: LLVM's name of the target.
        layout: LLVM's data layout of the target.
    """
    numbers = {number for _, number in functions}
    angular = {number for program, number in functions if any(op in ("sin", "cos") for op, _, _ in program.tape.code)}
    parts = [f'target datalayout = "{layout}"\ntarget triple = "{triple}"']
    parts += sorted(f"declare {n.text} @llvm.sqrt.{n.suffix}({n.text})" for n in numbers)
    parts += sorted(sincos_ir(number) for number in angular | {number.doubles for number in angular})
    parts += [_Printer(program, number).functions() for program, number in functions]
    return "\n".join([*parts, WEIGHTS, ""])


class _Printer:
    """Prints one program: it is the writer of the walk along the tape."""

    def __init__(self, program: Program, number: Number) -> None:
        self.program = program
        self.number = number
        self.ir = Lines(number)
        self.walk = Walk(program.tape, self)
        self.angles: dict[str, str] = {}

    def functions(self) -> str:
        """The body, and for vectors the loop over blocks around it."""
        name = function_name(self.program, self.number)
        if not self.number.wide:
            return self._body(f"void @{name}", "nounwind")
        # without the alignment half of the spilled vectors cross a line of the cache: 3 to 15 % of the time
        return self._body(f"internal void @nbt.{name}", "nounwind alignstack(64)") + self._loop(name)

    def _body(self, head: str, attributes: str) -> str:
        """The program for one number: output after output, each one stored as soon as it is known.

        That order (depth first) keeps few values alive at a time: up to a third less time for one state, and 6 %
        for vectors, than the tape's own order.
        """
        self.ir.lines.append("  %never = icmp eq ptr %out, null")
        for k, ref in enumerate(self.program.tape.outputs):
            for slot in self.walk.missing(ref >> 1):
                self.walk.write(slot)
                if len(self.walk.values) % _PIECE == 0:
                    self._cut(f"slot{len(self.walk.values)}")
            value = self.walk.plain(ref)
            place = self._place("%out", k)
            self.ir.lines.append(f"  store {self.number.text} {value}, ptr {place}, align {self.number.bits // 8}")
            if (k + 1) % _RESULTS == 0:
                self._cut(f"result{k + 1}")
        end = "  br label %end\nend:\n  ret void\n}\n"
        return f"define {head}(ptr noalias %in, ptr noalias %out) {attributes} {{\n{self.ir}\n{end}"

    def _cut(self, after: str) -> None:
        """Begin another basic block, by a branch that LLVM cannot leave out; it works on blocks one at a time."""
        self.ir.lines.append(f"  br i1 %never, label %end, label %after.{after}\nafter.{after}:")

    def _loop(self, name: str) -> str:
        """Calls the body for the vectors of all blocks, one after the other."""
        passes, element = BLOCK // self.number.lanes, self.number.element
        sizes = {"in": BLOCK * len(self.program.tape.inputs), "out": BLOCK * len(self.program.tape.outputs)}
        places = "".join(
            f"""  %{way}.block = mul i64 %block, {size}
  %{way}.offset = add i64 %{way}.block, %lane
  %{way}.place = getelementptr {element}, ptr %{way}, i64 %{way}.offset
"""
            for way, size in sizes.items()
        )
        return f"""define void @{name}(ptr %in, ptr %out, i64 %blocks) nounwind {{
start:
  %count = mul i64 %blocks, {passes}
  %some = icmp sgt i64 %count, 0
  br i1 %some, label %vector, label %end
vector:
  %k = phi i64 [0, %start], [%next, %vector]
  %block = udiv i64 %k, {passes}
  %pass = urem i64 %k, {passes}
  %lane = mul i64 %pass, {self.number.lanes}
{places}  call void @nbt.{name}(ptr %in.place, ptr %out.place)
  %next = add i64 %k, 1
  %more = icmp slt i64 %next, %count
  br i1 %more, label %vector, label %end
end:
  ret void
}}
"""

    def _place(self, base: str, index: int) -> str:
        """Where input or output `index` is."""
        offset = index * BLOCK if self.number.wide else index
        return self.ir.emit(f"getelementptr {self.number.element}, ptr {base}, i64 {offset}")

    # -- what the walk asks for --------------------------------------------------------------------------------

    def constant(self, value: float) -> str:
        """A constant in all lanes."""
        return self.number.constant(value)

    def symbol(self, index: int) -> str:
        """Load an input."""
        place = self._place("%in", index)
        return self.ir.emit(f"load {self.number.text}, ptr {place}, align {self.number.bits // 8}")

    def add(self, a: str, b: str) -> str:
        """A sum."""
        return self.ir.add(a, b)

    def sub(self, a: str, b: str) -> str:
        """A difference."""
        return self.ir.sub(a, b)

    def mul(self, a: str, b: str) -> str:
        """A product."""
        return self.ir.mul(a, b)

    def negative(self, a: str) -> str:
        """The opposite."""
        return self.ir.emit(f"fneg {self.number.text} {a}")

    def inverse(self, a: str) -> str:
        """A reciprocal, which never fuses."""
        return self.ir.emit(f"fdiv {self.number.text} {self.number.constant(1.0)}, {a}")

    def sqrt(self, a: str) -> str:
        """LLVM's own root."""
        return self.ir.intrinsic("sqrt", a)

    def sin(self, a: str) -> str:
        """The first half of the pair."""
        return self.ir.part(self._pair(a), 0)

    def cos(self, a: str) -> str:
        """The second half of the pair."""
        return self.ir.part(self._pair(a), 1)

    def _pair(self, angle: str) -> str:
        """Sine and cosine of an angle, called for once."""
        if angle not in self.angles:
            self.angles[angle] = self.ir.emit(
                f"call {self.number.pair} {sincos_name(self.number)}({self.number.text} {angle})"
            )
        return self.angles[angle]
