"""State: coordinates on the constraint manifold and independent velocities."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from nullbody.errors import InputError, UnknownName
from nullbody.typing import FloatArray

__all__ = ["State", "vector"]


@dataclass(frozen=True, eq=False)
class State:
    """A state of a model: made by `model.state`, `assemble` or a simulation, so that the loops are closed.

    `state["alpha1"]` is a coordinate by name.

    Attributes:
        q: all coordinates, in the order of `coordinates` [m, rad]; read-only.
        v: rates of the independent coordinates [m/s, rad/s]; read-only.
        coordinates, independent: their names.
        parameters: values of the model that made it; another model checks the closures anew.
        t: the time [s], for mechanisms with drivers.
    """

    q: FloatArray
    v: FloatArray
    coordinates: tuple[str, ...]
    independent: tuple[str, ...]
    parameters: tuple[float, ...] = ()
    t: float = 0.0

    def __post_init__(self) -> None:
        for array in (self.q, self.v):
            array.flags.writeable = False

    def __getitem__(self, name: str) -> float:
        if name not in self.coordinates:
            raise UnknownName("coordinate", name, self.coordinates)
        return float(self.q[self.coordinates.index(name)])

    @property
    def positions(self) -> Mapping[str, float]:
        """Coordinates by name."""
        return MappingProxyType(dict(zip(self.coordinates, self.q.tolist(), strict=True)))

    @property
    def rates(self) -> Mapping[str, float]:
        """Independent rates by name."""
        return MappingProxyType(dict(zip(self.independent, self.v.tolist(), strict=True)))

    def __repr__(self) -> str:
        shown = ", ".join(f"{name}={value:.6g}" for name, value in self.positions.items())
        rates = ", ".join(f"{name}'={value:.6g}" for name, value in self.rates.items())
        return f"<State {shown}; {rates}>"


def vector(values: object, names: tuple[str, ...], kind: str, *, finite: bool = True) -> FloatArray:
    """A new float64 vector in the order of `names`, from a sequence, an array or a mapping by name.

    With `finite=False` the caller judges NaN and infinity.

    Raises:
        UnknownName: a mapping has a name that does not exist.
        InputError: missing names, a wrong size, no numbers, or values that are not finite.
    """
    if isinstance(values, Mapping):
        for name in values:
            if name not in names:
                raise UnknownName(kind, name, names)
        missing = [name for name in names if name not in values]
        if missing:
            raise InputError(f"{kind} values are missing: {', '.join(missing)}")
        values = [values[name] for name in names]
    try:
        raw = np.asarray(values)
        if raw.dtype.kind not in "iufO" or any(isinstance(x, str) for x in raw.flat if raw.dtype.kind == "O"):
            raise TypeError("texts, truth values and complex numbers would convert")
        array = np.array(raw, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{kind} values must be real numbers, not {values!r}") from None
    if array.shape != (len(names),):
        raise InputError(
            f"{len(names)} {kind} values are needed ({', '.join(names)}), not an array of shape {array.shape}"
        )
    if finite and not np.isfinite(array).all():
        bad = names[int(np.flatnonzero(~np.isfinite(array))[0])]
        raise InputError(f"{kind} {bad} must be finite, not {array[names.index(bad)]}")
    return array
