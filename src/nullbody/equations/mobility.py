"""Mobility: how many degrees of freedom there are, and why."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Mobility"]


@dataclass(frozen=True)
class Mobility:
    """nv = nq - rank, and where the rank comes from.

    Attributes:
        nq: coordinates, Euler parameters included.
        rows: equations: loops, constraints, norms of Euler parameters.
        nonholonomic: how many of them are equations in rates only.
        rank: how many of them are independent on the constraint manifold.
        always: labels of rows that repeat others in every configuration, closed or not.
        closed: labels of rows that repeat others only where the loops are closed.
        home_rank: the rank at the home, lower where the home is a singular configuration.
        sampled: configurations with closed loops that were looked at; 0 where none was found near the home, and the
            rank is that of a generic point off the manifold.
    """

    nq: int
    rows: int
    nonholonomic: int
    rank: int
    always: tuple[str, ...]
    closed: tuple[str, ...]
    home_rank: int
    sampled: int

    @property
    def nv(self) -> int:
        """Degrees of freedom of velocities."""
        return self.nq - self.rank

    @property
    def gruebler(self) -> int:
        """What counting alone gives (Gruebler, Kutzbach): nq - rows."""
        return self.nq - self.rows

    def __str__(self) -> str:
        """The count with its reasons, a line each."""
        lines = [f"mobility {self.nv}: {self.nq} coordinates - {self.rank} independent of {self.rows} equations"]
        if self.gruebler != self.nv:
            lines.append(f"  counting alone gives {self.gruebler} (Gruebler, Kutzbach)")
        if self.nonholonomic:
            reachable = self.nv + self.nonholonomic
            lines.append(f"  {self.nonholonomic} nonholonomic: positions have {reachable} degrees of freedom")
        if self.always:
            lines.append(f"  repeats other equations in every configuration: {', '.join(self.always)}")
        if self.closed:
            lines.append(f"  repeats other equations wherever the loops are closed: {', '.join(self.closed)}")
        if self.sampled and self.home_rank < self.rank:
            lines.append(f"  the home is a singular configuration: only {self.home_rank} are independent there")
        if not self.sampled:
            lines.append("  no closed configuration was found near the home: the rank is that of a generic one")
        return "\n".join(lines)
