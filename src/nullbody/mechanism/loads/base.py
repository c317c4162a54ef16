"""What a load must provide. A new one is one file in this folder."""

from __future__ import annotations

from abc import ABC
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from nullbody.mechanism.body import Placement
from nullbody.mechanism.kinematics import Kinematics
from nullbody.typing import Scalar

__all__ = ["AbstractLoad"]


@dataclass(frozen=True)
class AbstractLoad(ABC):
    """Forces that depend on the motion: a potential, and efforts that do work at flows.

        Q_j = -dU/dq_j + sum_k effort_k dflow_k/dq'_j,       power = sum_k effort_k flow_k

    Attributes:
        name: unique among the loads.
    """

    name: str

    @property
    def bodies(self) -> tuple[str, ...]:
        """Bodies that it names."""
        return ()

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Coordinates that it names."""
        return ()

    @property
    def scalars(self) -> tuple[Scalar, ...]:
        """Its numbers and texts in parameters."""
        return ()

    @property
    def expressions(self) -> tuple[Scalar, ...]:
        """Its texts in parameters, coordinates, rates and t."""
        return ()

    @property
    def signs(self) -> tuple[tuple[str, Scalar, str], ...]:
        """(what, scalar, "positive" or "non-negative") of scalars that must not be of another sign."""
        return ()

    @property
    def placements(self) -> tuple[Placement, ...]:
        """The frames that it names."""
        return ()

    def potential(self, motion: Kinematics) -> Any:
        """U(q) [J]."""
        return 0

    def kinetic(self, motion: Kinematics) -> Any:
        """Kinetic energy beside that of the bodies, a quadratic form in the rates [J]."""
        return 0

    def efforts(self, motion: Kinematics) -> Sequence[tuple[Any, Any]]:
        """(effort, flow) pairs: a force and a speed, a torque and an angular velocity; flows are linear in rates."""
        return []
