"""build: Equations -> Model, by compiling every routine to a native kernel."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from nullbody.equations import Equations, programs
from nullbody.errors import InputError
from nullbody.kernels import compile_programs
from nullbody.model.model import Model

__all__ = ["build", "programs"]


def build(equations: Equations, parameters: Mapping[str, float] | None = None) -> Model:
    """Native code for some equations, from the cache on disk where it has been built before.

    Args:
        equations: from `derive`.
        parameters: values that differ from the mechanism's own.

    Raises:
        UnknownName, ParameterError: unknown or non-physical parameters.
        CacheError: the cache folder cannot be used; the message says what to set.
    """
    if not isinstance(equations, Equations):
        raise InputError(f"build takes Equations from derive(mechanism), not {type(equations).__name__}")
    given = dict(parameters or {})
    values = equations.mechanism.values(given)
    library = compile_programs(programs(equations))
    return Model(
        mechanism=equations.mechanism,
        independent=equations.independent,
        basis=equations.basis,
        labels=equations.labels,
        closure_labels=equations.closure_labels,
        facing=equations.facing,
        mobility=equations.mobility,
        given=MappingProxyType(given),
        values=tuple(values.values()),
        library=library,
    )
