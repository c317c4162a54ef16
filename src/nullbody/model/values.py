"""What a model gives at one state, where it is more than one array."""

from __future__ import annotations

from typing import NamedTuple

from nullbody.typing import FloatArray

__all__ = [
    "Energy",
    "ForwardDerivatives",
    "InverseDerivatives",
    "LinearModel",
    "NullSpaceValues",
    "RateDerivatives",
    "StepDerivatives",
]


class Energy(NamedTuple):
    """Kinetic and potential energy [J]."""

    kinetic: float
    potential: float

    @property
    def total(self) -> float:
        """T + U [J]."""
        return self.kinetic + self.potential


class NullSpaceValues(NamedTuple):
    """N (nq x nv), gamma (nq) and delta = |B| at one state."""

    N: FloatArray
    gamma: FloatArray
    delta: float


class RateDerivatives(NamedTuple):
    """x' = f(x, u, t, p) of x = (q, v), and its partial derivatives: dx' = A dx + B du + t dt + p dp.

    Attributes:
        rate: x' = (q', v'), nq + nv.
        A: df/dx, (nq + nv) x (nq + nv).
        B: df/du, (nq + nv) x nu.
        t: df/dt, nq + nv; zero without drivers.
        p: df/dp, (nq + nv) x np; np = 0 where parameters were left out.
    """

    rate: FloatArray
    A: FloatArray
    B: FloatArray
    t: FloatArray
    p: FloatArray


class ForwardDerivatives(NamedTuple):
    """q'' of `Model.forward_dynamics`, nq, and its partial derivatives, a row for each coordinate.

    The rows of `model.independent_columns` are v'. q: nq x nq, v: nq x nv, u: nq x nu, t: nq, p: nq x np.
    """

    q_ddot: FloatArray
    q: FloatArray
    v: FloatArray
    u: FloatArray
    t: FloatArray
    p: FloatArray


class InverseDerivatives(NamedTuple):
    """Forces for given accelerations and their partial derivatives, a row for each force.

    `force` is u of `Model.inverse_dynamics` where there is one input for each degree of freedom, otherwise N^T Q of
    `Model.generalized_forces`. q: m x nq, v: m x nv, v_dot: m x nv, t: m, p: m x np.
    """

    force: FloatArray
    q: FloatArray
    v: FloatArray
    v_dot: FloatArray
    t: FloatArray
    p: FloatArray


class LinearModel(NamedTuple):
    """The smallest linear model on the constraint manifold, of x = (q_f, v): d(dx)/dt = A dx + B du.

    Attributes:
        states: names of x: the coordinates q_f, as many as positions have degrees of freedom, then those whose rates
            v holds, each with a "'".
        A: square, of 2 nv rows; more where something rolls.
        B: a column for each input.
        tangent: dq/dq_f on the manifold, nq rows: N where nothing rolls.
    """

    states: tuple[str, ...]
    A: FloatArray
    B: FloatArray
    tangent: FloatArray


class StepDerivatives(NamedTuple):
    """x+ = (q, v) after one Runge-Kutta step, and its derivatives: dx+ = A dx + B du + p dp.

    Attributes:
        q, v: coordinates and independent rates after the step; the loops are closed to the error of the step.
        A: dx+/dx, (nq + nv) x (nq + nv).
        B: dx+/du, (nq + nv) x nu.
        p: dx+/dp, (nq + nv) x np.
    """

    q: FloatArray
    v: FloatArray
    A: FloatArray
    B: FloatArray
    p: FloatArray
