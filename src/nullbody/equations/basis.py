"""The basis: the coordinates in whose rates the dynamics are written, v itself or others that cost less.

Coordinates that could serve belong together: those of one joint that has enough of them (the platform's), or one from
each of several joints that are alike (the hinges of the legs). They must be independent, with room to spare, in every
configuration that was sampled; the ones with which forward_dynamics takes the fewest operations are taken.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from nullbody.equations.choice import dependent
from nullbody.equations.closure import Closures
from nullbody.equations.dynamics import Dynamics
from nullbody.equations.equations import Routine
from nullbody.equations.load import Loaded
from nullbody.equations.manifold import Sample
from nullbody.equations.sizes import sizes_at
from nullbody.equations.symbols import Symbols
from nullbody.errors import InputError, SingularityError, UnknownName
from nullbody.expr import Expr, Graph, in_copy, operations
from nullbody.mechanism import Mechanism
from nullbody.nullspace import echelon
from nullbody.nullspace.call import symbolic_null_space
from nullbody.nullspace.given import Given
from nullbody.nullspace.plan import Plan
from nullbody.nullspace.steps import sparse_rows

__all__ = ["Terms", "other_bases", "written_in"]

_ROOM = 0.1  # smallest singular value of Z[w] in every sample: 1 at best, 0 where the basis is singular


@dataclass(frozen=True, eq=False)
class Terms:
    """What the dynamics are made of, in one graph.

    Attributes:
        loads: M, h and the power of the loads.
        kept: independent rows of A.
        symbols: of q, v and so on.
        values: of the parameters, by name.
        samples: configurations with closed loops.
    """

    loads: Loaded
    kept: Closures
    symbols: Symbols
    values: Mapping[str, float]
    samples: Sequence[Sample]

    def of(self, graph: Graph) -> Terms:
        """The same in a copy of the graph."""
        loads, kept = in_copy(self.loads, graph), in_copy(self.kept, graph)
        return replace(self, loads=loads, kept=kept, symbols=self.symbols.of(graph))

    def dynamics(self, basis: tuple[str, ...], witness: int | None = None) -> Dynamics:
        """The dynamics written in a basis; `witness` as in `Dynamics`.

        Raises:
            SingularityError: |B| is identically zero; the message names coordinates that would do.
        """
        A, names, columns = self.kept.A, self.symbols.groups["q"], self.symbols.places(basis)
        sizes = sizes_at(names, [sample.q for sample in self.samples], self.values)
        given = Given("expressions", sparse_rows(A), len(names))
        try:
            space = symbolic_null_space(given, columns, plan=Plan(offsets=True, sizes=sizes))
        except SingularityError:
            form = echelon(A, [j for j in range(len(names)) if j not in columns] + columns)
            would_do = [name for j, name in enumerate(names) if j not in form.columns]
            raise dependent(basis, would_do) from None
        return Dynamics(self.loads, self.kept, space, self.symbols, sizes, witness)


def other_bases(terms: Terms, basis: Sequence[str] | None) -> list[tuple[str, ...]]:
    """Bases that are to be written beside the independent coordinates, or instead: the wanted one, or candidates.

    Raises:
        UnknownName, InputError: the wanted basis is none.
    """
    mechanism, independent = terms.symbols.mechanism, terms.symbols.independent
    if basis is None:
        return candidates(mechanism, terms.samples, independent)
    wanted = checked_basis(mechanism, basis, len(independent))
    return [] if set(wanted) == set(independent) else [wanted]


def written_in(
    direct: Dynamics, others: Mapping[tuple[str, ...], Terms], *, wanted: bool
) -> tuple[tuple[str, ...], dict[str, Routine]]:
    """The basis, and forward and inverse dynamics written in it: the one that takes the fewest operations.

    Args:
        direct: the dynamics written in the independent coordinates.
        others: by other bases, what the dynamics are made of in a graph of their own, a copy from before `direct` was
            written: an expression keeps the form it first had.
        wanted: whether one of the others was asked for.

    Raises:
        SingularityError: a basis is none.
        MechanismError: a motion moves no mass.
    """
    independent = direct.symbols.independent
    if not others:
        return independent, direct.routines()
    delta = direct.symbols.zero + direct.space.delta
    witness = delta.graph.value(delta.ref)
    written = {} if wanted else {independent: direct.routines()}
    written |= {names: terms.dynamics(names, witness).routines() for names, terms in others.items()}
    chosen = min(written, key=lambda names: _cost(written[names]))
    if chosen != independent:
        _expressions(written[chosen])[0].graph.verify()
    return chosen, written[chosen]


def _cost(routines: dict[str, Routine]) -> int:
    return operations(_expressions(routines)).arithmetic


def _expressions(routines: dict[str, Routine]) -> list[Expr]:
    """Those of forward_dynamics; plain zeros and ones are none."""
    entries: list[Any] = list(routines["forward_dynamics"].expressions)
    return [f for f in entries if isinstance(f, Expr)]


def checked_basis(mechanism: Mechanism, basis: Sequence[str], nv: int) -> tuple[str, ...]:
    """The names of a basis.

    Raises:
        UnknownName, InputError: they are no coordinates, or not nv of them.
    """
    names = (basis,) if isinstance(basis, str) else tuple(basis)
    for name in names:
        if name not in mechanism.coordinates:
            raise UnknownName("coordinate", name, mechanism.coordinates)
    if len(set(names)) != len(names) or len(names) != nv:
        raise InputError(f"a basis of {mechanism.name!r} has {nv} coordinates, not {list(names)}")
    return names


def candidates(mechanism: Mechanism, samples: Sequence[Sample], independent: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Bases other than the independent coordinates that are regular in all samples."""
    if not samples or not independent:
        return []
    names, nv = mechanism.coordinates, len(independent)
    found: list[tuple[str, ...]] = []
    for group in _groups(mechanism, nv):
        places = [names.index(name) for name in group]
        columns = sorted(samples[0].independent_columns(places))
        basis = tuple(names[k] for k in columns)
        if not set(columns) <= set(places) or set(basis) == set(independent) or basis in found:
            continue
        if all(sample.quality(columns) >= _ROOM for sample in samples):
            found.append(basis)
    return found


def _groups(mechanism: Mechanism, nv: int) -> list[tuple[str, ...]]:
    """Coordinates that belong together, at least nv of them."""
    alike: dict[tuple[str, int, int], list[str]] = {}
    depth = {"ground": 0}
    groups: list[tuple[str, ...]] = []
    for joint in mechanism.tree_order():
        depth[joint.child] = depth[joint.parent] + 1
        if len(joint.coordinates) >= max(nv, 2):
            groups.append(joint.coordinates)
        for k, name in enumerate(joint.coordinates):
            alike.setdefault((type(joint).__name__, depth[joint.child], k), []).append(name)
    return groups + [tuple(names) for names in alike.values() if len(names) == nv > 1]
