"""Smallest equations of motion of closed-loop mechanisms, derived symbolically and compiled to native code.

    Mechanism --derive--> Equations --build--> Model --assemble--> State --simulate--> Trajectory

This is the public face: a table of names and the modules they live in. A module is imported when one of its
names is first used, so `import nullbody` itself costs next to nothing.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

from nullbody.errors import (
    AssemblyError,
    CacheError,
    ExpressionError,
    InputError,
    MechanismError,
    ModelFileError,
    NullbodyError,
    OutputError,
    ParameterError,
    SimulationError,
    SingularityError,
    StateError,
    UnknownName,
    VerificationError,
)

if TYPE_CHECKING:  # the same names once more, for type checkers and editors
    from nullbody import catalog, control, export, nullspace, report, verify
    from nullbody.equations import Equations, derive
    from nullbody.expr import Graph
    from nullbody.formats import read_model
    from nullbody.kinematics import assemble, branches, consistent, inverse_kinematics, singularity
    from nullbody.mechanism import Mechanism, MechanismBuilder
    from nullbody.model import Model, State, build
    from nullbody.nullspace import NullSpace, null_space
    from nullbody.simulate import BatchTrajectory, Event, Trajectory, simulate, simulate_batch

__all__ = [
    "AssemblyError",
    "BatchTrajectory",
    "CacheError",
    "Equations",
    "Event",
    "ExpressionError",
    "Graph",
    "InputError",
    "Mechanism",
    "MechanismBuilder",
    "MechanismError",
    "Model",
    "ModelFileError",
    "NullSpace",
    "NullbodyError",
    "OutputError",
    "ParameterError",
    "SimulationError",
    "SingularityError",
    "State",
    "StateError",
    "Trajectory",
    "UnknownName",
    "VerificationError",
    "__version__",
    "assemble",
    "branches",
    "build",
    "catalog",
    "consistent",
    "control",
    "derive",
    "export",
    "inverse_kinematics",
    "null_space",
    "nullspace",
    "read_model",
    "report",
    "simulate",
    "simulate_batch",
    "singularity",
    "verify",
]

__version__ = "0.1.0"

_PACKAGES = {"catalog", "control", "export", "nullspace", "report", "verify"}
_HOME = {
    "BatchTrajectory": "simulate",
    "Equations": "equations",
    "Event": "simulate",
    "Graph": "expr",
    "Mechanism": "mechanism",
    "MechanismBuilder": "mechanism",
    "Model": "model",
    "NullSpace": "nullspace",
    "State": "model",
    "Trajectory": "simulate",
    "assemble": "kinematics",
    "branches": "kinematics",
    "build": "model",
    "consistent": "kinematics",
    "derive": "equations",
    "inverse_kinematics": "kinematics",
    "null_space": "nullspace",
    "read_model": "formats",
    "simulate": "simulate",
    "simulate_batch": "simulate",
    "singularity": "kinematics",
}


def __getattr__(name: str) -> object:
    """Import the home of a public name on its first use (PEP 562)."""
    if name in _PACKAGES:
        return import_module(f"{__name__}.{name}")
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}", name=name, obj=sys.modules[__name__])
    value = getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """The public names, imported or not."""
    return list(__all__)


class _Face(ModuleType):
    """Keeps a public function in place when the import system binds the package of the same name over it.

    `nullbody.simulate` is the function, whoever imports the package `nullbody.simulate` first; what else that
    package holds is reached by `from nullbody.simulate import ...`.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if isinstance(value, ModuleType) and _HOME.get(name) == name:
            value = getattr(value, name)
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Face
