"""The same model in other charts: derived and compiled when first asked for, kept for the process."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from nullbody.mechanism import Mechanism
from nullbody.model.build import build
from nullbody.model.model import Model

__all__ = ["Key", "chart"]

_KEPT = 64  # charts in memory


class Key:
    """A mechanism as a key: by identity, since its parameters are in the model."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Key) and other.mechanism is self.mechanism

    def __hash__(self) -> int:
        return id(self.mechanism)


def chart(model: Model, independent: tuple[str, ...], rows: tuple[str, ...] | None) -> Model:
    """A model with the parameter values of another one, in other independent coordinates and rows.

    Raises:
        UnknownName, InputError, SingularityError: as `derive`.
    """
    return replace(_built(Key(model.mechanism), independent, rows), given=model.given, values=model.values)


@lru_cache(maxsize=_KEPT)
def _built(key: Key, independent: tuple[str, ...], rows: tuple[str, ...] | None) -> Model:
    return build(key.mechanism, independent=independent, rows=rows, basis=independent)
