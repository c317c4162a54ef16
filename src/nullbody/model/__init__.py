"""Layer 5: equations as native code with parameter values, and checked states."""

from nullbody.model.build import build, programs
from nullbody.model.model import Energy, Model, NullSpaceValues
from nullbody.model.state import State, vector

__all__ = ["Energy", "Model", "NullSpaceValues", "State", "build", "programs", "vector"]
