"""The spanning tree: fewest coordinates first, then nearest to the ground; asked roles are kept."""

from __future__ import annotations

import pytest

from nullbody.errors import MechanismError
from nullbody.mechanism.builder.spanning_tree import Edge, bases, spanning_tree, unreached


def tree(*edges: Edge) -> list[str]:
    """Names of the joints of the tree, those turned round with a minus."""
    return [f"{'-' if branch.turned else ''}{branch.edge.name}" for branch in spanning_tree(edges)]


def test_a_ring_is_cut_at_the_far_side() -> None:
    names = ["ground", "a", "b", "c", "d"]
    ring = [Edge(f"{p}{c}", p, c, 1) for p, c in zip(names, [*names[1:], "ground"], strict=True)]
    assert tree(*ring) == ["grounda", "-dground", "ab", "-cd"]


def test_the_joint_with_most_coordinates_closes_the_loop() -> None:
    edges = (Edge("ball", "ground", "a", 4), Edge("pin", "a", "b", 1), Edge("shaft", "ground", "b", 1))
    assert tree(*edges) == ["shaft", "-pin"]


def test_an_asked_tree_joint_stands_in_it_whatever_it_costs() -> None:
    edges = (Edge("ball", "ground", "a", 4, "tree"), Edge("pin", "a", "b", 1), Edge("shaft", "ground", "b", 1))
    assert tree(*edges) == ["ball", "shaft"]


def test_an_asked_loop_joint_never_does() -> None:
    edges = (Edge("shaft", "ground", "a", 1, "loop"), Edge("pin", "a", "b", 1), Edge("ball", "ground", "b", 4))
    assert tree(*edges) == ["ball", "-pin"]


def test_a_wanted_joint_is_preferred_but_gives_way_to_asked_ones() -> None:
    shaft, pin, ball = ("shaft", "ground", "a", 1), ("pin", "a", "b", 1), ("ball", "ground", "b", 4)
    assert set(tree(Edge(*shaft), Edge(*pin), Edge(*ball, "wanted"))) == {"ball", "shaft"}
    assert set(tree(Edge(*shaft, "tree"), Edge(*pin, "tree"), Edge(*ball, "wanted"))) == {"shaft", "pin"}


def test_asked_tree_joints_in_a_circle_are_refused() -> None:
    with pytest.raises(MechanismError, match=r"'pin' closes a circle .*'shaft', 'ball', 'pin': leave tree=True"):
        tree(
            Edge("shaft", "ground", "a", 1, "tree"),
            Edge("ball", "ground", "b", 4, "tree"),
            Edge("pin", "a", "b", 1, "tree"),
        )


def test_a_joint_of_one_way_is_not_turned_round() -> None:
    with pytest.raises(MechanismError, match="exchange its parent and child"):
        tree(Edge("float", "a", "ground", 7, "tree", True))
    assert tree(Edge("float", "a", "ground", 7, "any", True)) == []


def test_bodies_that_only_loop_joints_hold_are_not_reached() -> None:
    branches = spanning_tree([Edge("shaft", "ground", "a", 1), Edge("rod", "a", "b", 0, "loop")])
    assert unreached(["b", "a", "c"], branches) == ["b", "c"]


def test_each_group_of_bodies_gets_one_base() -> None:
    edges = [Edge("ab", "b", "a", 7, "tree", True), Edge("bc", "c", "b", 1), Edge("rod", "c", "d", 0, "loop")]
    assert bases(["a", "b", "c", "d"], edges) == ["b", "d"]


def test_a_ladder_of_forty_rungs_has_short_chains() -> None:
    edges = [Edge(f"post{k}", "ground", f"post{k}", 1) for k in range(41)]
    edges += [Edge(f"left{k}", f"post{k}", f"rung{k}", 1) for k in range(40)]
    edges += [Edge(f"right{k}", f"rung{k}", f"post{k + 1}", 1) for k in range(40)]
    branches = spanning_tree(edges)
    assert len(branches) == 81
    assert all(branch.edge.name.startswith(("post", "left")) for branch in branches)
