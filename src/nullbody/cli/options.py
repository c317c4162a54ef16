"""What the commands share: their options, lists such as s1=0.6,s2=0.6, and the model that is asked for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nullbody.errors import InputError, UnknownName

if TYPE_CHECKING:
    from nullbody.mechanism import Mechanism
    from nullbody.model import Model

__all__ = [
    "Guess",
    "Independent",
    "Json",
    "MechanismName",
    "Out",
    "Parameters",
    "Rates",
    "Values",
    "assignments",
    "complete",
    "mechanism_of",
    "model_of",
    "names",
    "number",
]

_LIST = "NAME=VALUE,..."
_MECHANISM = "A name that `nullbody models` lists, or a model file: .yaml, .xml (MJCF), .urdf."

MechanismName = Annotated[str, typer.Argument(metavar="MECHANISM", help=_MECHANISM)]
Json = Annotated[bool, typer.Option("--json", help="Write JSON, and nothing else, to stdout.")]
Values = list[str] | None
Parameters = Annotated[Values, typer.Option("--set", metavar=_LIST, help="Parameters that differ from their defaults.")]
Independent = Annotated[
    Values, typer.Option(metavar="NAME,...", help="Independent coordinates; the actuated ones by default.")
]
Guess = Annotated[
    Values, typer.Option(metavar=_LIST, help="Coordinates near the wanted branch; by default the mechanism's home.")
]
Rates = Annotated[Values, typer.Option(metavar=_LIST, help="Rates of independent coordinates; those not named are 0.")]
Out = Annotated[Path | None, typer.Option("--out", "-o", metavar="FILE", help="Also write this file.")]


def names(texts: Sequence[str] | None) -> tuple[str, ...]:
    """The names of lists such as "s1,s2,s3"; an option that is given twice adds to the list."""
    return tuple(part.strip() for text in texts or () for part in text.split(",") if part.strip())


def number(text: str, what: str) -> float:
    """A number, and nothing else.

    Raises:
        InputError: the text is no number.
    """
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{what} must be a number, not {text!r}") from None


def assignments(texts: Sequence[str] | None, option: str) -> dict[str, float]:
    """The values of lists such as "s1=0.6,s2=0.6"; an option that is given twice adds to the list.

    Raises:
        InputError: a part is not name=value, a value is no number, or a name comes twice.
    """
    values: dict[str, float] = {}
    for part in names(texts):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if not name or not equals:
            raise InputError(f"{option} takes name=value,name=value and so on; {part!r} is not of that form")
        if name in values:
            raise InputError(f"{option} gives {name} twice: {values[name]:g} and {value}")
        values[name] = number(value, f"{option} {name}")
    return values


def complete(values: Mapping[str, float], known: Iterable[str], kind: str) -> dict[str, float]:
    """Values for all known names, 0 for those that are not given.

    Raises:
        UnknownName: a value has another name.
    """
    completed = dict.fromkeys(known, 0.0)
    for name, value in values.items():
        if name not in completed:
            raise UnknownName(kind, name, completed)
        completed[name] = value
    return completed


def mechanism_of(name: str) -> Mechanism:
    """A mechanism of the catalog by name, or that of a model file by its path.

    Raises:
        UnknownName: the catalog has no mechanism of this name, and it does not end as model files do.
        ModelFileError: a model file that cannot be read.
    """
    from nullbody import catalog
    from nullbody.formats import read_model
    from nullbody.formats.model_file import SUFFIXES

    path = Path(name)
    return read_model(path) if path.suffix.lower() in SUFFIXES else catalog.mechanism(name)


def model_of(name: str, independent: Sequence[str] | None, parameters: Sequence[str] | None) -> Model:
    """The model of a mechanism of the catalog or of a model file, as `--independent` and `--set` ask for it."""
    from nullbody.model import build

    return build(mechanism_of(name), assignments(parameters, "--set"), independent=names(independent) or None)
