"""Planting errors: sign errors in expressions of a graph, and in single instructions of a program."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from nullbody.expr import Expr, Tape, substitute

__all__ = ["changed", "flipped", "instructions", "link_energy", "terms"]


def terms(expression: Expr) -> list[Expr]:
    """The summands of an expression."""
    op, a, b = expression.graph.code[expression.ref >> 1]
    if op not in ("add", "sub"):
        return [expression]
    sign = expression.ref & 1
    parts = (a ^ sign, b ^ sign ^ (op == "sub"))
    return [term for part in parts for term in terms(Expr(expression.graph, part))]


def changed(outputs: Mapping[str, Any], name: str, place: tuple[int, ...], value: Any) -> dict[str, Any]:
    """The outputs with one entry exchanged."""

    def exchanged(output: Any, where: tuple[int, ...]) -> Any:
        if not where:
            return value
        rows = list(output)
        rows[where[0]] = exchanged(rows[where[0]], where[1:])
        return tuple(rows)

    return {**outputs, name: exchanged(outputs[name], place)}


def link_energy(T: Expr, link: int) -> Expr:
    """The kinetic energy of one link: what is left of T when all other rates and the other masses vanish."""
    graph = T.graph
    zero = {graph.symbol(name): graph.constant(0) for name in ("M", "Ixx", "Iyy", "Izz", "ms")}
    moving = (f"alpha{link}_dot", f"s{link}_dot")
    rates = [name for name in graph.symbols if name.endswith("_dot") and name not in moving]
    return substitute([T], zero | {graph.symbol(name): graph.constant(0) for name in rates})[0]


def instructions(tape: Tape) -> Iterator[tuple[int, int]]:
    """(slot, operand) of every instruction in which the operand's sign matters."""
    for slot, (operation, _, _) in enumerate(tape.code):
        if operation in ("add", "sub", "mul"):
            yield from ((slot, 1), (slot, 2))
        elif operation in ("sin", "inv"):
            yield slot, 1


def flipped(tape: Tape, slot: int, operand: int) -> Tape:
    """The program with the sign of one operand turned."""
    code = list(tape.code)
    instruction = list(code[slot])
    instruction[operand] ^= 1
    code[slot] = (instruction[0], instruction[1], instruction[2])
    return replace(tape, code=tuple(code))
