"""build: Equations, or a Mechanism, -> Model, by compiling every routine to a native kernel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from nullbody.equations import Equations, programs
from nullbody.errors import InputError
from nullbody.kernels import compile_programs
from nullbody.mechanism import Mechanism
from nullbody.model.blueprint import Blueprint, blueprint
from nullbody.model.model import Model

__all__ = ["build", "programs"]


def build(
    source: Equations | Mechanism,
    parameters: Mapping[str, float] | None = None,
    *,
    independent: Sequence[str] | None = None,
    rows: Sequence[str] | None = None,
    basis: Sequence[str] | None = None,
) -> Model:
    """Native code for a mechanism, from the cache on disk where it has been built before.

    Args:
        source: a mechanism, whose equations are derived only where the cache does not hold what came of them before;
            or equations from `derive`.
        parameters: values that differ from the mechanism's own.
        independent, rows, basis: as `derive`, for a mechanism.

    Raises:
        UnknownName, ParameterError: unknown or non-physical parameters.
        InputError, MechanismError, SingularityError: as `derive`.
        CacheError: the cache folder cannot be used; the message says what to set.
    """
    given = dict(parameters or {})
    if isinstance(source, Mechanism):
        mechanism = source
        values = mechanism.values(given)
        made = blueprint(mechanism, independent, rows, basis)
    elif isinstance(source, Equations):
        if (independent, rows, basis) != (None, None, None):
            raise InputError("independent, rows and basis of equations are chosen in derive(mechanism, ...)")
        mechanism = source.mechanism
        values = mechanism.values(given)
        made = Blueprint.of(source)
    else:
        raise InputError(f"build takes Equations from derive(mechanism), or a Mechanism, not {type(source).__name__}")
    return Model(
        mechanism=mechanism,
        independent=made.independent,
        basis=made.basis,
        labels=made.labels,
        closure_labels=made.closure_labels,
        facing=made.facing,
        mobility=made.mobility,
        given=MappingProxyType(given),
        values=tuple(values.values()),
        library=compile_programs(made.programs),
    )
