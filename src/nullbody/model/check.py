"""What a model refuses: open loops, loops closed the wrong way round, results that have lost their digits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nullbody.errors import AssemblyError, SingularityError, StateError
from nullbody.tolerances import GIVEN_CLOSED, LARGE_SPREAD, REGULAR_DOUBT, REGULAR_LOSS, REGULAR_SPREAD
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from nullbody.model.model import Model

__all__ = ["check_closed", "check_dynamic", "check_facing", "check_redundant", "check_regular"]


def check_closed(model: Model, q: FloatArray, t: float) -> None:
    """Raise where the loops are open, or closed the wrong way round.

    Raises:
        StateError: names the loop, the gap and what to do.
        AssemblyError: the loops can never close for these parameter values.
    """
    residual = model.residual(q, t)
    if not np.abs(residual).max(initial=0.0) <= GIVEN_CLOSED:
        worst = int(np.abs(residual).argmax())
        loop, _, row = model.closure_labels[worst].rpartition(" ")
        units = dict(model.mechanism.holonomic_rows)
        raise StateError(
            f"loop {loop!r} is open by {abs(residual[worst]):.3g} {units[model.closure_labels[worst]]} along "
            f"{row}: the state is not on the constraint manifold of these parameters. "
            "nullbody.assemble(model, {...}) closes the loops for given coordinates, nullbody.consistent the "
            "state as it is"
        )
    check_redundant(model, q, t)
    check_facing(model, q, t)


def check_facing(model: Model, q: FloatArray, t: float = 0.0) -> None:
    """Raise where a loop is closed the wrong way round.

    Raises:
        StateError: the axes of a loop joint point against each other.
    """
    cosines = model.evaluate("facing", q, t=t)[0]
    if len(cosines) and not cosines.min() > 0:
        loop = model.facing[int(cosines.argmin())]
        raise StateError(
            f"loop {loop!r} is closed the wrong way round: an axis of its joint points against the other "
            f"(cosine {cosines.min():.3g}). Start from a guess nearer to the wanted assembly"
        )


def check_redundant(model: Model, q: FloatArray, t: float = 0.0) -> None:
    """Raise where an equation that `derive` left out as a repetition is not fulfilled: no motion can mend that.

    Raises:
        AssemblyError: it is open by more than a nanometre for these parameter values.
    """
    dropped = model.evaluate("redundant", q, t=t)[0]
    if not np.abs(dropped).max(initial=0.0) <= GIVEN_CLOSED:
        rows = [row for row in model.mechanism.holonomic_rows if row[0] not in model.closure_labels]
        worst = int(np.abs(dropped).argmax())
        label, unit = rows[worst]
        raise AssemblyError(
            f"the loops of {model.mechanism.name!r} can never close for these parameters: {label!r} is open by "
            f"{abs(dropped[worst]):.3g} {unit} and no coordinate can change that independently of the other "
            f"equations. Check the lengths, offsets and drivers"
        )


def check_dynamic(
    independent: tuple[str, ...],
    result: FloatArray,
    delta: FloatArray,
    spread: FloatArray,
    doubt: FloatArray,
    loss: FloatArray,
) -> None:
    """Raise where a result of the dynamics has lost too many digits.

    Raises:
        SingularityError: the independent coordinates or the reduced mass matrix are singular here.
    """
    lost = not abs(loss) < REGULAR_LOSS or not np.isfinite(result).all()
    check_regular(independent, delta, spread, doubt, limit=LARGE_SPREAD if lost else REGULAR_SPREAD)
    if lost:
        raise SingularityError(
            "the reduced mass matrix is singular here, to rounding: a motion of the mechanism moves no mass, or "
            "next to none, or a free joint stands at theta = +-90 degrees. Check the masses and inertias, or "
            "stay away"
        )


def check_regular(
    independent: tuple[str, ...],
    delta: FloatArray,
    spread: FloatArray,
    doubt: FloatArray,
    *,
    limit: float = REGULAR_SPREAD,
) -> None:
    """Raise where N has lost too many digits.

    Raises:
        SingularityError: the independent coordinates are singular here.
    """
    if spread < limit and doubt < REGULAR_DOUBT:
        return
    size = float(np.sqrt(spread)) if np.isfinite(spread) else float("inf")
    lost = min(16.0, max(0.0, np.log10(size))) if doubt < REGULAR_DOUBT else 16.0
    whose = f"the independent coordinates {', '.join(independent)} are" if independent else "the mechanism is"
    raise SingularityError(
        f"{whose} singular here: "
        f"|B| = {float(delta):.3g}, |N| = {size:.3g}, so results would lose {lost:.0f} of 16 digits. "
        "Derive with other independent coordinates, or stay away from this configuration"
    )
