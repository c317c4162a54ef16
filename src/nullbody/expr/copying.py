"""Values that hold expressions, said again in a copy of their graph."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any

from nullbody.expr.expression import Expr
from nullbody.expr.graph import Graph

__all__ = ["in_copy"]


def in_copy(value: Any, graph: Graph) -> Any:
    """The same value with the expressions of `graph`, a copy of theirs (`Graph.copy`), where references mean the same.

    Args:
        value: an expression; lists, tuples and dataclasses of such values; anything else stays as it is.
        graph: the copy.
    """
    if isinstance(value, Expr):
        return Expr(graph, value.ref)
    if isinstance(value, list | tuple):
        return type(value)([in_copy(part, graph) for part in value])
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{field.name: in_copy(getattr(value, field.name), graph) for field in fields(value)})
    return value
