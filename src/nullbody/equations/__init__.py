"""Layer 4: from a mechanism to its equations of motion."""

from nullbody.equations.derive import derive
from nullbody.equations.equations import Equations, Routine
from nullbody.equations.mobility import Mobility
from nullbody.equations.presentation import flat, shape
from nullbody.equations.programs import programs

__all__ = ["Equations", "Mobility", "Routine", "derive", "flat", "programs", "shape"]
