"""The spanning tree: which joints give bodies their poses, and which close loops."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from nullbody.errors import MechanismError
from nullbody.mechanism.body import GROUND

__all__ = ["Branch", "Edge", "bases", "spanning_tree", "unreached"]


@dataclass(frozen=True)
class Edge:
    """A joint as the search sees it.

    Attributes:
        name: of the joint; of the body that gets coordinates of its own for an edge that no joint stands behind.
        parent, child: as they were written.
        cost: coordinates that it would have in the tree.
        role: "loop" never stands in the tree, "tree" must, "wanted" should, because its coordinates are used.
        one_way: whether it cannot be turned round.
    """

    name: str
    parent: str
    child: str
    cost: float
    role: Literal["any", "loop", "tree", "wanted"] = "any"
    one_way: bool = False

    def other(self, body: str) -> str:
        """The body at the other end."""
        return self.child if body == self.parent else self.parent


@dataclass(frozen=True)
class Branch:
    """An edge of the tree, and whether it leads from its child to its parent."""

    edge: Edge
    turned: bool


def spanning_tree(edges: Sequence[Edge]) -> list[Branch]:
    """The tree that grows from the ground, by the joint with the fewest coordinates; of equal ones by the one nearest
    to the ground, then by the order in which they were written.

    Joints of the role "tree" all stand in it, those of the role "wanted" where they close no circle among themselves.
    Bodies that only loop joints hold are not in it.

    Raises:
        MechanismError: joints of the role "tree" form a circle.
    """
    held = _held(edges)
    level = {GROUND: 0}
    branches: list[Branch] = []
    _absorb(GROUND, held, level, branches)
    while True:
        frontier = [
            (edge.cost + _penalty(edge, level), level[_known_end(edge, level)], number, edge)
            for number, edge in enumerate(edges)
            if edge.role != "loop" and _leads_out(edge, level)
        ]
        if not frontier:
            return branches
        _, _, _, chosen = min(frontier, key=lambda entry: entry[:3])
        _enter(chosen, held, level, branches)


def unreached(bodies: Sequence[str], branches: Iterable[Branch]) -> list[str]:
    """Bodies that the tree does not reach, in their own order."""
    reached = {body for branch in branches for body in (branch.edge.parent, branch.edge.child)}
    return [body for body in bodies if body not in reached]


def bases(rest: Sequence[str], edges: Sequence[Edge]) -> list[str]:
    """Of bodies that the tree does not reach, the first of each group that joints of trees hold together; not one that
    hangs by a joint that cannot be turned round.
    """
    neighbours: dict[str, list[str]] = {body: [] for body in rest}
    for edge in edges:
        if edge.role != "loop" and edge.parent in neighbours and edge.child in neighbours:
            neighbours[edge.parent].append(edge.child)
            neighbours[edge.child].append(edge.parent)
    hung = {edge.child for edge in edges if edge.one_way}
    found, seen = [], set[str]()
    for body in rest:
        group, waiting = [], [body]
        while waiting:
            inner = waiting.pop()
            if inner not in seen:
                seen.add(inner)
                group.append(inner)
                waiting += neighbours[inner]
        if group:
            first = [member for member in rest if member in group and member not in hung] or group
            found.append(first[0])
    return found


def _leads_out(edge: Edge, level: dict[str, int]) -> bool:
    """Whether it joins a body of the tree with one outside, in a direction that it can have."""
    inside = [end in level for end in (edge.parent, edge.child)]
    return inside == [True, False] or (inside == [False, True] and not edge.one_way)


def _known_end(edge: Edge, level: dict[str, int]) -> str:
    return edge.parent if edge.parent in level else edge.child


def _penalty(edge: Edge, level: dict[str, int]) -> float:
    """Several coordinates may not keep their meaning in a joint that is turned round."""
    return 0.5 if edge.cost > 2 and edge.parent not in level else 0


def _enter(edge: Edge, held: dict[str, list[Edge]], level: dict[str, int], branches: list[Branch]) -> None:
    inner = _known_end(edge, level)
    outer = edge.other(inner)
    level[outer] = level[inner] + 1
    branches.append(Branch(edge, inner != edge.parent))
    _absorb(outer, held, level, branches)


def _absorb(body: str, held: dict[str, list[Edge]], level: dict[str, int], branches: list[Branch]) -> None:
    """Add all that must hang on a body that has just come into the tree."""
    waiting = [body]
    while waiting:
        inner = waiting.pop(0)
        for edge in held.get(inner, []):
            outer = edge.other(inner)
            if outer not in level:
                _check_way(edge, inner)
                level[outer] = level[inner] + 1
                branches.append(Branch(edge, inner != edge.parent))
                waiting.append(outer)


def _check_way(edge: Edge, inner: str) -> None:
    if inner != edge.parent and edge.one_way:
        raise MechanismError(
            f"joint {edge.name!r} leads from {edge.parent!r} to {edge.child!r}, which is nearer to the ground: "
            "exchange its parent and child"
        )


def _held(edges: Sequence[Edge]) -> dict[str, list[Edge]]:
    """The joints that are chosen beforehand, by body: a forest of those that must, then of those that should."""
    group: dict[str, str] = {}

    def root(body: str) -> str:
        while body in group:
            body = group[body]
        return body

    held: dict[str, list[Edge]] = {}
    for role in ("tree", "wanted"):
        for edge in edges:
            if edge.role != role:
                continue
            a, b = root(edge.parent), root(edge.child)
            if a != b:
                group[a] = b
                for end in (edge.parent, edge.child):
                    held.setdefault(end, []).append(edge)
            elif role == "tree":
                names = ", ".join(repr(other.name) for other in edges if other.role == "tree")
                raise MechanismError(
                    f"{edge.name!r} closes a circle of joints that are all asked to stand in the tree, out of {names}: "
                    "leave tree=True, or the body's own coordinates, out for one of them"
                )
    return held
