"""The builder of mechanisms: what was told, the spanning tree, and the frozen mechanism that comes of it."""

from nullbody.mechanism.builder.builder import MechanismBuilder
from nullbody.mechanism.builder.direction import rotations_of

__all__ = ["MechanismBuilder", "rotations_of"]
