"""Layer 4: mechanisms written in the formats of other tools."""

from nullbody.formats.mjcf import write_mjcf
from nullbody.formats.rigid import RigidFrame, Step, frame, loop_points, mass_properties, number, steps, triple

__all__ = ["RigidFrame", "Step", "frame", "loop_points", "mass_properties", "number", "steps", "triple", "write_mjcf"]
