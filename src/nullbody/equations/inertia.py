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
from nullbody.mechanism import Mechanism

__all__ = ["Inertia", "inertia"]


@dataclass(frozen=True)
class Spin:
    """How a body turns in space.

    Attributes:
        W: omega = W q', 3 x nq, in the body's axes.
        I_C: its inertia about its centre, in those axes.
        torque: I_C omega'_0 + omega x I_C omega.
    """

    W: list[list[Any]]
    I_C: list[list[Any]]
    torque: list[Any]


@dataclass(frozen=True)
class Inertia:
    """M (nq x nq), h (nq), T and U [J] of the bodies in redundant coordinates.

    Attributes:
        rest_M, rest_h: M and h without what is in `spins`.
        spins: bodies that turn about changing axes. M = rest_M + sum W^T I_C W, h = rest_h + sum W^T torque; N^T M N is
            cheaper by way of the angular velocities W N.
    """

    M: list[list[Any]]
    h: list[Any]
    T: Any
    U: Any
    rest_M: list[list[Any]]
    rest_h: list[Any]
    spins: tuple[Spin, ...]


def inertia(
    mechanism: Mechanism,
    found: Mapping[str, Frame],
    scalars: ParameterScalars,
    q: Mapping[str, Expr],
    rates: Mapping[str, Expr],
) -> Inertia:
    """Assemble M, h, T = q'^T M q' / 2 and U from all bodies with mass."""
    names = list(q)
    rest_M: dict[tuple[str, str], list[Any]] = {}
    M: dict[tuple[str, str], list[Any]] = {}
    rest_h: dict[str, list[Any]] = {name: [] for name in names}
    h: dict[str, list[Any]] = {name: [] for name in names}
    potentials: list[Any] = []
    spins: list[Spin] = []
    gravity = scalars.triple(mechanism.gravity)
    euler = frozenset(name for name, unit in mechanism.units.items() if unit == "")
    zero = scalars(0)  # products leave a plain 0 where all terms vanish; zero + 0 makes it an expression
    for body in mechanism.bodies:
        frame = found[body.name]
        mass, centre = scalars(body.mass), scalars.triple(body.centre)
        columns = {name: (W, add(V, cross(W, centre))) for name, (W, V) in frame.columns.items()}
        potential = zero - mass * dot(gravity, frame.point(centre))
        potentials.append(potential)
        I_C = [[scalars(entry) for entry in row] for row in body.inertia_matrix]
        moving = _MovingBody(mass, I_C, columns, frame, potential, euler)
        torque = _torque(moving, zero, q, rates)
        spatial = moving.spatial
        if spatial:
            W = [[zero + columns[name][0][k] if name in columns else 0 for name in names] for k in range(3)]
            spins.append(Spin(W, I_C, torque))
        masses = _masses(moving, zero, turning=True)
        _add_mass(M, masses)
        _add_mass(rest_M, _masses(moving, zero, turning=False) if spatial else masses)
        for name, (whole, moved) in _bias(moving, zero, gravity, (q, rates), torque).items():
            h[name].append(whole)
            rest_h[name].append(moved if spatial else whole)
    matrix, rest = (_matrix(entries, names, zero) for entries in (M, rest_M))
    momentum = matvec(matrix, [rates[name] for name in names])
    T = (zero + dot(momentum, [rates[name] for name in names])) / 2
    bias, rest_bias = ([zero + total(forces[name]) for name in names] for forces in (h, rest_h))
    return Inertia(matrix, bias, T, zero + total(potentials), rest, rest_bias, tuple(spins))


def _matrix(entries: Mapping[tuple[str, str], list[Any]], names: list[str], zero: Expr) -> list[list[Any]]:
    """The symmetric matrix of the sums of entries."""
    return [[zero + total(entries.get((i, j), entries.get((j, i), []))) for j in names] for i in names]


@dataclass(frozen=True)
class _MovingBody:
    """A body with the columns (W_i, J_i) of its centre of mass, its potential energy, and all Euler parameters."""

    mass: Expr
    I_C: list[list[Any]]
    columns: Mapping[str, tuple[list[Any], list[Any]]]
    frame: Frame
    potential: Expr
    euler: frozenset[str]

    @property
    def spatial(self) -> bool:
        """Whether three coordinates or more turn it, about axes that change in the body itself."""
        turning = [W for W, _ in self.columns.values() if any(e != 0 for e in W)]
        return len(turning) > 2 and any(isinstance(e, Expr) and e.constant is None for W in turning for e in W)


def _masses(moving: _MovingBody, zero: Expr, *, turning: bool) -> dict[tuple[str, str], Any]:
    """One body's share of M, with or without its turning; entries that vanish are left out."""
    names, found = list(moving.columns), {}
    for i, name in enumerate(names):
        W_i, J_i = moving.columns[name]
        turned = matvec(moving.I_C, W_i)
        for other in names[i:]:
            W_j, J_j = moving.columns[other]
            entry = moving.mass * (zero + dot(J_i, J_j))
            entry = entry + dot(turned, W_j) if turning else entry
            if entry != 0:
                found[name, other] = entry
    return found


def _add_mass(M: dict[tuple[str, str], list[Any]], masses: Mapping[tuple[str, str], Any]) -> None:
    for (name, other), entry in masses.items():
        key = (other, name) if (other, name) in M else (name, other)
        M.setdefault(key, []).append(entry)


def _torque(moving: _MovingBody, zero: Expr, q: Mapping[str, Expr], rates: Mapping[str, Expr]) -> list[Any]:
    """I omega'_0 + omega x I omega."""
    names, I_C = list(moving.columns), moving.I_C
    if not names:
        return [0, 0, 0]
    omega = matvec(transpose([W for W, _ in moving.columns.values()]), [rates[name] for name in names])
    seeds = {q[name]: rates[name] for name in names}
    return add(matvec(I_C, directional([zero + e for e in omega], seeds)), cross(omega, matvec(I_C, omega)))


def _bias(
    moving: _MovingBody,
    zero: Expr,
    gravity: list[Any],
    motion: tuple[Mapping[str, Expr], Mapping[str, Expr]],
    torque: list[Any],
) -> dict[str, tuple[Any, Any]]:
    """One body's share of h, with and without its turning, by coordinate; none of a body fixed on the ground."""
    (q, rates), names = motion, list(moving.columns)
    if not names:
        return {}
    W = [moving.columns[name][0] for name in names]
    J = [moving.columns[name][1] for name in names]
    speed = [rates[name] for name in names]
    omega, velocity = matvec(transpose(W), speed), matvec(transpose(J), speed)
    change = directional([zero + e for e in velocity], {q[name]: rates[name] for name in names})
    acceleration = add(change, cross(omega, velocity))
    weight = matvec(transpose(moving.frame.pose.rotation), gravity)
    forces = {}
    for i, name in enumerate(names):
        turning = zero + dot(W[i], torque)
        direct = moving.mass * (zero + dot(J[i], add(acceleration, scale(-1, weight))))
        coupled = [speed[j] * dot(omega, cross(J[j], J[i])) for j in range(len(names)) if j != i]
        energetic = moving.mass * (zero + dot(J[i], change) + total(coupled)) + derivative(moving.potential, q[name])
        choice = (direct,) if name in moving.euler else (energetic, direct)
        whole = min((force + turning for force in choice), key=lambda force: operations([force]).arithmetic)
        forces[name] = whole, min(choice, key=lambda force: operations([force]).arithmetic)
    return forces
