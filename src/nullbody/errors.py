"""The errors of nullbody.

    NullbodyError
    |- InputError          a caller's mistake: a wrong size, type, name or value
    |  |- UnknownName        a name that does not exist; the message suggests the nearest
    |  |- ParameterError     a parameter that is not physical: zero, negative, NaN, no number
    |  |- MechanismError     a mechanism that makes no sense: disconnected, duplicate names, no mass
    |  |- ExpressionError    a text outside the small grammar of parameter expressions
    |  |- ModelFileError     a model file that cannot be read; `.file`, `.place` and `.line` say where
    |  |- StateError         a state off the constraint manifold, or not finite
    |- SingularityError    the chosen independent coordinates are singular, or the configuration is
    |- AssemblyError       loops that cannot be closed
    |- SimulationError     a simulation that ended early; `.trajectory` holds what was reached
    |- VerificationError   an independent engine that disagrees, or is missing
    |- CacheError          a kernel cache that cannot be written or trusted
    |- OutputError         a file or folder that cannot be written

Messages say what, where, how much, and what to try.
"""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any

__all__ = [
    "AssemblyError",
    "CacheError",
    "ExpressionError",
    "InputError",
    "MechanismError",
    "ModelFileError",
    "NullbodyError",
    "OutputError",
    "ParameterError",
    "SimulationError",
    "SingularityError",
    "StateError",
    "UnknownName",
    "VerificationError",
]


class NullbodyError(Exception):
    """The base of every error that nullbody raises on purpose."""


class InputError(NullbodyError, ValueError):
    """A caller's mistake: a wrong size, type, name or value."""


class UnknownName(InputError):
    """A name that does not exist.

    Args:
        kind: what the name should be, e.g. "coordinate".
        name: the name that was given.
        known: the names that exist.
        place: where the name stands, for the message.
    """

    def __init__(self, kind: str, name: object, known: Iterable[str], place: str = "") -> None:
        names = list(known)
        near = [candidate for candidate in names if candidate.lower() == str(name).lower()]
        near = near or get_close_matches(str(name), names, n=1, cutoff=0.5)
        hint = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(names) or 'none'}"
        super().__init__(f"{place + ': ' if place else ''}there is no {kind} {name!r}; {hint}")
        self.name = name
        self.suggestion = near[0] if near else None


class ParameterError(InputError):
    """A parameter that is not physical: zero, negative, NaN, or no number."""


class MechanismError(InputError):
    """A mechanism that makes no sense: disconnected, duplicate names, no mass."""


class ExpressionError(InputError):
    """A text outside the small grammar of parameter expressions."""


class ModelFileError(InputError):
    """A model file that cannot be read.

    Attributes:
        file: its path, or "text".
        place: the path of keys or the element, such as "joints.shaft.axis" or "<geom name='tip'>".
        line: its line in the file, from 1; 0 where there is none.
    """

    def __init__(self, what: str, *, file: str = "text", place: str = "", line: int = 0) -> None:
        super().__init__(f"{located(file, place, line)}: {what}")
        self.file = file
        self.place = place
        self.line = line


def located(file: str, place: str = "", line: int = 0) -> str:
    """A place in a file as messages give it: file, line 12, joints.shaft."""
    return ", ".join([file, *([f"line {line}"] if line else []), *([place] if place else [])])


class StateError(InputError):
    """A state off the constraint manifold, or not finite."""


class SingularityError(NullbodyError):
    """The chosen independent coordinates are singular, or the configuration is."""


class AssemblyError(NullbodyError):
    """Loops that cannot be closed.

    Attributes:
        loop: name of the loop joint with the widest gap.
        gap: that gap [m].
        reach: fraction of the way from the guess to the target along which the loops close.
    """

    def __init__(self, message: str, *, loop: str = "", gap: float = float("nan"), reach: float = 0.0) -> None:
        super().__init__(message)
        self.loop = loop
        self.gap = gap
        self.reach = reach


class SimulationError(NullbodyError):
    """A simulation that ended early; `trajectory` holds what was reached."""

    def __init__(self, message: str, trajectory: Any = None) -> None:
        super().__init__(message)
        self.trajectory = trajectory


class VerificationError(NullbodyError):
    """An independent engine that disagrees, or is missing."""


class CacheError(NullbodyError, OSError):
    """A kernel cache that cannot be written or trusted."""


class OutputError(NullbodyError, OSError):
    """A file or folder that cannot be written."""
