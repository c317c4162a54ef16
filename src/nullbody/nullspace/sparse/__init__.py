"""Null spaces of large sparse matrices, reading as a chapter:

read         doubles in compressed rows, each scaled by a power of two
pivot        many pivots at once that do not disturb each other (threshold Markowitz)
elimination  step by step to a dense core, which LU and QR finish (`core`); the rank shows
factor       what is solved with L and U: N, offsets, combinations of rows
chart        independent columns that were given or preferred (`greedy`)
basis        N with refinement, without rounding; orthonormal columns
condition, determinant, repeat   what the result tells besides
function     the basis again, for other numbers in the same places
"""

from nullbody.nullspace.sparse.call import sparse_null_space
from nullbody.nullspace.sparse.result import SparseNullSpace

__all__ = ["SparseNullSpace", "sparse_null_space"]
