"""A digest of all that a mechanism says, for what is made from it once and kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from fractions import Fraction
from hashlib import blake2b
from typing import Any

from nullbody.mechanism.mechanism import Mechanism

__all__ = ["fingerprint"]

_PLAIN = (str, int, float, bool, Fraction, type(None))


class _ForeignPartError(Exception):
    """A part that is not this package's own data: what it does cannot be read off it."""


def fingerprint(mechanism: Mechanism) -> str | None:
    """The same for equal mechanisms in any process; None where a part is of a type that is not this package's."""
    try:
        return blake2b(repr(_plain(mechanism)).encode(), digest_size=20).hexdigest()
    except _ForeignPartError:
        return None


def _plain(value: Any) -> Any:
    if type(value) in _PLAIN:
        return type(value).__name__, repr(value)
    if type(value) in (list, tuple):
        return tuple(_plain(part) for part in value)
    if isinstance(value, Mapping):
        return tuple((_plain(key), _plain(part)) for key, part in value.items())
    kind = type(value)
    if is_dataclass(value) and kind.__module__.split(".")[0] == "nullbody":
        return kind.__qualname__, *(_plain(getattr(value, field.name)) for field in fields(value))
    raise _ForeignPartError
