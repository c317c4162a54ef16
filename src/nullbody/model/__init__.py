"""Layer 5: equations as native code with parameter values, and checked states."""

from nullbody.model.actuation import Actuation
from nullbody.model.batch import Batch, BatchOptions, Energies, NullSpaces
from nullbody.model.batch_assembly import Assembled, Assemblies
from nullbody.model.build import build, programs
from nullbody.model.derivatives import Derivatives
from nullbody.model.jax_functions import JaxFunctions
from nullbody.model.linear import rate_jacobian
from nullbody.model.model import Model, checked_model
from nullbody.model.state import State, vector
from nullbody.model.values import (
    Energy,
    ForwardDerivatives,
    InverseDerivatives,
    LinearModel,
    NullSpaceValues,
    RateDerivatives,
    StepDerivatives,
)

__all__ = [
    "Actuation",
    "Assembled",
    "Assemblies",
    "Batch",
    "BatchOptions",
    "Derivatives",
    "Energies",
    "Energy",
    "ForwardDerivatives",
    "InverseDerivatives",
    "JaxFunctions",
    "LinearModel",
    "Model",
    "NullSpaceValues",
    "NullSpaces",
    "RateDerivatives",
    "State",
    "StepDerivatives",
    "build",
    "checked_model",
    "programs",
    "rate_jacobian",
    "vector",
]
