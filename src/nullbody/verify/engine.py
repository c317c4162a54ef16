"""What every independent engine answers, in nullbody's coordinates and signs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from importlib import import_module
from types import ModuleType

import numpy as np

from nullbody.errors import UnknownName, VerificationError
from nullbody.mechanism import Mechanism
from nullbody.typing import FloatArray, IndexArray

__all__ = ["AbstractEngine", "Terms", "input_matrix", "kept_rows", "load"]

#: M (nq x nq), h (nq), A (rows x nq) and c (rows) of one state.
Terms = tuple[FloatArray, FloatArray, FloatArray, FloatArray]


class AbstractEngine(ABC):
    """M q'' + h + A^T lambda = S u,  A q'' + c = 0, by somebody else's code.

    q, q', q'' are in the order of the mechanism's coordinates, u in that of its inputs. lambda has the paper's
    sign, Phi = a - b for every loop, and the order of `labels`. A subclass is made by
    `Engine(mechanism, values, labels)`; nothing but these three may enter it.

    Attributes:
        name: as `compare` lists it.
        version: of the engine.
        labels: the closure equations that lambda is for.
    """

    name: str
    version: str
    labels: tuple[str, ...]

    @abstractmethod
    def forward_dynamics(self, q: FloatArray, q_dot: FloatArray, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(q'', lambda) for given inputs."""

    @abstractmethod
    def inverse_dynamics(self, q: FloatArray, q_dot: FloatArray, q_ddot: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(u, lambda) for given accelerations."""


def load(library: str, package: str, oldest: str) -> ModuleType:
    """Import an engine.

    Raises:
        VerificationError: it is not installed, or too old to be right; the message says what to install.
    """
    command = f'python -m pip install "{package}>={oldest}"'
    advice = f"{command} (or nullbody[verify] for all engines), or compare with missing='skip'"
    try:
        engine = import_module(library)
    except ImportError as error:
        raise VerificationError(
            f"the engine {library!r} cannot be imported ({error}). Install it with: {advice}"
        ) from error
    version = str(engine.__version__)
    if _numbers(version) < _numbers(oldest):
        raise VerificationError(
            f"{library} {version} is older than {oldest}, the first that is right here. Update it: {advice}"
        )
    return engine


def _numbers(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in version.split(".")[:3] if part.isdecimal())


def kept_rows(mechanism: Mechanism, labels: Sequence[str]) -> IndexArray:
    """Where the labelled closure equations stand among those of all loops, redundant ones included.

    Raises:
        UnknownName: a label that no loop has.
    """
    rows = [f"{loop.name} {row}" for loop in mechanism.loops for row in loop.rows]
    for label in labels:
        if label not in rows:
            raise UnknownName("closure equation", label, rows)
    return np.array([rows.index(label) for label in labels], dtype=np.intp)


def input_matrix(mechanism: Mechanism) -> FloatArray:
    """S (nq x nu): which coordinate each input acts along."""
    S = np.zeros((len(mechanism.coordinates), len(mechanism.inputs)))
    for column, coordinate in enumerate(mechanism.actuated):
        S[mechanism.coordinates.index(coordinate), column] = 1
    return S
