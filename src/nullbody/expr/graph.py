"""The graph: a hash-consed straight-line program of scalar operations.

A node is an operation on references; a reference is `2 * node + sign`, so that a negation costs nothing.
Each node also carries its value at a random point of a prime field (`field`). A new operation whose value is
already there, up to sign, becomes a reference to the older node: equal functions share one node, sin^2 + cos^2
is 1, and a sum that cancels is 0. (Not where the older node is written with symbols that the new one does not
have: a substitution must get rid of a symbol for good.) `verify` repeats every such merge at a second prime.

Nodes are only ever appended, and a node's operands precede it: node order is an order of evaluation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from fractions import Fraction
from typing import TYPE_CHECKING

from nullbody.errors import InputError
from nullbody.expr.exact import Exact
from nullbody.expr.field import PRIMES, Field
from nullbody.expr.witness import Witness

if TYPE_CHECKING:
    from nullbody.expr.expression import Expr

__all__ = ["ONE", "ZERO", "Graph"]

ZERO = 0  # reference of the constant 0
ONE = 2  # reference of the constant 1
_BINARY = frozenset(("add", "sub", "mul"))
_LEAVES = frozenset(("const", "symbol"))

Key = tuple[str, int, int]


class Graph:
    """A hash-consed graph of scalar operations; `symbol` and `constant` give its first expressions.

    Attributes:
        code: (operation, left, right) of every node; left and right are references, or for
            "symbol" and "const" an index into `symbols` or `constants`.
        symbols: names of the symbols, in order of creation.
        constants: the exact constants.
        depends: for every node the set of symbols that it depends on, as a bit mask.
    """

    def __init__(self, seed: int = 0) -> None:
        self.code: list[Key] = []
        self.symbols: list[str] = []
        self.constants: list[Exact] = []
        self._negatives: list[Exact] = []
        self.depends: list[int] = []
        self._seed = seed
        self._witness = Witness(self, Field(PRIMES[0], seed))
        self._by_key: dict[Key, int] = {}
        self._by_value: dict[int, int] = {}
        self._by_name: dict[str, int] = {}
        self._by_constant: dict[Exact, int] = {}
        self._merges: list[tuple[Key, int]] = []
        self.constant_ref(Exact.of(0))
        self.constant_ref(Exact.of(1))

    def __len__(self) -> int:
        return len(self.code)

    def __repr__(self) -> str:
        return f"<Graph {len(self.code)} nodes, {len(self.symbols)} symbols>"

    def copy(self) -> Graph:
        """A graph with the same nodes; references keep their meaning, what is added to one is not in the other."""
        twin = Graph.__new__(Graph)
        twin.__dict__.update(
            {name: value.copy() for name, value in vars(self).items() if isinstance(value, list | dict)}
        )
        twin._seed = self._seed
        twin._witness = self._witness.copy(twin)
        return twin

    # -- leaves ---------------------------------------------------------------------------------------------

    def symbol(self, name: str) -> Expr:
        """The symbol of this name (the same one at every call)."""
        from nullbody.expr.expression import Expr

        if name not in self._by_name:
            self.symbols.append(name)
            node = self._append(("symbol", len(self.symbols) - 1, 0), 1 << (len(self.symbols) - 1))
            self._by_name[name] = node
        return Expr(self, self._by_name[name])

    def constant(self, number: int | float | Fraction | Exact) -> Expr:
        """An exact constant; a float means its shortest decimal (0.1 is 1/10)."""
        from nullbody.expr.expression import Expr

        return Expr(self, self.constant_ref(Exact.of(number)))

    def constant_ref(self, number: Exact) -> int:
        """Reference of an exact constant; of two opposite ones the positive is the node."""
        if number.negative:
            return self.constant_ref(-number) ^ 1
        if number not in self._by_constant:
            self.constants.append(number)
            self._negatives.append(-number)
            self._by_constant[number] = self._append(("const", len(self.constants) - 1, 0), 0)
        return self._by_constant[number]

    def constant_of(self, ref: int) -> Exact | None:
        """The exact constant behind a reference, or None."""
        op, left, _ = self.code[ref >> 1]
        if op != "const":
            return None
        return self._negatives[left] if ref & 1 else self.constants[left]

    def value(self, ref: int) -> int:
        """The value of a reference at the random point of the prime field."""
        return self._witness.of_ref(ref)

    @property
    def prime(self) -> int:
        """The prime of the field in which `value` lives."""
        return self._witness.field.prime

    def residue(self, number: Exact) -> int:
        """An exact constant in that field."""
        return self._witness.field.constant(number)

    def find(self, value: int, symbols: int) -> int | None:
        """A reference with this value that needs no symbol outside a set (a bit mask), or None."""
        ref = self._by_value.get(value)
        return None if ref is None or self.depends[ref >> 1] & ~symbols else ref

    # -- operations on references ---------------------------------------------------------------------------

    def negate(self, a: int) -> int:
        """-a, at no cost."""
        return a ^ 1 if a else ZERO

    def add(self, a: int, b: int) -> int:
        """a + b."""
        if a == ZERO:
            return b
        if b == ZERO:
            return a
        if a == b ^ 1:
            return ZERO
        code = self.code
        if code[a >> 1][0] == code[b >> 1][0] == "const":
            return self._of_constants(a, b, Exact.__add__)
        if a >> 1 > b >> 1:
            a, b = b, a
        op = "sub" if (a ^ b) & 1 else "add"
        found = self._node(op, a & ~1, b & ~1)
        return self.negate(found) if a & 1 else found

    def multiply(self, a: int, b: int) -> int:
        """a b."""
        if a == ZERO or b == ZERO:
            return ZERO
        sign = (a ^ b) & 1
        a, b = a & ~1, b & ~1
        if a > b:
            a, b = b, a
        if a == ONE:
            return b ^ sign
        code = self.code
        if code[b >> 1][0] == "const":
            a, b = b, a
        op, c, d = code[b >> 1]
        if code[a >> 1][0] == "const":
            if op == "const":
                return self._of_constants(a, b, Exact.__mul__) ^ sign
            if op == "mul" and code[c >> 1][0] == "const":
                return self.multiply(self._of_constants(a, c, Exact.__mul__), d) ^ sign
        elif a == b and op == "sqrt":
            return c ^ sign
        return self._node("mul", a, b) ^ sign

    def _of_constants(self, a: int, b: int, operation: Callable[[Exact, Exact], Exact]) -> int:
        left, right = self.constant_of(a), self.constant_of(b)
        assert left is not None
        assert right is not None
        return self.constant_ref(operation(left, right))

    def invert(self, a: int) -> int:
        """1 / a.

        Raises:
            ZeroDivisionError: a is identically zero.
        """
        if a == ZERO or self.value(a) == 0:
            raise ZeroDivisionError("division by an expression that is identically zero")
        number = self.constant_of(a)
        if number is not None:
            return self.constant_ref(number.inverse())
        op, left, _ = self.code[a >> 1]
        if op == "inv":
            return left ^ (a & 1)
        return self._node("inv", a & ~1, 0) ^ (a & 1)

    def sine(self, a: int) -> int:
        """sin a; odd."""
        return ZERO if a == ZERO else self._node("sin", a & ~1, 0) ^ (a & 1)

    def cosine(self, a: int) -> int:
        """cos a; even."""
        return ONE if a == ZERO else self._node("cos", a & ~1, 0)

    def square_root(self, a: int) -> int:
        """sqrt a, exact for rational constants of small prime factors."""
        number = self.constant_of(a)
        if number is not None:
            if number.negative:
                raise InputError(f"the square root of {number} is not real")
            if number.fraction is not None:
                with suppress(InputError):  # a radicand too large to be factored stays a node
                    return self.constant_ref(Exact.square_root(number.fraction))
        return self._node("sqrt", a, 0)

    def operate(self, op: str, a: int, b: int = ZERO) -> int:
        """The operation of a node of `code`, no leaf, on other references: how an expression is written anew."""
        if op == "mul":
            return self.multiply(a, b)
        if op in ("add", "sub"):
            return self.add(a, b if op == "add" else self.negate(b))
        if op == "inv":
            return self.invert(a)
        if op == "sqrt":
            return self.square_root(a)
        return self.sine(a) if op == "sin" else self.cosine(a)

    # -- bookkeeping ----------------------------------------------------------------------------------------

    def _node(self, op: str, a: int, b: int) -> int:
        key = (op, a, b)
        ref = self._by_key.get(key)
        if ref is not None:
            return ref
        value = self._witness.of_operation(key)
        depends = self.depends[a >> 1] | (self.depends[b >> 1] if op in _BINARY else 0)
        ref = self._by_value.get(value)
        if ref is None or self.depends[ref >> 1] & ~depends:  # never trade for a node that needs other symbols
            ref = self._append(key, depends, value)
        else:
            self._merges.append((key, ref))
        self._by_key[key] = ref
        return ref

    def _append(self, key: Key, depends: int, value: int | None = None) -> int:
        ref = 2 * len(self.code)
        if value is None:
            value = self._witness.of_operation(key)
        self.code.append(key)
        self.depends.append(depends)
        self._witness.values.append(value)
        self._by_value[value] = ref
        if value:
            self._by_value[self._witness.field.prime - value] = ref ^ 1
        return ref

    def reachable(self, refs: Iterable[int]) -> list[int]:
        """The nodes that the references need, in order of evaluation."""
        needed = bytearray(len(self.code))
        for ref in refs:
            needed[ref >> 1] = 1
        for node in range(needed.rfind(1), -1, -1):
            if needed[node]:
                op, a, b = self.code[node]
                if op in _BINARY:
                    needed[a >> 1] = needed[b >> 1] = 1
                elif op not in _LEAVES:
                    needed[a >> 1] = 1
        return [node for node, wanted in enumerate(needed) if wanted]

    def operands(self, node: int) -> tuple[int, ...]:
        """The references that a node reads."""
        op, a, b = self.code[node]
        if op in _BINARY:
            return (a, b)
        return () if op in _LEAVES else (a,)

    def verify(self) -> int:
        """Repeat every merge by value at a second prime and another point; return how many there were.

        Raises:
            ArithmeticError: two different functions had been merged (a chance of about 1e-12).
        """
        second = Witness(self, Field(PRIMES[1], self._seed + 1))
        for key in self.code:
            second.values.append(second.of_operation(key))
        for key, ref in self._merges:
            if second.of_operation(key) != second.of_ref(ref):
                raise ArithmeticError(f"{key} and node {ref >> 1} agree at one prime only; derive with another seed")
        return len(self._merges)
