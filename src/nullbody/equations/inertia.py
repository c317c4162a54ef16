"""Mass matrix, bias forces and energies, body by body (theory 3, with the rod's inertia about its centre).

For a body with mass m, inertia I about its centre C, pose (R, p) and the Jacobians V_C = J q', omega = W q'; all in
the body's axes but g and p_C, which are in the ground's:

    M += J^T m J + W^T I W                                                              [27-30, 33]
    h += J^T m (a_C - R^T g) + W^T (I omega'_0 + omega x I omega)                       [33, 35]
         a_C = (d/dt J) q' + omega x V_C,   omega'_0 = (d/dt W) q'
    U -= m g . p_C,   T = q'^T M q' / 2                                                 [31, 27]

h is Coriolis, centrifugal and gravity together: M q'' + h + A^T lambda = Q. Two of its terms have a second form, and
each entry is written in the cheaper one:

    J_i . (omega x V_C) = sum over j != i of q'_j omega . (J_j x J_i),      -m J_i . R^T g = dU/dq_i

For Euler parameters the last holds only up to a multiple of e, which the multiplier of the norm takes up if all four
entries have it: they keep the first form.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from nullbody.equations.frame import Frame
from nullbody.equations.scalar import ParameterScalars
from nullbody.expr import Expr, derivative, directional, operations
from nullbody.expr.matrix import add, cross, dot, matvec, scale, total, transpose
from nullbody.mechanism import Body, Mechanism

__all__ = ["Inertia", "inertia"]


@dataclass(frozen=True)
class Inertia:
    """M (nq x nq), h (nq), T and U [J] of the bodies in redundant coordinates."""

    M: list[list[Any]]
    h: list[Any]
    T: Any
    U: Any


def inertia(
    mechanism: Mechanism,
    found: Mapping[str, Frame],
    scalars: ParameterScalars,
    q: Mapping[str, Expr],
    rates: Mapping[str, Expr],
) -> Inertia:
    """Assemble M, h, T = q'^T M q' / 2 and U from all bodies with mass."""
    names = list(q)
    M: dict[tuple[str, str], list[Any]] = {}
    h: dict[str, list[Any]] = {name: [] for name in names}
    potentials: list[Any] = []
    gravity = scalars.triple(mechanism.gravity)
    euler = frozenset(name for name, unit in mechanism.units.items() if unit == "")
    for body in mechanism.bodies:
        frame = found[body.name]
        mass, centre = scalars(body.mass), scalars.triple(body.centre)
        columns = {name: (W, add(V, cross(W, centre))) for name, (W, V) in frame.columns.items()}
        potential = scalars(0) - mass * dot(gravity, frame.point(centre))
        potentials.append(potential)
        moving = _MovingBody(body, mass, columns, frame, potential, euler)
        _add_mass(M, moving, scalars)
        for name, force in _bias(moving, scalars, gravity, q, rates).items():
            h[name].append(force)
    zero = scalars(0)  # products leave a plain 0 where all terms vanish; zero + 0 makes it an expression
    matrix = [[zero + total(M.get((i, j), M.get((j, i), []))) for j in names] for i in names]
    momentum = matvec(matrix, [rates[name] for name in names])
    T = (zero + dot(momentum, [rates[name] for name in names])) / 2
    return Inertia(matrix, [zero + total(h[name]) for name in names], T, zero + total(potentials))


@dataclass(frozen=True)
class _MovingBody:
    """A body with the columns (W_i, J_i) of its centre of mass, its potential energy, and all Euler parameters."""

    body: Body
    mass: Expr
    columns: Mapping[str, tuple[list[Any], list[Any]]]
    frame: Frame
    potential: Expr
    euler: frozenset[str]


def _add_mass(M: dict[tuple[str, str], list[Any]], moving: _MovingBody, scalars: ParameterScalars) -> None:
    """Add one body's share to M; entries that vanish are left out."""
    names, I_C = list(moving.columns), _inertia_matrix(moving, scalars)
    for i, name in enumerate(names):
        W_i, J_i = moving.columns[name]
        turned = matvec(I_C, W_i)
        for other in names[i:]:
            W_j, J_j = moving.columns[other]
            entry = moving.mass * (scalars(0) + dot(J_i, J_j)) + dot(turned, W_j)
            if entry != 0:
                key = (other, name) if (other, name) in M else (name, other)
                M.setdefault(key, []).append(entry)


def _bias(
    moving: _MovingBody,
    scalars: ParameterScalars,
    gravity: list[Any],
    q: Mapping[str, Expr],
    rates: Mapping[str, Expr],
) -> dict[str, Any]:
    """One body's share of h, by coordinate; none of a body that is fixed on the ground."""
    names, zero = list(moving.columns), scalars(0)
    if not names:
        return {}
    W = [moving.columns[name][0] for name in names]
    J = [moving.columns[name][1] for name in names]
    speed = [rates[name] for name in names]
    omega, velocity = matvec(transpose(W), speed), matvec(transpose(J), speed)
    seeds = {q[name]: rates[name] for name in names}
    change = directional([zero + e for e in velocity], seeds)
    acceleration = add(change, cross(omega, velocity))
    weight = matvec(transpose(moving.frame.pose.rotation), gravity)
    I_C = _inertia_matrix(moving, scalars)
    torque = add(matvec(I_C, directional([zero + e for e in omega], seeds)), cross(omega, matvec(I_C, omega)))
    forces = {}
    for i, name in enumerate(names):
        turning = zero + dot(W[i], torque)
        direct = moving.mass * (zero + dot(J[i], add(acceleration, scale(-1, weight)))) + turning
        coupled = [speed[j] * dot(omega, cross(J[j], J[i])) for j in range(len(names)) if j != i]
        energetic = moving.mass * (zero + dot(J[i], change) + total(coupled)) + turning
        energetic = energetic + derivative(moving.potential, q[name])
        choice = (direct,) if name in moving.euler else (energetic, direct)
        forces[name] = min(choice, key=lambda force: operations([force]).arithmetic)
    return forces


def _inertia_matrix(moving: _MovingBody, scalars: ParameterScalars) -> list[list[Any]]:
    return [[scalars(entry) for entry in row] for row in moving.body.inertia_matrix]
