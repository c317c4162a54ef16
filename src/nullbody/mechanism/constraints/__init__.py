"""Constraints that are no joints: couplings, drivers, rolling, blades, and expressions of your own."""

from nullbody.mechanism.constraints.base import AbstractConstraint
from nullbody.mechanism.constraints.coupling import Coupling
from nullbody.mechanism.constraints.custom import Holonomic, Nonholonomic
from nullbody.mechanism.constraints.driver import Driver
from nullbody.mechanism.constraints.rolling import KnifeEdge, RollingDisc

__all__ = ["AbstractConstraint", "Coupling", "Driver", "Holonomic", "KnifeEdge", "Nonholonomic", "RollingDisc"]
