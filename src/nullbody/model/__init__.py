"""Layer 5: equations as native code with parameter values, and checked states."""

from nullbody.model.actuation import Actuation
from nullbody.model.build import build, programs
from nullbody.model.linear import rate_jacobian
from nullbody.model.model import Model, checked_model
from nullbody.model.state import State, vector
from nullbody.model.values import Energy, NullSpaceValues

__all__ = [
    "Actuation",
    "Energy",
    "Model",
    "NullSpaceValues",
    "State",
    "build",
    "checked_model",
    "programs",
    "rate_jacobian",
    "vector",
]
