"""What a builder has been told so far, before it becomes a mechanism."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypedDict

from nullbody.errors import MechanismError
from nullbody.mechanism.body import Body, Placement
from nullbody.mechanism.constraints.base import AbstractConstraint
from nullbody.mechanism.joints.base import AbstractJoint
from nullbody.mechanism.loads.base import AbstractLoad
from nullbody.mechanism.mechanism import Actuator, Mechanism
from nullbody.mechanism.parameter import Parameter
from nullbody.typing import Scalar

__all__ = ["ORIGIN", "AbstractRecord", "Choice", "Place", "Told", "check_name"]

#: A frame on a body: a Placement, or its origin alone [m].
Place = Placement | Sequence[Scalar]

#: The body's own frame.
ORIGIN = (0, 0, 0)


class Choice(TypedDict, total=False):
    """What may be said of every joint beside its geometry.

    Attributes:
        names: of its coordinates; by default made from the joint's name.
        coordinates: "relative" for its own, "body" for those of the child against the ground: the joint then closes
            a loop.
        tree: whether it must stand in the spanning tree.
        loop: whether it must close a loop.
    """

    names: str | Sequence[str]
    coordinates: Literal["relative", "body"]
    tree: bool
    loop: bool


@dataclass(frozen=True)
class Told:
    """A joint as it was written.

    Attributes:
        joint: with the names of its coordinates where it can have some.
        role: "loop" or "tree" where that was said.
        own: the body that gets coordinates of its own on account of it.
    """

    joint: AbstractJoint
    role: Literal["any", "loop", "tree"] = "any"
    own: str | None = None


class AbstractRecord(ABC):
    """Everything in the order in which it was told. `build` ends it."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._built = False
        self._bodies: dict[str, Body] = {}
        self._parameters: dict[str, Parameter] = {}
        self._told: dict[str, Told] = {}
        self._constraints: dict[str, AbstractConstraint] = {}
        self._loads: dict[str, AbstractLoad] = {}
        self._actuators: dict[str, Actuator] = {}
        self._kinds: dict[str, str] = {}  # constraints that ask for more than their class does: gear, rack
        self._home: dict[str, Scalar] = {}

    @abstractmethod
    def build(self) -> Mechanism:
        """The mechanism; the builder is at its end."""

    def _note(self, kind: str, table: dict[str, Any], name: str, entry: Any) -> str:
        """Add an entry, unless its name is taken or the builder is at its end."""
        self._alive()
        check_name(kind, name)
        taken = {**self._told, **self._constraints} if kind in ("joint", "constraint") else table
        if name in taken:
            raise MechanismError(f"the {kind} name {name!r} is taken in {self._name!r}: choose another one")
        table[name] = entry
        return name

    def _alive(self) -> None:
        if self._built:
            raise MechanismError(f"this builder has built {self._name!r} and is at its end: start a new one")


def check_name(kind: str, name: object) -> None:
    """Raise unless it is a text that is not empty."""
    if not isinstance(name, str) or not name:
        raise MechanismError(f"the name of a {kind} is a text, not {name!r}")
