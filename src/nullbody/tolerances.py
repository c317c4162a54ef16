"""The tolerances that users meet or that several modules share, with their reasons.

One that a single algorithm needs stands on top of its module.
"""

from __future__ import annotations

__all__ = [
    "CLOSED",
    "CLOSED_STEP",
    "EPS",
    "GIVEN_CLOSED",
    "LARGE_SPREAD",
    "LONGEST_NEWTON_STEP",
    "NEWTON_STEPS",
    "REGULAR_DOUBT",
    "REGULAR_LOSS",
    "REGULAR_SPREAD",
    "SETTLED",
    "SIMULATED_SPREAD",
    "SINGLE_DOUBT",
    "SINGLE_EPS",
    "SINGLE_LOSS",
    "SINGLE_SPREAD",
    "SWITCH_DOUBT",
    "SWITCH_SPREAD",
]

#: Unit roundoff of a double, times two.
EPS = 2.220446049250313e-16

#: |Phi| to which Newton closes the loops [m]: some tens of roundings of lengths of about a metre.
CLOSED = 1e-14

#: |Phi| above which a simulated state is projected back, so that stored samples stay below 1e-13 m.
CLOSED_STEP = 2e-14

#: |Phi| up to which a state given by the user counts as closed [m]: a nanometre, far below any tolerance of
#: manufacture and far above the rounding of printed coordinates (15 digits).
GIVEN_CLOSED = 1e-9

#: A Newton step this short leaves an error of its square, which is rounding [m, rad].
SETTLED = 1e-8

#: Newton steps longer than this are cut, to stay on the branch [m, rad].
LONGEST_NEWTON_STEP = 0.5

#: Newton steps before an assembly is given up; a regular start needs 3 to 6, a singular end (linear
#: convergence, one bit a step) up to about 30.
NEWTON_STEPS = 60

#: The null space loses about EPS |N| relative accuracy near |B| = 0. A result is refused when that exceeds
#: 1e-9; the kernels return spread = |N|^2 (Frobenius).
REGULAR_SPREAD = (1e-9 / EPS) ** 2

#: Forces and accelerations lose about EPS loss, loss = sum_j (sum_k N_kj^2 M_kk) / D_j with the pivots D of Mr: it is
#: large where N^T M N cancels or is singular. A result is refused when that exceeds 1e-10; errors up to 70 times the
#: estimate were seen beside theta = 90 degrees, and reactions lose two digits more.
REGULAR_LOSS = 1e-10 / EPS

#: |N|^2 above which a large loss is put down to the independent coordinates, below it to masses or angles.
LARGE_SPREAD = 1e5

#: A simulation that may not change its independent coordinates stops at |N| = 1e5 at the latest: velocities grow as |N|
#: there, and steps would shrink to nothing.
SIMULATED_SPREAD = 1e10

#: |B| is at rounding level where a block's determinant is 1e-14 of the product of its column lengths; the kernels
#: return doubt = (that ratio)^-2. N may then be arbitrary (0/0), also where it looks small.
REGULAR_DOUBT = 1e28

#: |N|^2, lengths in typical lengths, from which a simulation looks for better independent coordinates: |N| = 10 costs
#: about one digit.
SWITCH_SPREAD = 1e2

#: doubt from which it looks for better rows as well: determinants at 1e-4 of the product of column lengths.
SWITCH_DOUBT = 1e8

#: The distance from 1 to the next number in single precision.
SINGLE_EPS = 2.0**-23

#: The same limits for single precision: results keep three of their seven digits, and a determinant at 45 roundings of
#: the product of its column lengths is none.
SINGLE_SPREAD = (1e-3 / SINGLE_EPS) ** 2
SINGLE_LOSS = 1e-3 / SINGLE_EPS
SINGLE_DOUBT = (45 * SINGLE_EPS) ** -2
