"""All small mechanisms by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from nullbody.mechanism import Mechanism
from tests.verify.hard import SPECIAL
from tests.verify.mechanisms import (
    CONSTRAINTS,
    LOADS,
    LOOP_JOINTS,
    TREE_JOINTS,
    constrained,
    loaded,
    loop,
    quaternion_loop,
    tree,
)

__all__ = ["CASES"]

#: Everything by name.
CASES: Mapping[str, Callable[[], Mechanism]] = {
    **{f"tree {name}": partial(tree, name) for name in TREE_JOINTS},
    **{f"loop {name}": partial(loop, name) for name in LOOP_JOINTS},
    **{f"quaternion loop {name}": partial(quaternion_loop, name) for name in LOOP_JOINTS},
    **{f"constraint {name}": partial(constrained, name) for name in CONSTRAINTS},
    **{f"load {name}": partial(loaded, name) for name in LOADS},
    **SPECIAL,
}
