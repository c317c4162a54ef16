"""What batches take: arrays with a row for each state, times, parameters for all or for each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from nullbody.errors import InputError, ParameterError, UnknownName
from nullbody.expr.parse import parse
from nullbody.typing import FloatArray

if TYPE_CHECKING:
    from nullbody.model.model import Model

__all__ = ["ARRAY_FUNCTIONS", "moments", "numbers", "parameter_rows", "room", "rows"]

ARRAY_FUNCTIONS = {"sqrt": np.sqrt, "sin": np.sin, "cos": np.cos, "tan": np.tan}


def rows(values: object, names: tuple[str, ...], kind: str, dtype: np.dtype[Any], *, one: bool = False) -> NDArray[Any]:
    """An array (states, size), checked; with `one` also (size,), which all states share.

    Raises:
        InputError: another shape, no numbers, or values that are not finite: names the first state and the entry.
    """
    array = numbers(values, kind)
    if array.ndim not in ((1, 2) if one else (2,)) or array.shape[-1] != len(names):
        raise InputError(
            f"{kind} values of a batch are an array (states, {len(names)}){f' or ({len(names)},)' if one else ''} in "
            f"the order {', '.join(names) or 'of none'}, not one of shape {array.shape}"
        )
    with np.errstate(over="ignore", invalid="ignore"):
        array = array.astype(dtype, copy=False)
        total = array.sum()  # one pass without memory; where it overflows there is a closer look
    if not np.isfinite(total):
        _finite(array, names, kind)
    return array


def room(out: object, shape: tuple[int, ...], dtype: np.dtype[Any], given: tuple[NDArray[Any], ...]) -> NDArray[Any]:
    """An array for results, checked before any work.

    Raises:
        InputError: another shape or type, not contiguous, not writeable, or it shares memory with what is given.
    """
    if type(out) is not np.ndarray or out.shape != shape or out.dtype != dtype:
        raise InputError(f"out must be a {dtype} array {shape}")
    if not (out.flags.c_contiguous and out.flags.aligned and out.flags.writeable):
        raise InputError("out must be contiguous and writeable")
    if any(np.may_share_memory(out, array) for array in given):
        raise InputError("out shares memory with another array")
    return out


def moments(t: object, states: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    """The times as an input group: (1,) where all states share one, else (states, 1).

    Raises:
        InputError: neither a number nor one for each state, or not finite.
    """
    with np.errstate(over="ignore"):
        array = numbers(t, "time").astype(dtype, copy=False)
    if array.shape not in ((), (states,)):
        raise InputError(f"the time t is a number or an array ({states},), not one of shape {array.shape}")
    if not np.isfinite(array).all():
        raise InputError(f"the time t must be finite; it is not for state {_first(~np.isfinite(array.reshape(-1)))}")
    return array.reshape(-1, 1) if array.ndim else array.reshape(1)


def parameter_rows(model: Model, given: object, states: int, dtype: np.dtype[Any]) -> NDArray[Any]:
    """Parameters as an input group: (np,) where all states share them, else (states, np).

    Args:
        model: whose values are the default.
        given: None; an array (np,) or (states, np) in the order of `model.parameters`; or values by name, a number or
            (states,) each: the others keep the model's values, formulas among the defaults follow.
        states: how many states there are.
        dtype: of the result.

    Raises:
        UnknownName: a name is no parameter.
        InputError, ParameterError: another shape; a value is not finite or has the wrong sign: names the first state.
    """
    if given is None:
        return np.array(model.values, dtype=dtype)
    names = tuple(model.parameters)
    if isinstance(given, Mapping):
        array = _by_name(model, given, states)
    else:
        array = rows(given, names, "parameter", np.dtype(np.float64), one=True)
        if array.ndim == 2 and len(array) != states:
            raise InputError(f"there are parameters for {len(array)} states, but {states} states")
    for k, parameter in enumerate(model.mechanism.parameters):
        column = array[..., k].reshape(-1)
        wrong = column <= 0 if parameter.sign == "positive" else column < 0
        if parameter.sign != "any" and wrong.any():
            place = _first(wrong)
            raise ParameterError(
                f"parameter {parameter.name} must be {parameter.sign}, not {column[place]:g} {parameter.unit} "
                f"(state {place}, {int(wrong.sum())} in all)"
            )
    return array.astype(dtype, copy=False)


def _by_name(model: Model, given: Mapping[object, object], states: int) -> FloatArray:
    names = tuple(model.parameters)
    values: dict[str, FloatArray] = {}
    for name, value in given.items():
        if name not in names:
            raise UnknownName("parameter", name, names)
        array = numbers(value, f"parameter {name}").astype(np.float64)
        if array.shape not in ((), (states,)):
            raise InputError(f"parameter {name} is a number or an array ({states},), not one of shape {array.shape}")
        values[str(name)] = array
    table = {parameter.name: parameter for parameter in model.mechanism.parameters}

    def known(name: str) -> Any:
        if name not in values:
            default = model.given.get(name, table[name].default)
            values[name] = np.asarray(parse(default, known, functions=ARRAY_FUNCTIONS), dtype=np.float64)
        return values[name]

    with np.errstate(all="ignore"):
        columns = [np.broadcast_to(known(name), (states,)) for name in names]
    array = np.stack(columns, axis=1) if columns else np.zeros((states, 0))
    _finite(array, names, "parameter")
    return array


def numbers(values: object, kind: str) -> NDArray[Any]:
    """Values as an array of any shape.

    Raises:
        InputError: they are no real numbers.
    """
    try:
        array = np.asarray(values)
    except (TypeError, ValueError) as error:
        raise InputError(f"{kind} values are no array of numbers: {error}") from None
    if array.dtype.kind not in "iuf" and array.size:
        raise InputError(f"{kind} values must be real numbers, not {array.dtype}")
    return array


def _finite(array: NDArray[Any], names: tuple[str, ...], kind: str) -> None:
    good = np.isfinite(array).reshape(-1, len(names)) if names else np.ones((0, 1), dtype=bool)
    if not good.all():
        state, entry = np.argwhere(~good)[0].tolist()
        count = int((~good.all(axis=1)).sum())
        raise InputError(
            f"{kind} {names[entry]} of state {state} must be finite, not {array.reshape(-1, len(names))[state, entry]} "
            f"({count} of {len(good)} states have such values)"
        )


def _first(wrong: NDArray[np.bool_]) -> int:
    return int(np.flatnonzero(wrong)[0])
