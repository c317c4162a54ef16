"""Null spaces of arrays of numbers: complete pivoting, LU, Householder QR, SVD, determinants, compiled kernels."""

from nullbody.nullspace.numeric.angle import subspace_angle
from nullbody.nullspace.numeric.call import array_null_space
from nullbody.nullspace.numeric.result import ArrayNullSpace
from nullbody.nullspace.numeric.stack import NullSpaceStack

__all__ = ["ArrayNullSpace", "NullSpaceStack", "array_null_space", "subspace_angle"]
