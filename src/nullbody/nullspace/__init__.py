"""Layer 3: the null space of a constraint Jacobian by determinants; knows no mechanics."""

from nullbody.nullspace.basis import NullSpace, null_space
from nullbody.nullspace.minors import adjugate
from nullbody.nullspace.orthogonal import orthogonal_basis
from nullbody.nullspace.rank import Echelon, echelon

__all__ = ["Echelon", "NullSpace", "adjugate", "echelon", "null_space", "orthogonal_basis"]
