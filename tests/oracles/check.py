"""Oracles: each takes quantities as numbers and raises AssertionError where they are wrong.

The normal tests call them with the package's quantities, the mutation tests with planted errors.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from tests.oracles.sample import Quantities, Sample

__all__ = [
    "ORACLES",
    "close",
    "closure",
    "dynamics",
    "energy",
    "everything",
    "inertia",
    "null_space",
    "offset",
    "power",
    "reduction",
    "routines",
]

#: Places of alpha1, alpha2, alpha3, the basis in which the robot's dynamics are written.
HINGES = [6, 7, 8]

#: Relative to the largest entry: some thousand roundings, the samples' condition numbers are below about 1000.
ROUNDING = 1e-11


def close(found: ArrayLike, expected: ArrayLike, what: str, scale: float = 0.0) -> None:
    """|found - expected| <= ROUNDING times the largest entry, or the scale of the terms that cancel."""
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.shape == expected.shape, f"{what}: shape {found.shape}, not {expected.shape}"
    error = np.abs(found - expected).max(initial=0.0)
    bound = ROUNDING * max(np.abs(expected).max(initial=0.0), scale)
    assert error <= bound, f"{what}: off by {error:.3g}, allowed {bound:.3g}"


def closure(found: Quantities, sample: Sample) -> None:
    """Phi, A and c are those of the robot written out."""
    for name in ("Phi", "A", "c"):
        close(found[name], sample.truth[name], name)


def null_space(found: Quantities, sample: Sample) -> None:
    """A N = 0, the identity in the independent rows, N~ = |B| N."""
    A, N, scaled, delta = sample.truth["A"], found["N"], found["N_scaled"], found["delta"]
    close(delta, sample.truth["delta"], "delta = |B|")
    close(A @ N, np.zeros((9, 3)), "A N", np.abs(N).max())
    close(N[9:], np.eye(3), "independent rows of N")
    close(scaled, delta * sample.truth["N"], "N_scaled = delta N")


def offset(found: Quantities, sample: Sample) -> None:
    """A gamma + c = 0, zeros in the independent places, gamma~ = |B| gamma."""
    A, c, gamma = sample.truth["A"], sample.truth["c"], found["gamma"]
    close(A @ gamma + c, np.zeros(9), "A gamma + c", np.abs(c).max() + np.abs(gamma).max())
    close(gamma[9:], np.zeros(3), "independent places of gamma")
    close(found["gamma_scaled"], sample.truth["delta"] * gamma, "gamma_scaled = delta gamma")


def inertia(found: Quantities, sample: Sample) -> None:
    """M and h are those of plain Lagrange equations; M is symmetric and positive semidefinite."""
    M, h = found["M"], found["h"]
    close(M, sample.truth["M"], "M")
    close(h, sample.truth["h"], "h")
    close(M, M.T, "M = M^T")
    assert np.linalg.eigvalsh(M).min() > -ROUNDING * np.abs(M).max(), "M has a negative eigenvalue"


def energy(found: Quantities, sample: Sample) -> None:
    """T is that of all bodies written out, and q'^T M q' / 2; U is that of all bodies."""
    rates = sample.truth["q_dot"]
    close(found["T"], sample.truth["T"], "T")
    close(found["T"], rates @ sample.truth["M"] @ rates / 2, "T = q'^T M q' / 2")
    close(found["U"], sample.truth["U"], "U")


def reduction(found: Quantities, sample: Sample) -> None:
    """Mr = N^T M N, hr = N^T (h + M gamma), Br = N^T S, Q = S u."""
    N, M, gamma = sample.truth["N"], sample.truth["M"], sample.truth["gamma"]
    close(found["Mr"], N.T @ M @ N, "Mr")
    terms = np.abs(N).T @ (np.abs(sample.truth["h"]) + np.abs(M) @ np.abs(gamma))
    close(found["hr"], N.T @ (sample.truth["h"] + M @ gamma), "hr", terms.max())
    close(found["Br"], N.T @ np.eye(12)[:, 9:], "Br")
    close(found["Q"], sample.truth["Q"], "Q")


def dynamics(found: Quantities, sample: Sample) -> None:
    """q'', lambda and u of the routines are those of the full system with multipliers."""
    truth = sample.truth
    size = max(np.abs(truth[name]).max() for name in ("q_ddot", "gamma"))
    close(found["forward_dynamics.q_ddot"], truth["q_ddot"], "forward_dynamics: q''", size)
    for routine in ("forward_dynamics", "inverse_dynamics"):
        close(found[f"{routine}.delta"], truth["delta"], f"{routine}: delta")
    for routine in ("forward_dynamics", "kinematics"):
        close(found[f"{routine}.q_dot"], truth["q_dot"], f"{routine}: q'")
    terms = np.abs(truth["N"]).T @ (np.abs(truth["M"]) @ np.abs(truth["q_ddot"]) + np.abs(truth["h"]))
    close(found["inverse_dynamics.u"], truth["u"], "u", terms.max())
    close(found["inverse_dynamics.Qr"], truth["u"], "Qr", terms.max())
    close(found["reactions.lam"], truth["lam"], "lambda", terms.max())
    close(found["kinematics.gamma"], truth["gamma"], "kinematics: gamma")
    close(found["kinematics.N"], truth["N"], "kinematics: N")


def routines(found: Quantities, sample: Sample) -> None:
    """What routines repeat of the named outputs, and spread: |N|^2 of the dependent rows; |W|^2 |P^-1|^2 in a basis
    and those of W.
    """
    for routine, outputs in (
        ("closure", ("Phi", "A")),
        ("rows", ("A",)),
        ("energy", ("T", "U")),
        ("kinematics", ("delta",)),
    ):
        for name in outputs:
            close(found[f"{routine}.{name}"], sample.truth[name], f"{routine}: {name}")
    for name in ("b", "rows.b", "beta"):
        close(found[name], np.zeros(found[name].shape), f"{name} without drivers")
    close(found["closing.correction"], sample.truth["correction"], "closing: correction")
    M, N = sample.truth["M"], sample.truth["N"]
    for routine in ("kinematics", "closing"):
        close(found[f"{routine}.spread"], (N[:9] ** 2).sum(), f"{routine}: spread")
    close(found["closing.delta"], sample.truth["delta"], "closing: delta")
    transfer = N[HINGES]  # rates of the basis per unit of v
    W = N @ np.linalg.inv(transfer)
    size, Mr = (W**2).T @ np.diag(M), W.T @ M @ W
    for routine in ("forward_dynamics", "inverse_dynamics"):
        spread = (W**2).sum() * (transfer**2).sum() + (W**2).sum() - len(transfer)
        close(found[f"{routine}.spread"], spread, f"{routine}: spread")
    pivots = np.diag(np.linalg.cholesky(Mr)) ** 2
    for routine in ("forward_dynamics", "inverse_dynamics"):
        close(found[f"{routine}.loss"], (size / pivots).sum(), f"{routine}: loss")


def power(found: Quantities, sample: Sample) -> None:
    """The inputs' power is what the energy gains: q'^T (M q'' + h) = u v, and lambda does no work."""
    rates, M, h = sample.truth["q_dot"], found["M"], found["h"]
    gained = rates @ (M @ found["forward_dynamics.q_ddot"] + h)
    close(gained, sample.truth["u"] @ sample.truth["v"], "power", np.abs(rates) @ np.abs(h))
    close(found["forward_dynamics.power"], sample.truth["u"] @ sample.truth["v"], "power of the inputs")
    close(rates @ found["A"].T @ found["reactions.lam"], 0.0, "power of lambda", np.abs(found["reactions.lam"]).max())


ORACLES: tuple[Callable[[Quantities, Sample], None], ...] = (
    closure,
    null_space,
    offset,
    inertia,
    energy,
    reduction,
    dynamics,
    routines,
    power,
)


def everything(found: Quantities, sample: Sample) -> None:
    """All oracles."""
    for oracle in ORACLES:
        oracle(found, sample)
