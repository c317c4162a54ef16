"""Tapes as LLVM IR text for double.

Every program becomes `void nb_<name>(double* in, double* out)`. Additions and multiplications carry the flag
`contract`, so that the code generator forms fused multiply-adds. Signs cost nothing where IEEE allows: a printed
value is an operand with a sign, products and reciprocals pass signs on, sums become differences.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from nullbody.kernels.program import Program
from nullbody.kernels.trigonometry import SINCOS, hexadecimal, sincos_ir

__all__ = ["function_name", "module_ir"]

_BINARY = ("add", "sub", "mul")
_LEAVES = ("symbol", "const")


def function_name(program: Program) -> str:
    """Name of the native function of a program."""
    return f"nb_{program.name}"


def module_ir(programs: Sequence[Program], triple: str, layout: str) -> str:
    """One LLVM module with a function for every program.

    Args:
        programs: the programs; their names differ.
        triple: LLVM's name of the target.
        layout: LLVM's data layout of the target.
    """
    parts = [f'target datalayout = "{layout}"', f'target triple = "{triple}"', "declare double @llvm.sqrt.f64(double)"]
    if any(op in ("sin", "cos") for program in programs for op, _, _ in program.tape.code):
        parts.append(sincos_ir())
    parts += [_Printer(program).function() for program in programs]
    return "\n".join(parts)


class _Printer:
    """Prints one program; `values[k]` is (operand text, sign bit) of slot k."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.lines: list[str] = []
        self.values: dict[int, tuple[str, int]] = {}
        self.angles: dict[str, str] = {}

    def function(self) -> str:
        """The function's text: output after output, each one stored as soon as it is known.

        That order (depth first) keeps few values alive at a time: a third less time than the tape's own order.
        """
        for k, ref in enumerate(self.program.tape.outputs):
            for slot in self._missing(ref >> 1):
                self.values[slot] = self._operation(slot)
            value = self._plain(ref, f"%m{k}")
            self.lines.append(f"  %o{k} = getelementptr double, ptr %out, i64 {k}\n  store double {value}, ptr %o{k}")
        head = f"define void @{function_name(self.program)}(ptr noalias %in, ptr noalias %out) nounwind {{"
        return "\n".join([head, *self.lines, "  ret void\n}\n"])

    def _missing(self, slot: int) -> Iterator[int]:
        """The slots that a slot needs and that are not printed yet, operands first, itself last."""
        code, values = self.program.tape.code, self.values
        stack = [slot]
        while stack:
            top = stack[-1]
            if top in values:
                stack.pop()
                continue
            op, a, b = code[top]
            operands = (b >> 1, a >> 1) if op in _BINARY else () if op in _LEAVES else (a >> 1,)
            if waiting := [k for k in operands if k not in values]:
                stack += waiting
            else:
                stack.pop()
                yield top

    def _operation(self, slot: int) -> tuple[str, int]:
        op, a, b = self.program.tape.code[slot]
        name = f"%s{slot}"
        if op == "mul":
            return self._product(name, a, b)
        if op in ("add", "sub"):
            return self._sum(name, a, b ^ (op == "sub"))
        if op == "const":
            return hexadecimal(self.program.tape.constants[a]), 0
        if op == "symbol":
            return self._input(name, a)
        return self._unary(op, name, a)

    def _read(self, ref: int) -> tuple[str, int]:
        text, sign = self.values[ref >> 1]
        return text, sign ^ ref & 1

    def _plain(self, ref: int, name: str) -> str:
        """An operand without sign; negated under the given name where it has one."""
        text, sign = self._read(ref)
        if not sign:
            return text
        self.lines.append(f"  {name} = fneg double {text}")
        return name

    def _input(self, name: str, index: int) -> tuple[str, int]:
        self.lines.append(
            f"  %i{index} = getelementptr double, ptr %in, i64 {index}\n  {name} = load double, ptr %i{index}"
        )
        return name, 0

    def _product(self, name: str, a: int, b: int) -> tuple[str, int]:
        left, s = self._read(a)
        right, t = self._read(b)
        self.lines.append(f"  {name} = fmul contract double {left}, {right}")
        return name, s ^ t

    def _sum(self, name: str, a: int, b: int) -> tuple[str, int]:
        left, s = self._read(a)
        right, t = self._read(b)
        if s and not t:
            left, right = right, left
        self.lines.append(f"  {name} = {'fadd' if s == t else 'fsub'} contract double {left}, {right}")
        return name, s & t

    def _unary(self, op: str, name: str, a: int) -> tuple[str, int]:
        if op == "sqrt":
            self.lines.append(f"  {name} = call double @llvm.sqrt.f64(double {self._plain(a, f'{name}n')})")
            return name, 0
        text, sign = self._read(a)
        if op == "inv":
            self.lines.append(f"  {name} = fdiv double {hexadecimal(1.0)}, {text}")
            return name, sign
        if text not in self.angles:
            self.angles[text] = f"{name}b"
            self.lines.append(f"  {name}b = call {{ double, double }} {SINCOS}(double {text})")
        self.lines.append(f"  {name} = extractvalue {{ double, double }} {self.angles[text]}, {int(op == 'cos')}")
        return name, sign if op == "sin" else 0
