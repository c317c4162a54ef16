"""Parameters with units, signs and defaults, and their values."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Literal, get_args

from nullbody.errors import ExpressionError, MechanismError, ParameterError, UnknownName
from nullbody.expr.parse import names_in, parse
from nullbody.typing import Scalar

__all__ = ["Parameter", "parameter_values"]

Sign = Literal["positive", "non-negative", "any"]


@dataclass(frozen=True)
class Parameter:
    """A named physical constant.

    Attributes:
        name: the name that expressions use.
        default: a number, or an expression in other parameters that follows them.
        unit: SI unit, for messages and reports.
        meaning: a few words.
        sign: which values are physical.
    """

    name: str
    default: Scalar
    unit: str = ""
    meaning: str = ""
    sign: Sign = "positive"

    def __post_init__(self) -> None:
        if self.sign not in get_args(Sign):
            raise UnknownName("sign of a parameter", str(self.sign), get_args(Sign))

    def check(self, value: object) -> float:
        """The value as a float.

        Raises:
            ParameterError: not a number, not finite, or of the wrong sign.
        """
        what = f"parameter {self.name} ({self.meaning})" if self.meaning else f"parameter {self.name}"
        if isinstance(value, bool) or not isinstance(value, Real):
            raise ParameterError(f"{what} must be a number in {self.unit or 'SI units'}, not {value!r}")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise ParameterError(f"{what} must be finite, not {number}")
        if (self.sign == "positive" and number <= 0) or (self.sign == "non-negative" and number < 0):
            raise ParameterError(f"{what} must be {self.sign}, not {number:g} {self.unit}".rstrip())
        return number


def parameter_values(parameters: Sequence[Parameter], given: Mapping[str, object]) -> dict[str, float]:
    """Values of all parameters: the given ones, and the defaults evaluated with them.

    Raises:
        UnknownName: a given name is no parameter.
        ParameterError: a value is not physical.
        MechanismError: defaults depend on each other in a circle.
    """
    table = {parameter.name: parameter for parameter in parameters}
    for name in given:
        if name not in table:
            raise UnknownName("parameter", name, table)
    values: dict[str, float] = {}
    for wanted in table:
        open_names = [wanted]  # each waits for the next one
        while open_names:
            name = open_names[-1]
            missing = next((other for other in _needed(table[name], given) if other not in values), None)
            if missing is None:
                raw = given[name] if name in given else _default(table[name], values.__getitem__)
                values[name] = table[name].check(raw)
                open_names.pop()
            elif missing not in table:
                raise UnknownName("parameter", missing, table)
            elif missing in open_names:
                raise MechanismError(f"parameter defaults in a circle: {' -> '.join([*open_names, missing])}")
            else:
                open_names.append(missing)
    return {name: values[name] for name in table}


def _needed(parameter: Parameter, given: Mapping[str, object]) -> list[str]:
    """The parameters that a default is written in."""
    if parameter.name in given:
        return []
    try:
        return sorted(names_in(parameter.default))
    except ExpressionError as error:
        raise ParameterError(f"the default of parameter {parameter.name}: {error}") from None


def _default(parameter: Parameter, value: Callable[[str], float]) -> float:
    try:
        return float(parse(parameter.default, value))
    except ExpressionError as error:
        raise ParameterError(f"the default of parameter {parameter.name}: {error}") from None


def check_expression(source: Scalar, known: set[str], place: str) -> None:
    """Raise if an expression is not in the grammar or uses a name that is not a parameter."""
    try:
        names = names_in(source) if isinstance(source, str) else frozenset()
        if not isinstance(source, str):
            parse(source, float)
    except ExpressionError as error:
        raise ExpressionError(f"{place}: {error}") from None
    for name in sorted(names):
        if name not in known:
            raise UnknownName("parameter", name, sorted(known), place=place)
