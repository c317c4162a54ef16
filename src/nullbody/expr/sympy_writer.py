"""Expressions of a graph written as SymPy's, operands first, without recursion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from nullbody.expr.graph import Graph

__all__ = ["SymPyWriter"]

_TALLEST = 100  # levels of operations that SymPy's own rules, which recurse, are asked to put together
_TALLEST_ROOT = 4  # levels of operations below a square root that they are asked to put together
_FAMILY = {"add": "sum", "sub": "sum", "mul": "product"}


class SymPyWriter:
    """Writes references of a graph as SymPy expressions; what was written once is shared.

    Args:
        graph: where they come from.
        variable: what the symbol of a name stands for.
    """

    def __init__(self, graph: Graph, variable: Callable[[str], Any]) -> None:
        import sympy

        self.graph = graph
        self._variable = variable
        self._sympy: Any = sympy
        self._written: dict[int, tuple[Any, int]] = {}  # node -> (SymPy object, levels of operations)

    def expression(self, ref: int) -> Any:
        """A reference as a SymPy expression."""
        node = ref >> 1
        needed = self._needed(node)
        inlined = self._inlined(needed)
        for current in needed:
            if current not in inlined:
                self._written[current] = self._assembled(current, inlined)
        found, level = self._written[node]
        return self._negated(found, level) if ref & 1 else found

    def _needed(self, node: int) -> list[int]:
        """The nodes not yet written that a node needs, operands first and itself last."""
        stack, needed = [node], set()
        while stack:
            current = stack.pop()
            if current not in needed and current not in self._written:
                needed.add(current)
                stack += [ref >> 1 for ref in self.graph.operands(current)]
        return sorted(needed)

    def _inlined(self, needed: Sequence[int]) -> set[int]:
        """Sums that are used once and in a sum, products once and in a product: SymPy's Add and Mul are flat."""
        code = self.graph.code
        users: dict[int, list[int]] = {}
        for node in needed:
            for ref in self.graph.operands(node):
                users.setdefault(ref >> 1, []).append(node)
        return {
            node
            for node in needed
            if (family := _FAMILY.get(code[node][0])) is not None
            and len(found := users.get(node, [])) == 1
            and _FAMILY.get(code[found[0]][0]) == family
        }

    def _assembled(self, node: int, inlined: set[int]) -> tuple[Any, int]:
        """A node in SymPy from its operands, and its level."""
        sympy, graph = self._sympy, self.graph
        op, a, _ = graph.code[node]
        if op == "symbol":
            return self._variable(graph.symbols[a]), 0
        if op == "const":
            terms = [sympy.Rational(c.numerator, c.denominator) * sympy.sqrt(k) for k, c in graph.constants[a].terms]
            return sympy.Add(*terms), 0
        parts = self._gathered(node, inlined)
        level = 1 + max(self._written[ref >> 1][1] for ref in parts)
        rules = level <= _TALLEST
        found = [self._written[ref >> 1][0] for ref in parts]
        found = [self._negated(e, level) if ref & 1 else e for e, ref in zip(found, parts, strict=True)]
        if op in ("add", "sub"):
            return sympy.Add(*found, evaluate=rules), level
        if op == "mul":
            return sympy.Mul(*found, evaluate=rules), level
        if op in ("inv", "sqrt"):
            if level > _TALLEST_ROOT and (found[0].is_Pow or op == "sqrt"):
                level = max(level, _TALLEST + 1)  # in and around it SymPy would look for common factors, for minutes
            rules = level <= _TALLEST
            return sympy.Pow(found[0], -1 if op == "inv" else sympy.Rational(1, 2), evaluate=rules), level
        return getattr(sympy, op)(found[0], evaluate=rules), level

    def _gathered(self, node: int, inlined: set[int]) -> list[int]:
        """The references that a flat sum or product is made of; the operands of anything else."""
        family = _FAMILY.get(self.graph.code[node][0])
        if family is None:
            return list(self.graph.operands(node))
        parts, stack = [], [2 * node]
        while stack:
            ref = stack.pop()
            if ref != 2 * node and ref >> 1 not in inlined:
                parts.append(ref)
                continue
            op, a, b = self.graph.code[ref >> 1]
            sign = ref & 1
            stack += [b, a ^ sign] if family == "product" else [b ^ sign ^ (op == "sub"), a ^ sign]
        return parts

    def _negated(self, expression: Any, level: int) -> Any:
        return -expression if level <= _TALLEST else self._sympy.Mul(-1, expression, evaluate=False)
