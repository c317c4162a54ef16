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
    "NEWTON_STEPS",
    "REGULAR_LOSS",
    "REGULAR_SPREAD",
    "SIMULATED_SPREAD",
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

#: Newton steps before an assembly is given up; a regular start needs 3 to 6, a singular end (linear
#: convergence, one bit a step) up to about 30.
NEWTON_STEPS = 60

#: The null space loses about EPS |N| relative accuracy near |B| = 0. A result is refused when that exceeds
#: 1e-9; the kernels return spread = |N|^2 (Frobenius).
REGULAR_SPREAD = (1e-9 / EPS) ** 2

#: Solving for v' loses about EPS sum_j Mr_jj / D_j (`loss` of the kernels), D the pivots of Mr. A result is refused
#: when that exceeds 1e-9: some motion then moves next to no mass.
REGULAR_LOSS = 1e-9 / EPS

#: |N|^2 above which trouble is put down to the independent coordinates: Mr = N^T M N is ill-conditioned there too.
LARGE_SPREAD = 1e5

#: A simulation stops earlier, at |N| = 1e5: velocities grow as |N| there, and the step would shrink to nothing.
SIMULATED_SPREAD = 1e10
