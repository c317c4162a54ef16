"""The null space of a matrix by determinants: exact fractions, the paper's appendix, its orthogonal basis."""

from fractions import Fraction

from nullbody.nullspace import null_space, orthogonal_basis

A = [[1, 2, 0, 1], [5, 8, 1, 3]]


def product(left, right):
    """The matrix product of lists of rows."""
    return [
        [sum(a * b for a, b in zip(row, column, strict=True)) for column in zip(*right, strict=True)] for row in left
    ]


space = null_space(A, independent=[2, 3])  # q = (q1, q2 | q3, q4)
orthogonal = orthogonal_basis(A, independent=[2, 3])
squares = product(list(zip(*orthogonal, strict=True)), orthogonal)

print("delta = |B| =", space.delta)
for title, basis in (("N", space.basis), ("N~ = delta N, no division", space.scaled), ("N^, orthogonal", orthogonal)):
    print(title)
    for row in basis:
        print("   ", *(f"{x!s:>5}" for x in row))

assert all(x == 0 for basis in (space.basis, space.scaled, orthogonal) for row in product(A, basis) for x in row)
assert squares == [[Fraction(9, 4), 0], [0, 2]]
