"""Layer 1: scalar expressions as a hash-consed graph with exact constants, derivatives, counts and factoring."""

from nullbody.expr.calculus import derivative, directional, gradient, jacobian, substitute
from nullbody.expr.copying import in_copy
from nullbody.expr.exact import Exact
from nullbody.expr.expression import Expr, cos, sin, sqrt
from nullbody.expr.factor import factored
from nullbody.expr.graph import Graph
from nullbody.expr.linear import LinearForm
from nullbody.expr.tape import Operations, Tape, operations
from nullbody.expr.text import latex, text

__all__ = [
    "Exact",
    "Expr",
    "Graph",
    "LinearForm",
    "Operations",
    "Tape",
    "cos",
    "derivative",
    "directional",
    "factored",
    "gradient",
    "in_copy",
    "jacobian",
    "latex",
    "operations",
    "sin",
    "sqrt",
    "substitute",
    "text",
]
