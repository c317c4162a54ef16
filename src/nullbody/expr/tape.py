"""The tape: the straight-line program that some outputs of a graph need, and its interpreter."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.errors import InputError, UnknownName
from nullbody.expr.expression import Expr
from nullbody.expr.graph import Graph

__all__ = ["Operations", "Tape", "operations"]


@dataclass(frozen=True)
class Operations:
    """Exact operation counts of a program; negations are free (they are folded into sums)."""

    add: int = 0
    mul: int = 0
    div: int = 0
    sqrt: int = 0
    trig: int = 0

    @property
    def arithmetic(self) -> int:
        """Additions, multiplications, divisions and square roots; trigonometric calls not counted."""
        return self.add + self.mul + self.div + self.sqrt

    def __str__(self) -> str:
        parts = [f"{self.add} +", f"{self.mul} *"]
        parts += [f"{n} {sign}" for n, sign in ((self.div, "/"), (self.sqrt, "sqrt"), (self.trig, "trig")) if n]
        return f"{self.arithmetic} ({', '.join(parts)})"


@dataclass(frozen=True)
class Tape:
    """A straight-line program in evaluation order.

    Slot k holds the result of `code[k] = (operation, left, right)`, whose operands are references
    `2 * slot + sign` to earlier slots; for "symbol" left is the index of the input, for "const" of the constant.

    Attributes:
        inputs: names of the inputs, in the order in which they are given.
        constants: the constants as doubles.
        code: the operations.
        outputs: references of the results.
    """

    inputs: tuple[str, ...]
    constants: tuple[float, ...]
    code: tuple[tuple[str, int, int], ...]
    outputs: tuple[int, ...]

    @classmethod
    def of(cls, outputs: Sequence[Expr], inputs: Sequence[str]) -> Tape:
        """The program of some expressions.

        Raises:
            UnknownName: an expression needs a symbol that is not among the inputs.
        """
        if not outputs:
            return cls(tuple(inputs), (), (), ())
        graph = _graph_of(outputs)
        position = {name: k for k, name in enumerate(inputs)}
        nodes = graph.reachable(f.ref for f in outputs)
        slot = {node: k for k, node in enumerate(nodes)}
        code: list[tuple[str, int, int]] = []
        constants: list[float] = []
        for node in nodes:
            op, a, b = graph.code[node]
            if op == "symbol":
                name = graph.symbols[a]
                if name not in position:
                    raise UnknownName("input", name, inputs)
                code.append((op, position[name], 0))
            elif op == "const":
                constants.append(float(graph.constants[a]))
                code.append((op, len(constants) - 1, 0))
            else:
                left = 2 * slot[a >> 1] | a & 1
                right = 2 * slot[b >> 1] | b & 1 if op in ("add", "sub", "mul") else 0
                code.append((op, left, right))
        refs = tuple(2 * slot[f.ref >> 1] | f.ref & 1 for f in outputs)
        return cls(tuple(inputs), tuple(constants), tuple(code), refs)

    @property
    def operations(self) -> Operations:
        """Operation counts of the program."""
        n = Counter(op for op, _, _ in self.code)
        return Operations(n["add"] + n["sub"], n["mul"], n["inv"], n["sqrt"], n["sin"] + n["cos"])

    def run(self, inputs: Sequence[Any], functions: Mapping[str, Callable[[Any], Any]] | None = None) -> list[Any]:
        """Interpret the program: the reference for every compiled kernel.

        Args:
            inputs: one number (or array) for each name of `inputs`.
            functions: "sin", "cos", "sqrt" for other number types; `math` by default.
        """
        if len(inputs) != len(self.inputs):
            raise InputError(f"the program has {len(self.inputs)} inputs, not {len(inputs)}")
        unary: Mapping[str, Callable[[Any], Any]] = functions or {
            "sin": math.sin,
            "cos": math.cos,
            "sqrt": math.sqrt,
        }
        slots: list[Any] = []

        def read(ref: int) -> Any:
            return -slots[ref >> 1] if ref & 1 else slots[ref >> 1]

        for op, a, b in self.code:
            if op == "mul":
                slots.append(read(a) * read(b))
            elif op == "add":
                slots.append(read(a) + read(b))
            elif op == "sub":
                slots.append(read(a) - read(b))
            elif op == "symbol":
                slots.append(inputs[a])
            elif op == "const":
                slots.append(self.constants[a])
            elif op == "inv":
                slots.append(1 / read(a))
            else:
                slots.append(unary[op](read(a)))
        return [read(ref) for ref in self.outputs]


def _graph_of(outputs: Sequence[Expr]) -> Graph:
    graph = outputs[0].graph
    if any(f.graph is not graph for f in outputs):
        raise InputError("the expressions belong to different graphs")
    return graph


def operations(outputs: Sequence[Expr]) -> Operations:
    """Operation counts of some expressions evaluated together, each shared node once."""
    if not outputs:
        return Operations()
    graph = _graph_of(outputs)
    n = Counter(graph.code[node][0] for node in graph.reachable(f.ref for f in outputs))
    return Operations(n["add"] + n["sub"], n["mul"], n["inv"], n["sqrt"], n["sin"] + n["cos"])
