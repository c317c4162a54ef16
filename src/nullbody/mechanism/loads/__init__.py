"""Loads: springs, dampers, friction, wrenches, energies of your own. Gravity belongs to the mechanism."""

from nullbody.mechanism.loads.base import AbstractLoad
from nullbody.mechanism.loads.friction import Friction
from nullbody.mechanism.loads.spring import CoordinateSpring, Spring
from nullbody.mechanism.loads.wrench import Energy, Wrench

__all__ = ["AbstractLoad", "CoordinateSpring", "Energy", "Friction", "Spring", "Wrench"]
