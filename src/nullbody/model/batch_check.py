"""Which states of a batch have lost their digits: the rules of `check`, for arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nullbody.errors import InputError, SingularityError
from nullbody.tolerances import REGULAR_DOUBT, REGULAR_LOSS, REGULAR_SPREAD, SINGLE_DOUBT, SINGLE_LOSS, SINGLE_SPREAD

__all__ = ["SINGULAR", "Limits", "dtype_of", "limits_of", "refuse", "singular_dynamics", "singular_kinematics"]

#: What to do with singular states.
SINGULAR = ("raise", "nan")


@dataclass(frozen=True)
class Limits:
    """Beyond which a result is refused.

    Attributes:
        spread: |N|^2.
        doubt: (|B| against the product of its column lengths)^-2.
        loss: of Mr.
    """

    spread: float
    doubt: float
    loss: float

    @property
    def worst(self) -> tuple[float, float, float, float]:
        """For |N|^2, doubt, loss and -loss."""
        return self.spread, self.doubt, self.loss, self.loss


_LIMITS = {
    np.dtype(np.float64): Limits(REGULAR_SPREAD, REGULAR_DOUBT, REGULAR_LOSS),
    np.dtype(np.float32): Limits(SINGLE_SPREAD, SINGLE_DOUBT, SINGLE_LOSS),
}


def dtype_of(given: object) -> np.dtype[Any]:
    """The type of numbers asked for.

    Raises:
        InputError: neither float64 nor float32.
    """
    try:
        dtype = np.dtype(given)  # type: ignore[call-overload]
    except (TypeError, ValueError):
        raise InputError(f"batches are float64 or float32, not {given!r:.80}") from None
    limits_of(dtype)
    return dtype


def limits_of(dtype: np.dtype[Any]) -> Limits:
    """The limits for numbers of a type.

    Raises:
        InputError: neither float64 nor float32.
    """
    if dtype not in _LIMITS:
        raise InputError(f"batches are float64 or float32, not {dtype}")
    return _LIMITS[dtype]


def singular_kinematics(limits: Limits, spread: NDArray[Any], doubt: NDArray[Any]) -> NDArray[np.bool_]:
    """Where N has lost too many digits."""
    return np.asarray(~((spread < limits.spread) & (doubt < limits.doubt)))


def singular_dynamics(
    limits: Limits, result: NDArray[Any], spread: NDArray[Any], doubt: NDArray[Any], loss: NDArray[Any]
) -> NDArray[np.bool_]:
    """Where a result of the dynamics has lost too many digits."""
    with np.errstate(invalid="ignore", over="ignore"):
        worst = (x.max(initial=0.0) for x in (spread, doubt, loss, -loss))  # of NaN it is NaN
        if all(x < limit for x, limit in zip(worst, limits.worst, strict=True)) and np.isfinite(result.sum()):
            return np.zeros(len(result), dtype=bool)
        lost = ~(np.abs(loss) < limits.loss)
        if not np.isfinite(result.sum()):
            lost |= ~np.isfinite(result).all(axis=tuple(range(1, result.ndim)))
    return np.asarray(lost | singular_kinematics(limits, spread, doubt))


def refuse(wrong: NDArray[np.bool_], singular: object, what: str, delta: NDArray[Any], *results: NDArray[Any]) -> None:
    """Raise where states are singular, or set all their results to NaN.

    Raises:
        SingularityError: says how many and which is the first.
        InputError: `singular` is neither "raise" nor "nan".
    """
    if not isinstance(singular, str) or singular not in SINGULAR:
        raise InputError(f"singular must be one of {', '.join(map(repr, SINGULAR))}, not {singular!r}")
    if not wrong.any():
        return
    if singular == "raise":
        count, first = int(wrong.sum()), int(np.flatnonzero(wrong)[0])
        raise SingularityError(
            f"{what} {count} of {len(wrong)} states, the first one is state {first} (|B| = {float(delta[first]):.3g}). "
            "singular='nan' gives NaN for them; the model evaluates one state and says more"
        )
    for result in results:
        result[wrong] = np.nan
