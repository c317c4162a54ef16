"""sweep: a sequence of assemblies along a path of known coordinates, one branch throughout."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from nullbody.errors import AssemblyError
from nullbody.kinematics.assemble import assemble
from nullbody.model import Model, State

__all__ = ["sweep"]


def sweep(
    model: Model, path: Sequence[Mapping[str, float]], guess: State | Mapping[str, float] | None = None
) -> list[State]:
    """States at rest along a path, each continued from the one before.

    Args:
        model: the model.
        path: known coordinates by name, point by point [m, rad].
        guess: near the branch of the first point; the mechanism's home by default.

    Raises:
        AssemblyError: the path leaves the reachable set, or the branch ends; the message says at which point.
    """
    states: list[State] = []
    here = guess
    for number, known in enumerate(path):
        try:
            here = assemble(model, known, guess=here, same_branch=number > 0)
        except AssemblyError as error:
            raise AssemblyError(
                f"point {number + 1} of {len(path)} of the path: {error}",
                loop=error.loop,
                gap=error.gap,
                reach=error.reach,
            ) from None
        states.append(here)
    return states
