"""Mass matrix, bias forces and energies, body by body (theory 3, [27-35] with the rod's inertia about its centre).

For a body with mass m, inertia I about its centre C and the Jacobians V_C = J q', omega = W q' in its own axes:

    M += J^T m J + W^T I W
    h += J^T m (a_C - g) + W^T (I omega'_0 + omega x I omega),    a_C = (d/dt J) q' + omega x V_C,
                                                                  omega'_0 = (d/dt W) q'
    U -= m g . p_C

h is Coriolis, centrifugal and gravity together: M q'' + h + A^T lambda = Q.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from nullbody.equations.frame import Frame
from nullbody.equations.scalar import ParameterScalars
from nullbody.expr import Expr, directional
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
    for body in mechanism.bodies:
        frame = found[body.name]
        mass, centre = scalars(body.mass), scalars.triple(body.centre)
        columns = {name: (W, add(V, cross(W, centre))) for name, (W, V) in frame.columns.items()}
        _add_body(M, h, _Body(body, mass, columns, frame), scalars, gravity, q, rates)
        potentials.append(-(mass * dot(gravity, frame.point(centre))))
    zero = scalars(0)
    matrix = [[zero + total(M.get((i, j), M.get((j, i), []))) for j in names] for i in names]
    momentum = matvec(matrix, [rates[name] for name in names])
    T = (zero + dot(momentum, [rates[name] for name in names])) / 2
    return Inertia(matrix, [zero + total(h[name]) for name in names], T, zero + total(potentials))


@dataclass(frozen=True)
class _Body:
    body: Body
    mass: Expr
    columns: Mapping[str, tuple[list[Any], list[Any]]]
    frame: Frame


def _add_body(
    M: dict[tuple[str, str], list[Any]],
    h: dict[str, list[Any]],
    part: _Body,
    scalars: ParameterScalars,
    gravity: list[Any],
    q: Mapping[str, Expr],
    rates: Mapping[str, Expr],
) -> None:
    """Add one body's share to M and h."""
    names, I_C = list(part.columns), [[scalars(e) for e in row] for row in part.body.inertia_matrix]
    W = [part.columns[name][0] for name in names]
    J = [part.columns[name][1] for name in names]
    speed = [rates[name] for name in names]
    omega, velocity = matvec(transpose(W), speed), matvec(transpose(J), speed)
    seeds = {q[name]: rates[name] for name in names}
    zero = scalars(0)
    acceleration = add(directional([zero + e for e in velocity], seeds), cross(omega, velocity))
    acceleration = add(acceleration, scale(-1, matvec(transpose(part.frame.pose.rotation), gravity)))
    spin = matvec(I_C, omega)
    torque = add(matvec(I_C, directional([zero + e for e in omega], seeds)), cross(omega, spin))
    for i, name in enumerate(names):
        h[name].append(part.mass * (zero + dot(J[i], acceleration)) + dot(W[i], torque))
        turned = matvec(I_C, W[i])
        for j in range(i, len(names)):
            entry = part.mass * (zero + dot(J[i], J[j])) + dot(turned, W[j])
            if entry != 0:
                key = (name, names[j]) if (names[j], name) not in M else (names[j], name)
                M.setdefault(key, []).append(entry)
