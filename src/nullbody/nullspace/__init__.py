"""Layer 3: the null space of a constraint Jacobian, A N = 0; knows no mechanics.

To be read in this order:

    given        what is given: numbers, expressions, SymPy, arrays, stacks, sparse matrices
    scalar       what the method needs to know of an entry: zero, constant, inverse
    steps        row operations, and what they do to right-hand sides
    plan         the choices that change only how many operations a null space takes
    rank         which rows are independent, which columns can be dependent: the echelon form, by value
    roots        the same where there are square roots, which values in a prime field cannot see through
    rows         constant row operations that make rows cheaper
    pivots       constants first; expressions where a block is large
    structure    the block-triangular form of what is left
    minors       determinant and adjugate of a block without a division
    order        the cheap way to expand a block by minors
    elimination  all of it together: B x = r, |B|, adj(B) r, B^-T r
    symbolic     N, N~, gamma, delta of exact numbers and expressions: `SymbolicNullSpace`
    search       the same null space with fewer operations: other plans
    gram         orthogonal and orthonormal bases
    orthogonal   the paper's own procedure for them
    derivative   N', N~', and the rates of orthogonal bases along a motion
    residue      a null space over a field: of Fractions, or modulo a prime
    sample       expressions and exact numbers as doubles at points
    atlas        the charts of a null space, sorted by what they cost or by how good they are
    charts       every choice of independent columns with its cost and its condition
    switch       when to change the independent columns, and to which
    function     a basis as native code, for one state or a batch
    numeric      arrays and stacks: complete pivoting, LU, Householder QR, singular values, generated kernels
    sparse       large sparse matrices
    call         `null_space`, the one call for all of them
    result       `NullSpace`, what it returns
"""

from nullbody.nullspace.atlas import Atlas, Chart
from nullbody.nullspace.call import null_space
from nullbody.nullspace.charts import charts
from nullbody.nullspace.derivative import basis_rate, gram_schmidt_rate, orthonormal_rate, scaled_rate
from nullbody.nullspace.function import NullSpaceFunction
from nullbody.nullspace.gram import division_free, paper_scaled
from nullbody.nullspace.minors import adjugate
from nullbody.nullspace.numeric import ArrayNullSpace, NullSpaceStack, subspace_angle
from nullbody.nullspace.orthogonal import orthogonal_basis
from nullbody.nullspace.rank import Echelon, echelon
from nullbody.nullspace.result import NullSpace
from nullbody.nullspace.sparse import SparseNullSpace
from nullbody.nullspace.switch import better_chart
from nullbody.nullspace.symbolic import SymbolicNullSpace

__all__ = [
    "ArrayNullSpace",
    "Atlas",
    "Chart",
    "Echelon",
    "NullSpace",
    "NullSpaceFunction",
    "NullSpaceStack",
    "SparseNullSpace",
    "SymbolicNullSpace",
    "adjugate",
    "basis_rate",
    "better_chart",
    "charts",
    "division_free",
    "echelon",
    "gram_schmidt_rate",
    "null_space",
    "orthogonal_basis",
    "orthonormal_rate",
    "paper_scaled",
    "scaled_rate",
    "subspace_angle",
]
