"""Layer 3: the null space of a constraint Jacobian by determinants; knows no mechanics."""

from nullbody.nullspace.call import null_space
from nullbody.nullspace.minors import adjugate
from nullbody.nullspace.orthogonal import orthogonal_basis
from nullbody.nullspace.rank import Echelon, echelon
from nullbody.nullspace.result import NullSpace
from nullbody.nullspace.symbolic import SymbolicNullSpace

__all__ = ["Echelon", "NullSpace", "SymbolicNullSpace", "adjugate", "echelon", "null_space", "orthogonal_basis"]
