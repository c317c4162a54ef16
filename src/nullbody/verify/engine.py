"""What every independent engine answers, in nullbody's coordinates and signs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from importlib import import_module
from types import ModuleType

import numpy as np

from nullbody.errors import UnknownName, VerificationError
from nullbody.mechanism import Mechanism, Spherical
from nullbody.typing import FloatArray, IndexArray

__all__ = ["AbstractEngine", "Terms", "input_matrix", "kept_rows", "load", "only_points"]

#: M (nq x nq), h (nq), A (rows x nq) and c (rows) of one state.
Terms = tuple[FloatArray, FloatArray, FloatArray, FloatArray]


class AbstractEngine(ABC):
    """M q'' + h + A^T lambda = S u,  A q'' + c = 0, by somebody else's code.

    q, q', q'' are in the order of the mechanism's coordinates, u in that of its inputs. lambda has the paper's
    sign, Phi = a - b for every loop, and the order of `labels`. The time t [s] matters to mechanisms with drivers
    or loads that depend on it. A subclass is made by `Engine(mechanism, values, labels)`; nothing but these three
    may enter it.

    Euler parameters move on |e| = 1; engines may differ in what they say about motions off it. That changes the
    multiplier of the norm and nothing else.

    Attributes:
        name: as `compare` lists it.
        version: of the engine.
        labels: the constraint equations that lambda is for.
    """

    name: str
    version: str
    labels: tuple[str, ...]

    @abstractmethod
    def forward_dynamics(
        self, q: FloatArray, q_dot: FloatArray, u: FloatArray, t: float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """(q'', lambda) for given inputs."""

    @abstractmethod
    def inverse_dynamics(
        self, q: FloatArray, q_dot: FloatArray, q_ddot: FloatArray, t: float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        """(u, lambda) for given accelerations; the smallest u where many would do."""

    @abstractmethod
    def generalized_forces(self, q: FloatArray, q_dot: FloatArray, q_ddot: FloatArray, t: float = 0.0) -> FloatArray:
        """M q'' + h, what inputs and reactions together must give."""


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
    """Where the labelled constraint equations stand among all of them, redundant ones included.

    Raises:
        UnknownName: a label that no equation has.
    """
    rows = [label for label, _ in (*mechanism.holonomic_rows, *mechanism.nonholonomic_rows)]
    for label in labels:
        if label not in rows:
            raise UnknownName("constraint equation", label, rows)
    return np.array([rows.index(label) for label in labels], dtype=np.intp)


def only_points(mechanism: Mechanism) -> bool:
    """Whether points of bodies held together are all there is: no other constraint, no Euler parameters, no load."""
    others = any(joint.own_rows for joint in mechanism.joints) or mechanism.constraints or mechanism.loads
    return not others and all(isinstance(loop, Spherical) for loop in mechanism.loops)


def input_matrix(mechanism: Mechanism) -> FloatArray:
    """S (nq x nu): which coordinate each input acts along."""
    S = np.zeros((len(mechanism.coordinates), len(mechanism.inputs)))
    for column, coordinate in enumerate(mechanism.actuated):
        S[mechanism.coordinates.index(coordinate), column] = 1
    return S
