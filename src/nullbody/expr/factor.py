"""Fewer operations for the same functions: common factors out of sums, common products and common sums made once.

Expressions are read as sums of products, divisors are taken out of these (`divisor`), and what is left is written in a
new graph: by value, the old one would only give back the forms that it has. Then once more from there, as long as that
helps: what was taken out hides other divisors, and a product written out where it is used can be divided otherwise.
Terms and factors change their order, but nothing is multiplied out: rounding stays what it was.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from nullbody.expr.divisor import Factors, SumsOfProducts
from nullbody.expr.expression import Expr
from nullbody.expr.graph import ONE, ZERO, Graph
from nullbody.expr.tape import operations
from nullbody.expr.transplant import transplant

__all__ = ["factored"]

_ROUNDS = 8  # at most, from each of two beginnings
_LONGEST = 12  # products of more factors than this are not written out where they are used


def factored(expressions: Sequence[Expr]) -> list[Expr]:
    """The same functions in a new graph, with fewer operations where common factors, products or sums are found.

    Args:
        expressions: expressions of one graph.

    Returns:
        As many expressions, never with more operations than before; the same ones for the same input.

    Raises:
        InputError: the expressions belong to different graphs.
    """
    fewest = operations(expressions).arithmetic
    best = unchanged = transplant(expressions, Graph())
    for parity in (0, 1) if fewest else ():
        current, last, before = unchanged, fewest, fewest
        for k in range(_ROUNDS):
            current = _written(current, _divided(current, shared=k % 2 == parity))
            count = operations(current).arithmetic
            if count < fewest:
                best, fewest = current, count
            if k > 1 and count >= max(last, before):
                break
            last, before = count, last
    return best


def _divided(expressions: Sequence[Expr], *, shared: bool) -> SumsOfProducts:
    """The expressions as sums of products, the nodes of their graph being the atoms, and the divisors taken out.

    Args:
        expressions: expressions of one graph.
        shared: whether products that are used more than once are written out too, every time; common ones among
            them are found again.
    """
    graph = expressions[0].graph
    outputs = [f.ref >> 1 for f in expressions]
    nodes = graph.reachable(f.ref for f in expressions)
    uses = Counter(outputs)
    for node in nodes:
        uses.update([ref >> 1 for ref in graph.operands(node)])
    sums = _sums(graph, nodes, uses, shared)
    divided = SumsOfProducts(len(graph.code))
    needed = set(outputs)
    for node in reversed(nodes):
        if node in needed:
            needed.update(_operands(graph, node) if node not in sums else [k for _, p in sums[node] for k in p])
    for node in nodes:
        if node in needed:
            for sign, product in sums.get(node, ()):
                divided.add(node, sign, product)
    divided.reduce()
    return divided


def _sums(graph: Graph, nodes: Sequence[int], uses: Counter[int], shared: bool) -> dict[int, list[tuple[int, Factors]]]:
    """Sums and products as signed products, written out through sums used once and through products."""
    products: dict[int, Factors] = {}
    sums: dict[int, list[tuple[int, Factors]]] = {}

    def factors(node: int) -> Factors:
        return products[node] if node in products and (shared or uses[node] == 1) else (node,)

    for node in nodes:
        op, left, right = graph.code[node]
        if op == "mul":
            product = (*factors(left >> 1), *factors(right >> 1))
            products[node] = product if len(product) <= _LONGEST else (left >> 1, right >> 1)
        elif op in ("add", "sub"):
            one, two = (
                sums.pop(k) if uses[k] == 1 and k in sums else [(0, factors(k))] for k in (left >> 1, right >> 1)
            )
            one += [(1 - sign, product) for sign, product in two] if op == "sub" else two
            sums[node] = one
    return sums | {node: [(0, product)] for node, product in products.items()}


def _operands(graph: Graph, node: int) -> list[int]:
    return [ref >> 1 for ref in graph.operands(node)]


def _written(expressions: Sequence[Expr], divided: SumsOfProducts) -> list[Expr]:
    """The expressions in a new graph, as sums of products of divisors and nodes of the old one."""
    source, target = expressions[0].graph, Graph()
    image: dict[int, int] = {}

    def moved(ref: int) -> int:
        return target.negate(image[ref >> 1]) if ref & 1 else image[ref >> 1]

    def written(atom: int) -> int:
        if atom in divided.sums:
            return _sum(divided, atom, image, target)
        op, left, _ = source.code[atom]
        if op == "symbol":
            return target.symbol(source.symbols[left]).ref
        return target.constant_ref(source.constants[left]) if op == "const" else target.operate(op, moved(left))

    stack = [f.ref >> 1 for f in reversed(expressions)]
    while stack:
        atom = stack[-1]
        if atom in image:
            stack.pop()
            continue
        if atom in divided.sums:
            operands = [factor for term in divided.sums[atom] for factor in divided.terms[term].factors]
        else:
            operands = _operands(source, atom)
        waiting = [k for k in operands if k not in image]
        if waiting:
            stack += waiting
        else:
            image[stack.pop()] = written(atom)
    return [Expr(target, moved(f.ref)) for f in expressions]


def _sum(divided: SumsOfProducts, atom: int, image: dict[int, int], target: Graph) -> int:
    """A sum of products, its atoms being written already."""
    total = ZERO
    for term in divided.sums[atom]:
        _, sign, factors = divided.terms[term]
        product = ONE
        for factor in factors:
            product = target.multiply(product, image[factor])
        total = target.add(total, target.negate(product) if sign else product)
    return total
